"""The elements by name: scikit-fem's mesh, element and quadrature for an extruded section."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from beamopt.arrays import IndexArray
from femcheck.mesh.extrusion import Extrusion

__all__ = ["DEFAULT_ELEMENT", "ELEMENTS", "ElementChoice"]

DEFAULT_ELEMENT = "wedge18"


@dataclass(frozen=True)
class ElementChoice:
    """An element for the displacement.

    name : what the command line and files call it.
    basis : makes scikit-fem's basis of an extruded section.
    functions : how many of the element's functions are not zero.
    wall_corners : corners (f, 3 or 4) of the wall facets and the index of their quadrangle (f,).
    wall_degree : degree of the shape functions on a wall facet.
    """

    name: str
    basis: Callable[[Extrusion], Any]
    functions: int
    wall_corners: Callable[[Extrusion], tuple[IndexArray, IndexArray]]
    wall_degree: int


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


def _quadrangles(body: Extrusion) -> tuple[IndexArray, IndexArray]:
    return body.walls, np.arange(len(body.walls))


def _triangles(body: Extrusion) -> tuple[IndexArray, IndexArray]:
    """Two triangles a wall quadrangle, cut as `_split` cuts: from the higher index below."""
    a, b, B, A = body.walls.T
    rising = b > a
    first = np.where(rising, [a, b, A], [a, b, B]).T
    second = np.where(rising, [b, B, A], [a, B, A]).T
    index = np.arange(len(body.walls))
    return np.concatenate([first, second]), np.concatenate([index, index])


ELEMENTS = {
    choice.name: choice
    for choice in (
        ElementChoice("wedge18", _wedge18, 18, _quadrangles, 2),
        ElementChoice("tet10", _tetrahedra("ElementTetP2", 4), 10, _triangles, 2),
        ElementChoice("tet4", _tetrahedra("ElementTetP1", 1), 4, _triangles, 1),
    )
}
"""By name. The linear tetrahedron locks and the quadratic one comes slowly: for comparison only."""
