"""Bodies with a published answer: sectors of tubes and spheres between symmetry planes, Cook's.

All of them are straight-edged, like actuators; a circle is a polygon, a sphere a polyhedron. Inner
and outer surface are alike, so most of that cancels in a pressure that depends on B/A alone.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from femcheck.continuation.direct import DirectSolver, direct_solver
from femcheck.material.law import Law
from femcheck.mesh.extrusion import Extrusion, extrude
from femcheck.mesh.section_mesh import SectionMesh
from femcheck.solid.body import Body, discretise, linear_functions, surface_facets
from femcheck.solid.continuum import Continuum
from femcheck.solid.elements import ELEMENTS
from femcheck.solid.equilibrium import Equilibrium
from femcheck.solid.facets import FacetShape, facet_shape
from tests.validation.linear_support import Caps, FlatPredictor, LinearSupport, sliding

__all__ = ["DIRECTION", "Published", "cook", "sphere", "tube"]

NEAR = 1e-7
"""Distance [mm] within which a node is taken to lie on a plane or at a place."""
DIRECTION = np.array([1.0, 0.0, 0.0])
"""Supply 1 is the only one."""
UP = np.array([0.0, 0.0, 1.0])
INNER = 10.0
"""A, inner radius of tubes and spheres [mm]."""
SECTOR = np.radians(30.0)
COOK = np.array([[0.0, 0.0], [48.0, 44.0], [48.0, 60.0], [0.0, 44.0]])
"""Corners of Cook's membrane [mm], counter-clockwise; the left side is clamped."""


@dataclass(frozen=True, eq=False)
class Published:
    """A body on its support with a law, and what solves and follows it."""

    problem: Equilibrium
    solver: DirectSolver
    predictor: FlatPredictor

    @property
    def rest_volume(self) -> float:
        """Volume of the sector's cavity at rest [mm³]."""
        return float(self.problem.volumes(self.problem.rest())[0])


def tube(
    ratio: float,
    law: Law,
    across: int,
    along: int,
    element: str = "wedge18",
    *,
    is_free: bool = False,
) -> Published:
    """A sector of 30° of a tube A = 10 mm, B = ratio · A; one layer, z = 0 a symmetry plane.

    The other plane is another one (plane strain) or, if free, moves along z as a whole. A cap in it
    closes the cavity up to the axis, with nodes of its own: on the axis they move with the plane,
    halfway to the wall by the mean of both ends. Held, it makes the volume that of a closed cavity,
    without which the walls' forces lack what their rim would give; free, the thrust P π a².

    across, along : edges along the radius, graded with it, and along the circle.
    """
    body = _ring(ratio, across, along, element)
    top, section = body.extrusion.length, body.extrusion.section
    a, b = section.points[section.edges[section.supply == 1].T]
    if element == "hex27":  # its facets are halves
        a, b = np.vstack([a, (a + b) / 2]), np.vstack([(a + b) / 2, b])
    shape = facet_shape(3, ELEMENTS[element].wall_degree)
    corners = np.stack([np.zeros_like(a), a, b], axis=1)
    corners = np.concatenate([corners, np.full((*corners.shape[:2], 1), top)], axis=2)
    rim = np.unique(corners[:, 1:].reshape(-1, 3).round(9), axis=0)
    on_axis = np.array([[0.0, 0.0, top]])
    nodes = np.vstack([body.nodes, on_axis, (rim + on_axis) / 2])
    facets = _nodes_at(nodes, np.einsum("bc,fcx->fbx", shape.places, corners))
    motion = _with_cap(_between(body), body, _nodes_at(nodes, rim), is_free)
    whole = replace(_continuum(body), nodes=nodes)
    extra = len(nodes) - len(body.nodes)
    support = LinearSupport(nodes, motion, caps=Caps(facets, shape), extra=extra)
    return _published(whole, law, support)


def sphere(ratio: float, law: Law, layers: int, edges: int) -> Published:
    """A 120th of a sphere A = 10 mm, B = ratio · A: between three mirror planes of an icosahedron.

    layers : along the radius, graded with it. edges : that each side of the triangle is cut into.
    """
    golden = (1 + np.sqrt(5)) / 2
    corners = np.array([[0.0, 0.0, 1.0], [golden, 0.0, 1 + 2 * golden], [0.0, 1.0, golden]])
    corners /= np.linalg.norm(corners, axis=1)[:, None]  # on axes of two, three and five turns
    section, shares = _triangle(edges)
    directions = shares @ corners
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    radii = INNER * ratio ** (np.arange(layers + 1) / layers)
    flat = extrude(section, radii)
    mesh = replace(flat, points=(radii[:, None, None] * directions).reshape(-1, 3))
    body = _shell(mesh)
    normals = np.cross(corners, np.roll(corners, -1, axis=0))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    motion = sliding(body.nodes, [(0.0, normal) for normal in normals], NEAR)
    return _published(body, law, LinearSupport(body.nodes, motion))


def cook(law: Law, edges: int, element: str = "wedge18") -> tuple[Published, int]:
    """Cook's membrane between two planes 1 mm apart, and the node at its upper right corner.

    The load factor is the traction upwards on the right side [kPa].
    """
    s = np.linspace(0, 1, edges + 1)
    low, high = (np.outer(1 - s, a) + np.outer(s, b) for a, b in (COOK[:2], COOK[[3, 2]]))
    grid = (1 - s)[None, :, None] * low[:, None] + s[None, :, None] * high[:, None]
    extrusion = extrude(_grid(grid), np.array([0.0, 1.0]))
    body = discretise(extrusion, element)
    left = np.flatnonzero(body.nodes[:, 0] < NEAR)
    motion = sliding(body.nodes, [(0.0, UP), (1.0, UP)], NEAR, held=left)
    right = np.abs(extrusion.points[extrusion.walls][:, :, 0] - 48).max(axis=1) < NEAR
    facets, _, shape = surface_facets(extrusion, ELEMENTS[element], body.nodes, right)
    load = np.zeros_like(body.nodes)
    np.add.at(load[:, 1], facets, _facet_areas(body.nodes[facets], shape))
    corner = _nodes_at(body.nodes, np.array([[48.0, 60.0, 0.0]]))[0]
    return _published(body, law, LinearSupport(body.nodes, motion, load=load)), int(corner)


def _published(body: Continuum, law: Law, support: LinearSupport) -> Published:
    problem = Equilibrium(body, law, support)
    return Published(problem, direct_solver(), FlatPredictor(support))


def _ring(ratio: float, across: int, along: int, element: str) -> Body:
    """The sector from φ = 0 on, one layer as thick as the edges of its circle are long."""
    radii = INNER * ratio ** (np.arange(across + 1) / across)
    phi = SECTOR * np.arange(along + 1) / along
    circle = np.stack([np.cos(phi), np.sin(phi)], axis=1)
    section = _grid(radii[:, None, None] * circle, inner_supply=1)
    return discretise(extrude(section, np.array([0.0, INNER * phi[1]])), element)


def _between(body: Body) -> Any:
    """T of a ring's sector between its four planes."""
    turned = np.array([-np.sin(SECTOR), np.cos(SECTOR), 0.0])
    planes = [(0.0, np.array([0.0, 1.0, 0.0])), (0.0, turned), (0.0, UP)]
    return sliding(body.nodes, [*planes, (body.extrusion.length, UP)], NEAR)


def _with_cap(motion: Any, body: Body, rim: IndexArray, is_free: bool) -> Any:
    """T with the rows of the cap's own nodes and, if free, the top's height as one more unknown."""
    from scipy.sparse import csr_array, hstack, vstack

    height = np.zeros((motion.shape[0], 1))
    height[3 * body.tip + 2] = 1.0
    whole = hstack([motion, csr_array(height)]).tocsr()
    axis = csr_array(([1.0], ([2], [motion.shape[1]])), shape=(3, whole.shape[1]))
    middles = [(axis + whole[3 * node : 3 * node + 3]) / 2 for node in rim]
    raised = vstack([whole, axis, *middles]).tocsr()
    return raised if is_free else raised[:, :-1].tocsr()


def _grid(points: FloatArray, inner_supply: int = 0) -> SectionMesh:
    """A section of (i, j) quadrangles in two triangles each, counter-clockwise from i to j.

    points : (i + 1, j + 1, 2) [mm]. inner_supply : what lies behind the side i = 0.
    """
    rows, columns = points.shape[:2]
    at = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = (part.ravel() for part in (at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]))
    triangles = np.concatenate([np.stack([a, b, d], axis=1), np.stack([b, c, d], axis=1)])
    sides = [at[::-1, -1], at[0, ::-1], at[:, 0], at[-1]]
    edges = np.concatenate([np.stack([side[:-1], side[1:]], axis=1) for side in sides])
    supply = np.zeros(len(edges), dtype=np.int64)
    supply[rows - 1 : rows + columns - 2] = inner_supply
    return SectionMesh(points.reshape(-1, 2), triangles, edges, supply)


def _triangle(edges: int) -> tuple[SectionMesh, FloatArray]:
    """A triangle cut into edges² ones, and its points' shares (n, 3) of the three corners."""
    i, j = (part.ravel() for part in np.meshgrid(*2 * [np.arange(edges + 1)], indexing="ij"))
    inside = i + j <= edges
    number = np.where(inside, np.cumsum(inside) - 1, -1).reshape(edges + 1, edges + 1)
    first = [number[:-1, :-1], number[1:, :-1], number[:-1, 1:]]
    second = [number[1:, :-1], number[1:, 1:], number[:-1, 1:]]
    triangles = np.concatenate([np.stack(t, axis=-1).reshape(-1, 3) for t in (first, second)])
    triangles = triangles[(triangles >= 0).all(axis=1)]
    flat = np.stack([i, j], axis=1)[inside] / edges
    none = np.zeros((0, 2), dtype=np.int64)
    section = SectionMesh(flat, triangles, none, np.zeros(0, dtype=np.int64))
    return section, np.column_stack([1 - flat.sum(axis=1), flat])


def _shell(mesh: Extrusion) -> Continuum:
    """Second-order wedges whose first triangles are the wall of supply 1, as `discretise` does."""
    choice = ELEMENTS["wedge18"]
    basis = choice.basis(mesh)
    used = basis.element_dofs[: choice.functions]
    names, connectivity = np.unique(used, return_inverse=True)
    nodes = np.ascontiguousarray(basis.doflocs[:, names].T)
    gradients = np.stack([basis.basis[k][0].grad for k in range(choice.functions)])
    shape = facet_shape(3, 2)
    inner = mesh.points[
        mesh.wedges[: len(mesh.section.triangles), :3][:, ::-1]
    ]  # seen from outside
    walls = _nodes_at(nodes, np.einsum("bc,fcx->fbx", shape.places, inner))
    return Continuum(
        nodes=nodes,
        connectivity=np.ascontiguousarray(connectivity.reshape(used.shape).T),
        gradients=np.ascontiguousarray(gradients.transpose(2, 3, 1, 0)),
        weights=np.ascontiguousarray(basis.dx),
        walls=walls,
        wall_supply=np.ones(len(walls), dtype=np.int64),
        facet=shape,
        corner_values=linear_functions(choice, basis.quadrature[0]),
        has_pair=choice.has_pair,
    )


def _continuum(body: Body) -> Continuum:
    """A body without what belongs to an actuator."""
    return Continuum(**{field.name: getattr(body, field.name) for field in fields(Continuum)})


def _nodes_at(nodes: FloatArray, places: FloatArray) -> IndexArray:
    """The node at each place (…, 3); asserts that there is one."""
    from scipy.spatial import cKDTree

    distance, index = cKDTree(nodes).query(places)
    assert float(np.max(distance)) < NEAR
    return np.asarray(index, dtype=np.int64)


def _facet_areas(corners: FloatArray, shape: FacetShape) -> FloatArray:
    """(f, b) integral of each shape function over the facets with nodes (f, b, 3) [mm²]."""
    along, across = (np.einsum("gb,fbx->fgx", d, corners) for d in (shape.along, shape.across))
    area = np.linalg.norm(np.cross(along, across), axis=2)
    return np.asarray(np.einsum("fg,g,gb->fb", area, shape.weights, shape.values))
