"""Moments of polygons, exact up to second order, by integrals along their edges."""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import FloatArray

__all__ = ["loop_integrals"]


def loop_integrals(points: FloatArray) -> FloatArray:
    """(6,) integrals of {1, x, y, x², y², xy} over the inside of a loop (n, 2) [mm].

    Positive for a counter-clockwise loop, negative for a clockwise one: a polygon with holes is
    the sum over its loops. Green's theorem turns each into a sum over edges, with
    c = xᵢ yᵢ₊₁ − xᵢ₊₁ yᵢ; the origin is first moved to the loop, so that a small one far away
    loses no digits.
    """
    origin = points.mean(axis=0)
    x, y = (points - origin).T
    X, Y = np.roll(x, -1), np.roll(y, -1)
    c = x * Y - X * y
    area = c.sum() / 2
    sx, sy = ((x + X) * c).sum() / 6, ((y + Y) * c).sum() / 6
    sxx = ((x * x + x * X + X * X) * c).sum() / 12
    syy = ((y * y + y * Y + Y * Y) * c).sum() / 12
    sxy = ((2 * x * y + x * Y + X * y + 2 * X * Y) * c).sum() / 24
    a, b = origin
    return np.array(
        [
            area,
            sx + a * area,
            sy + b * area,
            sxx + 2 * a * sx + a * a * area,
            syy + 2 * b * sy + b * b * area,
            sxy + a * sy + b * sx + a * b * area,
        ]
    )
