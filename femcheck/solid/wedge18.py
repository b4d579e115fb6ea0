"""The second-order wedge with 18 nodes: quadratic in the triangle, quadratic along the axis."""

from __future__ import annotations

import numpy as np
from skfem.element import ElementH1
from skfem.refdom import RefWedge

from beamopt.base.arrays import FloatArray

__all__ = ["ElementWedge18", "wedge_quadrature"]

_CORNERS = ((0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1))
_EDGES = ((3, 0), (4, 0), (5, 0), (3, 1), (4, 1), (5, 1), (0, 2), (1, 2), (2, 2))
_QUADRANGLES = ((3, 2), (4, 2), (5, 2))
_NODES = _CORNERS + _EDGES + _QUADRANGLES
"""Function in the triangle (three corners, middles of 01, 12, 02) and along the axis (two ends,
middle) of each node, in the order of scikit-fem's vertices, edges and facets of a wedge."""

_TRIANGLE = np.array([[0, 0], [1, 0], [0, 1], [0.5, 0], [0.5, 0.5], [0, 0.5]])
_LINE = np.array([0.0, 1.0, 0.5])


class ElementWedge18(ElementH1):  # type: ignore[misc]  # scikit-fem has no types
    """P2 on the triangle times P2 on the axis, continuous over quadrangles and triangles.

    scikit-fem numbers one unknown a facet, triangles included; the two functions that would belong
    to a wedge's triangles are zero, and whoever solves with this element leaves them out.
    """

    nodal_dofs = 1
    edge_dofs = 1
    facet_dofs = 1
    maxdeg = 4
    dofnames = ("u", "u", "u")
    refdom = RefWedge
    doflocs = np.array(
        [[*_TRIANGLE[a], _LINE[b]] for a, b in _NODES] + [[1 / 3, 1 / 3, 0.0], [1 / 3, 1 / 3, 1.0]]
    )

    def lbasis(self, X: FloatArray, i: int) -> tuple[FloatArray, FloatArray]:
        """Function i and its gradient (3, …) at the reference points X (3, …)."""
        if i >= len(_NODES):
            return np.zeros_like(X[0]), np.zeros_like(X)
        a, b = _NODES[i]
        flat, flat_x, flat_y = _on_triangle(X[0], X[1], a)
        along, slope = _on_line(X[2], b)
        return flat * along, np.stack([flat_x * along, flat_y * along, flat * slope])


def _on_triangle(x: FloatArray, y: FloatArray, a: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Quadratic function a of the triangle and its derivatives."""
    third = 1 - x - y
    zero, one = np.zeros_like(x), np.ones_like(x)
    barycentric = ((third, -one, -one), (x, one, zero), (y, zero, one))
    if a < 3:
        p, px, py = barycentric[a]
        return p * (2 * p - 1), px * (4 * p - 1), py * (4 * p - 1)
    (p, px, py), (q, qx, qy) = barycentric[a - 3], barycentric[(a - 2) % 3]
    return 4 * p * q, 4 * (px * q + p * qx), 4 * (py * q + p * qy)


def _on_line(z: FloatArray, b: int) -> tuple[FloatArray, FloatArray]:
    """Quadratic function b of [0, 1] (ends 0 and 1, middle 2) and its derivative."""
    if b == 0:
        return (1 - z) * (1 - 2 * z), 4 * z - 3
    if b == 1:
        return z * (2 * z - 1), 4 * z - 1
    return 4 * z * (1 - z), 4 - 8 * z


def wedge_quadrature() -> tuple[FloatArray, FloatArray]:
    """Nine points (3, 9) and weights: degree 2 in the triangle, 5 along the axis.

    That is exact for the stiffness of a straight wedge, and leaves it no motion without energy but
    the six rigid ones.
    """
    from skfem.quadrature import get_quadrature
    from skfem.refdom import RefLine, RefTri

    (flat, area), (line, length) = get_quadrature(RefTri, 2), get_quadrature(RefLine, 5)
    points = np.concatenate(
        [np.repeat(flat, line.shape[1], axis=1), np.tile(line, (1, flat.shape[1]))]
    )
    return points, np.outer(area, length).ravel()
