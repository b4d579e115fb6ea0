"""The meshed actuator: an element on an extruded section, and which nodes both end faces hold."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray, IndexArray
from femcheck.mesh.extrusion import Extrusion
from femcheck.solid.continuum import Continuum
from femcheck.solid.elements import ELEMENTS, ElementChoice
from femcheck.solid.facets import FacetShape, facet_shape

__all__ = ["Body", "discretise", "linear_functions", "nodes_at", "surface_facets"]

ON_NODE = 1e-6
"""Distance [mm] within which a facet's node is taken for a node of the mesh."""


@dataclass(frozen=True, eq=False)
class Body(Continuum):
    """A meshed actuator.

    Parameters
    ----------
    extrusion : the volume mesh.
    element : name of the element.
    base, tip : nodes of the clamped face and of the face that the tip plate holds.
    """

    extrusion: Extrusion
    element: str
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
    chamber = extrusion.supply > 0
    walls, quadrangle, shape = surface_facets(extrusion, choice, nodes, chamber)
    return Body(
        extrusion=extrusion,
        element=element,
        nodes=nodes,
        connectivity=np.ascontiguousarray(connectivity.reshape(used.shape).T),
        gradients=np.ascontiguousarray(gradients.transpose(2, 3, 1, 0)),
        weights=np.ascontiguousarray(basis.dx),
        walls=walls,
        wall_supply=extrusion.supply[quadrangle],
        facet=shape,
        corner_values=linear_functions(choice, basis.quadrature[0]),
        has_pair=choice.has_pair,
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


def linear_functions(choice: ElementChoice, at: FloatArray) -> FloatArray:
    """(q, c) linear functions of the corners at reference points (3, q)."""
    import skfem

    linear = getattr(skfem, choice.linear)()
    values = [linear.lbasis(at, corner)[0] for corner in range(choice.corners)]
    return np.stack([value * np.ones(at.shape[1]) for value in values], axis=1)


def surface_facets(
    extrusion: Extrusion, choice: ElementChoice, nodes: FloatArray, chosen: NDArray[np.bool_]
) -> tuple[IndexArray, IndexArray, FacetShape]:
    """Nodes (f, b) of the facets on chosen boundary quadrangles, and which quadrangle (f,) it is.

    Found by place: facets are straight-edged.
    """
    corners, quadrangle = choice.wall_corners(extrusion)
    kept = chosen[quadrangle]
    shape = facet_shape(corners.shape[1], choice.wall_degree)
    at = np.einsum("bc,fcx->fbx", shape.places, corners[kept])
    found = _nearest(nodes, at.reshape(-1, 3))
    return found.reshape(at.shape[:2]), quadrangle[kept], shape


def _nearest(nodes: FloatArray, at: FloatArray) -> IndexArray:
    from scipy.spatial import cKDTree

    if len(at) == 0:
        return np.zeros(0, dtype=np.int64)
    distance, index = cKDTree(nodes).query(at)
    farthest = float(np.max(distance))
    if farthest > ON_NODE:
        raise ValueError(f"no node within {ON_NODE} mm of a facet's: {farthest:.3g} mm")
    return np.asarray(index, dtype=np.int64)
