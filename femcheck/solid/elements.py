"""The elements by name: scikit-fem's mesh, element and quadrature for an extruded section."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from femcheck.mesh.extrusion import Extrusion
from femcheck.mesh.subdivision import subdivide

__all__ = ["DEFAULT_ELEMENT", "ELEMENTS", "ElementChoice"]

DEFAULT_ELEMENT = "wedge18"


@dataclass(frozen=True)
class ElementChoice:
    """An element for the displacement.

    name : what the command line and files call it.
    basis : makes scikit-fem's basis of an extruded section.
    functions : how many of the element's functions are not zero.
    wall_corners : corners (f, 3 or 4, 3) of the wall facets [mm] and the index of their quadrangle
        (f,) among the extrusion's.
    wall_degree : degree of the shape functions on a wall facet.
    tip_order : order in which the tip of a bending rod converges with the layers; None where it
        locks, and two meshes say nothing.
    corners : how many corners it has.
    linear : scikit-fem's linear element on the same corners.
    has_pair : whether a hydrostatic pressure in the linear functions makes a stable pair with it
        (Taylor and Hood's) for the mixed form.
    """

    name: str
    basis: Callable[[Extrusion], Any]
    functions: int
    wall_corners: Callable[[Extrusion], tuple[FloatArray, IndexArray]]
    wall_degree: int
    tip_order: float | None
    corners: int
    linear: str
    has_pair: bool


def _wedge18(body: Extrusion) -> Any:
    from skfem import Basis, MeshWedge1

    from femcheck.solid.wedge18 import ElementWedge18, wedge_quadrature

    mesh = MeshWedge1(body.points.T.copy(), body.wedges.T.astype(np.int32).copy())
    return Basis(mesh, ElementWedge18(), quadrature=wedge_quadrature())


def _tetrahedra(element: str, order: int) -> Callable[[Extrusion], Any]:
    def basis(body: Extrusion) -> Any:
        import skfem

        mesh = skfem.MeshTet(body.points.T.copy(), _split(body.wedges).T.astype(np.int32).copy())
        return skfem.Basis(mesh, getattr(skfem, element)(), intorder=order)

    return basis


def _split(wedges: IndexArray) -> IndexArray:
    """Three tetrahedra a wedge; its corners by rising index, so that neighbours cut alike."""
    order = np.argsort(wedges[:, :3], axis=1)
    w = np.take_along_axis(wedges, np.concatenate([order, order + 3], axis=1), axis=1)
    return np.concatenate([w[:, k : k + 4] for k in range(3)])


def _hex27(body: Extrusion) -> Any:
    from skfem import Basis, ElementHex2, MeshHex

    cut = subdivide(body)
    cells = cut.cells[:, _REFERENCE_CORNERS]
    mesh = MeshHex(cut.points.T.copy(), cells.T.astype(np.int32).copy())
    return Basis(mesh, ElementHex2(), intorder=5)  # three points along each direction


_REFERENCE_CORNERS = (6, 2, 5, 7, 1, 3, 4, 0)
"""scikit-fem's corners of a hexahedron, from (1, 1, 1) to (0, 0, 0), among ours: 0 to 3 below."""


def _quadrangles(body: Extrusion) -> tuple[FloatArray, IndexArray]:
    return body.points[body.walls], np.arange(len(body.walls))


def _halves(body: Extrusion) -> tuple[FloatArray, IndexArray]:
    mesh = subdivide(body)
    return mesh.points[mesh.walls], mesh.quadrangle


def _triangles(body: Extrusion) -> tuple[FloatArray, IndexArray]:
    """Two triangles a wall quadrangle, cut as `_split` cuts: from the higher index below."""
    a, b, B, A = body.walls.T
    rising = b > a
    first = np.where(rising, [a, b, A], [a, b, B]).T
    second = np.where(rising, [b, B, A], [a, B, A]).T
    index = np.arange(len(body.walls))
    return body.points[np.concatenate([first, second])], np.concatenate([index, index])


ELEMENTS = {
    choice.name: choice
    for choice in (
        ElementChoice("wedge18", _wedge18, 18, _quadrangles, 2, 4.0, 6, "ElementWedge1", True),
        ElementChoice("hex27", _hex27, 27, _halves, 2, 4.0, 8, "ElementHex1", True),
        ElementChoice(
            "tet10", _tetrahedra("ElementTetP2", 4), 10, _triangles, 2, 2.0, 4, "ElementTetP1", True
        ),
        ElementChoice(
            "tet4", _tetrahedra("ElementTetP1", 1), 4, _triangles, 1, None, 4, "ElementTetP1", False
        ),
    )
}
"""By name. For comparison: hexahedra need six times the nodes for the same triangles, the quadratic
tetrahedron comes slowly, the linear one locks and has no stable pair."""
