"""Gaussian elimination of small systems, with row pivoting, that says when it can not."""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.compiled import compiled

__all__ = ["assign", "eliminate", "solve", "substitute"]


@compiled
def eliminate(rows: FloatArray, count: int) -> bool:
    """Bring the first `count` columns of `rows` (m ≥ count, any) to triangular form, in place.

    Returns False if a pivot is zero or not a number.
    """
    m, width = rows.shape
    for c in range(count):
        best = c
        for r in range(c + 1, m):
            if abs(rows[r, c]) > abs(rows[best, c]):
                best = r
        pivot = rows[best, c]
        if not abs(pivot) > 0.0 or not np.isfinite(pivot):
            return False
        if best != c:
            for j in range(c, width):
                rows[c, j], rows[best, j] = rows[best, j], rows[c, j]
        for r in range(c + 1, m):
            factor = rows[r, c] / pivot
            if factor != 0.0:
                for j in range(c + 1, width):
                    rows[r, j] -= factor * rows[c, j]
                rows[r, c] = 0.0
    return True


@compiled
def substitute(rows: FloatArray, right: FloatArray, x: FloatArray) -> None:
    """Solve the triangular system of the first len(x) rows and columns of `rows` for `right`."""
    count = len(x)
    for back in range(count):
        i = count - 1 - back
        value = right[i]
        for j in range(i + 1, count):
            value -= rows[i, j] * x[j]
        x[i] = value / rows[i, i]


@compiled
def assign(to: FloatArray, values: FloatArray) -> None:
    """`to`[:] = `values` for two matrices; numba's own compiles messages about shapes as well."""
    for i in range(to.shape[0]):
        for j in range(to.shape[1]):
            to[i, j] = values[i, j]


@compiled
def solve(matrix: FloatArray, right: FloatArray, x: FloatArray) -> bool:
    """`matrix` (n, n) x = `right` (n,); False if it is singular."""
    n = len(right)
    rows = np.empty((n, n + 1))
    for i in range(n):
        for j in range(n):
            rows[i, j] = matrix[i, j]
        rows[i, n] = right[i]
    if not eliminate(rows, n):
        return False
    substitute(rows, rows[:, n], x)
    return True
