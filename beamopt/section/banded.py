"""Symmetric positive definite systems whose matrix is a narrow band, mostly empty."""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.compiled import compiled

__all__ = ["solve_banded"]


@compiled
def solve_banded(band: FloatArray, sides: FloatArray) -> None:
    """Solve A u = f for the rows f of `sides` (m, n), in place, by A = L D Lᵀ; `band` is used up.

    band : (n, width) lower half of A by columns, `band[k, d]` = A[k + d, k].

    Rows of L that stay empty are skipped: where the section has gaps, most of them are.
    """
    n, width = band.shape
    filled = np.empty(width, dtype=np.int64)
    for k in range(n):
        column = band[k]
        pivot = column[0]
        count, last = 0, 0
        for d in range(1, min(width, n - k)):
            if column[d] != 0:
                filled[count] = d
                count += 1
                last = d
        for d in filled[:count]:
            factor = column[d] / pivot
            rest, row = column[d : last + 1], band[k + d]
            for e in range(rest.shape[0]):
                row[e] -= factor * rest[e]
        for d in filled[:count]:
            column[d] /= pivot
            for m in range(sides.shape[0]):
                sides[m, k + d] -= column[d] * sides[m, k]
    for m in range(sides.shape[0]):
        side = sides[m]
        for k in range(n - 1, -1, -1):
            value = side[k] / band[k, 0]
            for d in range(1, min(width, n - k)):
                value -= band[k, d] * side[k + d]
            side[k] = value
