"""The group of rigid motions: exponential, its derivative, bracket, logarithm of a rotation."""

from __future__ import annotations

from math import atan2, sin, sqrt

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.compiled import compiled
from beamopt.comparators.rates import cross

__all__ = ["add_bracket", "exponential", "rotation", "rotation_vector"]

SERIES_BELOW = 0.25
"""θ² below which the coefficients are summed as series (eight terms: error below 1e-18)."""


@compiled
def _coefficients(q: float) -> tuple[float, float, float, float, float]:
    """For q = θ²: sin θ/θ, b = (1 − cos θ)/θ², c = (θ − sin θ)/θ³, 2 db/dq, 2 dc/dq."""
    if q < SERIES_BELOW:
        b, c, db, dc = 0.0, 0.0, 0.0, 0.0
        term = 0.5  # (−q)ⁿ/(2n + 2)!
        slope = -1 / 24  # its derivative's
        for n in range(8):
            b += term
            c += term / (2 * n + 3)
            db += (n + 1) * slope
            dc += (n + 1) * slope / (2 * n + 5)
            term *= -q / ((2 * n + 3) * (2 * n + 4))
            slope *= -q / ((2 * n + 5) * (2 * n + 6))
        return 1 - q * c, b, c, 2 * db, 2 * dc
    angle = sqrt(q)
    s, one_less_cos = sin(angle), 2 * sin(angle / 2) ** 2
    b, c = one_less_cos / q, (angle - s) / (q * angle)
    return s / angle, b, c, (s / angle - 2 * b) / q, (b - 3 * c) / q


@compiled
def exponential(x: FloatArray, turned: FloatArray, moved: FloatArray) -> None:
    """Exponential of (ω, ν): a rotation E and a translation e, with derivatives.

    Parameters
    ----------
    x : (6, 1 + p) rows ω, ν; column 0 the values, then derivatives by p parameters.
    turned : (3, 3) E = exp [ω]×, written.
    moved : (6, 1 + p) rows φ, e, written: column 0 has e = ν + b ω × ν + c ω × (ω × ν) (and no
        φ), the others δe and φ with δE = [φ]× E, φ = δω + b ω × δω + c ω × (ω × δω).
    """
    w0, w1, w2 = x[0, 0], x[1, 0], x[2, 0]
    q = w0 * w0 + w1 * w1 + w2 * w2
    s, b, c, db, dc = _coefficients(q)
    turned[0, 0] = 1 - b * (w1 * w1 + w2 * w2)
    turned[1, 1] = 1 - b * (w0 * w0 + w2 * w2)
    turned[2, 2] = 1 - b * (w0 * w0 + w1 * w1)
    turned[0, 1], turned[1, 0] = b * w0 * w1 - s * w2, b * w0 * w1 + s * w2
    turned[0, 2], turned[2, 0] = b * w0 * w2 + s * w1, b * w0 * w2 - s * w1
    turned[1, 2], turned[2, 1] = b * w1 * w2 - s * w0, b * w1 * w2 + s * w0
    x0, x1, x2 = cross(w0, w1, w2, x[3, 0], x[4, 0], x[5, 0])
    y0, y1, y2 = cross(w0, w1, w2, x0, x1, x2)
    moved[3, 0] = x[3, 0] + b * x0 + c * y0
    moved[4, 0] = x[4, 0] + b * x1 + c * y1
    moved[5, 0] = x[5, 0] + b * x2 + c * y2
    for j in range(1, x.shape[1]):
        a0, a1, a2 = x[0, j], x[1, j], x[2, j]
        v0, v1, v2 = cross(w0, w1, w2, a0, a1, a2)
        z0, z1, z2 = cross(w0, w1, w2, v0, v1, v2)
        moved[0, j] = a0 + b * v0 + c * z0
        moved[1, j] = a1 + b * v1 + c * z1
        moved[2, j] = a2 + b * v2 + c * z2
        along = w0 * a0 + w1 * a1 + w2 * a2
        # δ(ω × ν) = ω × δν + δω × ν = d, δ(ω × (ω × ν)) = ω × d + δω × (ω × ν)
        d0, d1, d2 = cross(w0, w1, w2, x[3, j], x[4, j], x[5, j])
        v0, v1, v2 = cross(a0, a1, a2, x[3, 0], x[4, 0], x[5, 0])
        d0, d1, d2 = d0 + v0, d1 + v1, d2 + v2
        z0, z1, z2 = cross(w0, w1, w2, d0, d1, d2)
        v0, v1, v2 = cross(a0, a1, a2, x0, x1, x2)
        moved[3, j] = x[3, j] + b * d0 + c * (z0 + v0) + along * (db * x0 + dc * y0)
        moved[4, j] = x[4, j] + b * d1 + c * (z1 + v1) + along * (db * x1 + dc * y1)
        moved[5, j] = x[5, j] + b * d2 + c * (z2 + v2) + along * (db * x2 + dc * y2)


@compiled
def add_bracket(factor: float, x: FloatArray, y: FloatArray, result: FloatArray) -> None:
    """`result` += factor [x, y] with [(ω, ν), (α, β)] = (ω × α, ω × β − α × ν).

    All (6, 1 + p): column 0 the values, the others derivatives by p parameters.
    """
    _add_product(factor, x, 0, y, 0, result, 0)
    for j in range(1, x.shape[1]):
        _add_product(factor, x, j, y, 0, result, j)
        _add_product(factor, x, 0, y, j, result, j)


@compiled
def _add_product(
    factor: float, x: FloatArray, i: int, y: FloatArray, j: int, result: FloatArray, to: int
) -> None:
    w0, w1, w2 = x[0, i], x[1, i], x[2, i]
    a0, a1, a2 = y[0, j], y[1, j], y[2, j]
    c0, c1, c2 = cross(w0, w1, w2, a0, a1, a2)
    d0, d1, d2 = cross(w0, w1, w2, y[3, j], y[4, j], y[5, j])
    e0, e1, e2 = cross(a0, a1, a2, x[3, i], x[4, i], x[5, i])
    result[0, to] += factor * c0
    result[1, to] += factor * c1
    result[2, to] += factor * c2
    result[3, to] += factor * (d0 - e0)
    result[4, to] += factor * (d1 - e1)
    result[5, to] += factor * (d2 - e2)


@compiled
def rotation(w0: float, w1: float, w2: float) -> FloatArray:
    """(3, 3) exp [w]×."""
    x, moved, turned = np.zeros((6, 1)), np.zeros((6, 1)), np.zeros((3, 3))
    x[0, 0], x[1, 0], x[2, 0] = w0, w1, w2
    exponential(x, turned, moved)
    return turned


@compiled
def rotation_vector(turned: FloatArray, vector: FloatArray, slope: FloatArray) -> None:
    """The logarithm r of a rotation (3, 3) into `vector` (3,), for angles below π.

    slope : (3, 3) written: δr = slope φ where the rotation changes by [φ]× times itself,
        slope = 1 − [r]×/2 + a [r]×², a = (1 − s/(2b))/θ², s = sin θ/θ, b = (1 − cos θ)/θ².
    """
    x = (turned[2, 1] - turned[1, 2]) / 2
    y = (turned[0, 2] - turned[2, 0]) / 2
    z = (turned[1, 0] - turned[0, 1]) / 2
    sine = sqrt(x * x + y * y + z * z)
    angle = atan2(sine, (turned[0, 0] + turned[1, 1] + turned[2, 2] - 1) / 2)
    scale = angle / sine if sine > 1e-8 else 1.0
    x, y, z = scale * x, scale * y, scale * z
    q = angle * angle
    a = _quadratic(q)
    vector[0], vector[1], vector[2] = x, y, z
    slope[0, 0], slope[1, 1], slope[2, 2] = (
        1 - a * (y * y + z * z),
        1 - a * (x * x + z * z),
        1 - a * (x * x + y * y),
    )
    slope[0, 1], slope[1, 0] = a * x * y + z / 2, a * x * y - z / 2
    slope[0, 2], slope[2, 0] = a * x * z - y / 2, a * x * z + y / 2
    slope[1, 2], slope[2, 1] = a * y * z + x / 2, a * y * z - x / 2


@compiled
def _quadratic(q: float) -> float:
    """(1 − s/(2b))/q, by its series where q is small."""
    if q < 1e-3:
        return 1 / 12 + q / 720 + q * q / 30240
    s, b, _, _, _ = _coefficients(q)
    return (1 - s / (2 * b)) / q
