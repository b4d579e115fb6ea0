"""Shape functions on the facets of a chamber's wall."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from beamopt.base.arrays import FloatArray

__all__ = ["FacetShape", "facet_shape"]


@dataclass(frozen=True, eq=False)
class FacetShape:
    """A triangle or quadrangle with b nodes and g quadrature points.

    places : (b, corners) weights of the corners that give each node's place.
    values : (g, b) shape functions. along, across : (g, b) derivatives by the reference
        coordinates s (corner 0 → 1) and t (corner 0 → last one). weights : (g,).
    """

    places: FloatArray
    values: FloatArray
    along: FloatArray
    across: FloatArray
    weights: FloatArray


def facet_shape(corners: int, degree: int) -> FacetShape:
    """Lagrange functions of `degree` 1 or 2 on a facet with 3 or 4 corners.

    The quadrature integrates x · (x,s × x,t) exactly, so that volumes are exact.
    """
    return _quadrangle(degree) if corners == 4 else _triangle(degree)


def _quadrangle(degree: int) -> FacetShape:
    gauss, weight = np.polynomial.legendre.leggauss(degree + 1)
    at, w = (gauss + 1) / 2, weight / 2
    line = np.linspace(0, 1, degree + 1)
    value, slope = _lagrange(line, at)
    places = np.array(
        [[(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t] for s in line for t in line]
    )
    return FacetShape(
        places,
        np.einsum("ga,hb->ghab", value, value).reshape(at.size**2, -1),
        np.einsum("ga,hb->ghab", slope, value).reshape(at.size**2, -1),
        np.einsum("ga,hb->ghab", value, slope).reshape(at.size**2, -1),
        np.outer(w, w).ravel(),
    )


def _lagrange(nodes: FloatArray, at: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(g, n) Lagrange polynomials through `nodes` at `at`, and their derivatives."""
    power = np.arange(nodes.size)
    coefficients = np.linalg.inv(nodes[:, None] ** power)
    slopes = power * at[:, None] ** np.maximum(power - 1, 0)
    return (at[:, None] ** power) @ coefficients, slopes @ coefficients


def _triangle(degree: int) -> FacetShape:
    from skfem import ElementTriP1, ElementTriP2
    from skfem.quadrature import get_quadrature
    from skfem.refdom import RefTri

    element = ElementTriP2() if degree == 2 else ElementTriP1()
    count = 3 * degree
    at, weights = get_quadrature(RefTri, 3 * degree - 2 if degree == 2 else 1)
    values = [element.lbasis(at, k) for k in range(count)]
    x, y = element.doflocs[:count].T
    ones = np.ones(weights.size)
    return FacetShape(
        np.stack([1 - x - y, x, y], axis=1),
        np.stack([v * ones for v, _ in values], axis=1),
        np.stack([d[0] * ones for _, d in values], axis=1),
        np.stack([d[1] * ones for _, d in values], axis=1),
        weights,
    )
