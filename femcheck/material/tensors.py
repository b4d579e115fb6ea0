"""Kernels of symmetric tensors, stored as 11, 22, 33, 12, 23, 13."""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.compiled import compiled

__all__ = ["invariants", "inverse", "log_ratio", "subtract_products"]


@compiled
def log_ratio(c: FloatArray) -> float:
    """Ln J = ½ ln det C; −∞ where det C ≤ 0.

    By C − 1, so that small strains keep their digits.
    """
    x, y, z = c[0] - 1.0, c[1] - 1.0, c[2] - 1.0
    d, e, f = c[3], c[4], c[5]
    pairs = x * y + y * z + z * x - d * d - e * e - f * f
    triple = x * (y * z - e * e) - d * (d * z - e * f) + f * (d * e - y * f)
    less_one = x + y + z + pairs + triple
    return 0.5 * np.log1p(less_one) if less_one > -1.0 else -np.inf


@compiled
def invariants(C: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """I1 − 3, I2 − 3 and ln J of C (n, 6), each (n,)."""
    count = C.shape[0]
    first, second, ratio = np.empty(count), np.empty(count), np.empty(count)
    for n in range(count):
        c = C[n]
        x, y, z = c[0] - 1.0, c[1] - 1.0, c[2] - 1.0
        shears = c[3] * c[3] + c[4] * c[4] + c[5] * c[5]
        first[n] = x + y + z
        second[n] = 2.0 * first[n] + x * y + y * z + z * x - shears
        ratio[n] = log_ratio(c)
    return first, second, ratio


@compiled
def inverse(c: FloatArray, b: FloatArray) -> None:
    """Fill b with C⁻¹; NaN where det C ≤ 0."""
    b[0] = c[1] * c[2] - c[4] * c[4]
    b[1] = c[0] * c[2] - c[5] * c[5]
    b[2] = c[0] * c[1] - c[3] * c[3]
    b[3] = c[4] * c[5] - c[3] * c[2]
    b[4] = c[3] * c[5] - c[0] * c[4]
    b[5] = c[3] * c[4] - c[1] * c[5]
    determinant = c[0] * b[0] + c[3] * b[3] + c[5] * b[5]
    for k in range(6):
        b[k] = b[k] / determinant if determinant > 0.0 else np.nan


@compiled
def subtract_products(b: FloatArray, factor: float, D: FloatArray) -> None:
    """D (6, 6) −= factor (Bᵢₖ Bⱼₗ + Bᵢₗ Bⱼₖ): of a term in ln J, with B = C⁻¹."""
    b0, b1, b2, b3, b4, b5 = b[0], b[1], b[2], b[3], b[4], b[5]
    twice = 2.0 * factor
    D[0, 0] -= twice * b0 * b0
    D[1, 1] -= twice * b1 * b1
    D[2, 2] -= twice * b2 * b2
    D[3, 3] -= factor * (b0 * b1 + b3 * b3)
    D[4, 4] -= factor * (b1 * b2 + b4 * b4)
    D[5, 5] -= factor * (b0 * b2 + b5 * b5)
    _subtract(D, 0, 1, twice * b3 * b3)
    _subtract(D, 0, 2, twice * b5 * b5)
    _subtract(D, 1, 2, twice * b4 * b4)
    _subtract(D, 0, 3, twice * b0 * b3)
    _subtract(D, 0, 4, twice * b3 * b5)
    _subtract(D, 0, 5, twice * b0 * b5)
    _subtract(D, 1, 3, twice * b3 * b1)
    _subtract(D, 1, 4, twice * b1 * b4)
    _subtract(D, 1, 5, twice * b3 * b4)
    _subtract(D, 2, 3, twice * b5 * b4)
    _subtract(D, 2, 4, twice * b4 * b2)
    _subtract(D, 2, 5, twice * b5 * b2)
    _subtract(D, 3, 4, factor * (b3 * b4 + b5 * b1))
    _subtract(D, 3, 5, factor * (b0 * b4 + b5 * b3))
    _subtract(D, 4, 5, factor * (b3 * b2 + b4 * b5))


@compiled
def _subtract(D: FloatArray, u: int, v: int, amount: float) -> None:
    D[u, v] -= amount
    D[v, u] -= amount
