"""The discretised body: nodes, gradients at quadrature points, wall facets, both end faces."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from beamopt.arrays import FloatArray, IndexArray
from femcheck.mesh.extrusion import Extrusion
from femcheck.solid.elements import ELEMENTS, ElementChoice
from femcheck.solid.facets import FacetShape, facet_shape

__all__ = ["Body", "discretise", "nodes_at"]

ON_NODE = 1e-6
"""Distance [mm] within which a facet's node is taken for a node of the mesh."""


@dataclass(frozen=True, eq=False)
class Body:
    """Everything about a meshed actuator that its equilibrium needs; arrays over scikit-fem's.

    Parameters
    ----------
    extrusion : the volume mesh.
    element : name of the element.
    nodes : (n, 3) undeformed positions [mm].
    connectivity : (e, a) nodes of each element.
    gradients : (e, q, 3, a) undeformed gradients of the shape functions [1/mm].
    weights : (e, q) volumes that belong to the quadrature points [mm³].
    walls : (f, b) nodes of each wall facet of a chamber.
    wall_supply : (f,) 1…3.
    facet : shape functions of a wall facet.
    base, tip : nodes of the clamped face and of the face that the tip plate holds.
    """

    extrusion: Extrusion
    element: str
    nodes: FloatArray
    connectivity: IndexArray
    gradients: FloatArray
    weights: FloatArray
    walls: IndexArray
    wall_supply: IndexArray
    facet: FacetShape
    base: IndexArray
    tip: IndexArray

    @cached_property
    def tip_centre(self) -> FloatArray:
        """(3,) material centroid of the undeformed tip face [mm]."""
        return np.array([*self.extrusion.section.moments.centroid, self.extrusion.length])

    @property
    def cap_areas(self) -> FloatArray:
        """(3,) area of each supply's chambers in the section [mm²]: what closes them at the tip."""
        return self.extrusion.section.moments.chamber_areas

    @property
    def unknowns(self) -> int:
        """Unknowns of the equilibrium: nodes between the faces, and six of the tip plate."""
        return 3 * (len(self.nodes) - len(self.base) - len(self.tip)) + 6


def discretise(extrusion: Extrusion, element: str = "wedge18") -> Body:
    """Put an element on an extruded section.

    Raises
    ------
    ValueError : no element of that name.
    """
    if element not in ELEMENTS:
        raise ValueError(f"element = {element}: one of {', '.join(ELEMENTS)}")
    choice = ELEMENTS[element]
    basis = choice.basis(extrusion)
    used = basis.element_dofs[: choice.functions]
    names, connectivity = np.unique(used, return_inverse=True)
    nodes = np.ascontiguousarray(basis.doflocs[:, names].T)
    gradients = np.stack([basis.basis[k][0].grad for k in range(choice.functions)])
    z, length = nodes[:, 2], extrusion.length
    walls, supply, shape = _walls(extrusion, choice, nodes)
    return Body(
        extrusion=extrusion,
        element=element,
        nodes=nodes,
        connectivity=np.ascontiguousarray(connectivity.reshape(used.shape).T),
        gradients=np.ascontiguousarray(gradients.transpose(2, 3, 1, 0)),
        weights=np.ascontiguousarray(basis.dx),
        walls=walls,
        wall_supply=supply,
        facet=shape,
        base=np.flatnonzero(z < ON_NODE),
        tip=np.flatnonzero(z > length - ON_NODE),
    )


def nodes_at(body: Body, places: FloatArray) -> IndexArray:
    """(k,) node at each of the places (k, 3) [mm].

    Raises
    ------
    ValueError : there is none.
    """
    return _nearest(body.nodes, places)


def _walls(
    extrusion: Extrusion, choice: ElementChoice, nodes: FloatArray
) -> tuple[IndexArray, IndexArray, FacetShape]:
    """Nodes of the chambers' wall facets, found by place: facets are straight-edged."""
    corners, quadrangle = choice.wall_corners(extrusion)
    supply = extrusion.supply[quadrangle]
    chosen = supply > 0
    shape = facet_shape(corners.shape[1], choice.wall_degree)
    at = np.einsum("bc,fcx->fbx", shape.places, corners[chosen])
    found = _nearest(nodes, at.reshape(-1, 3))
    return found.reshape(at.shape[:2]), supply[chosen], shape


def _nearest(nodes: FloatArray, at: FloatArray) -> IndexArray:
    from scipy.spatial import cKDTree

    if len(at) == 0:
        return np.zeros(0, dtype=np.int64)
    distance, index = cKDTree(nodes).query(at)
    farthest = float(np.max(distance))
    if farthest > ON_NODE:
        raise ValueError(f"no node within {ON_NODE} mm of a facet's: {farthest:.3g} mm")
    return np.asarray(index, dtype=np.int64)
