"""The pressures of many points for many arcs, compiled: projected Levenberg–Marquardt."""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.compiled import compiled
from beamopt.reach.arc_descent import descend, tip_at

__all__ = ["arc_inverse"]

SIDE = 5
"""Starts are looked for on a grid of SIDE³ pressures over the box."""

REACHED = 1e-9  # of the length: no other start is tried


def arc_inverse(
    matrices: FloatArray,
    rest: FloatArray,
    length: float,
    points: FloatArray,
    low: float,
    high: float,
) -> tuple[FloatArray, FloatArray]:
    """Pressures in a box that bring the tips of arcs nearest to points.

    Minimises |h(p) − q|² over p in [low, high]³, from the pressures of the point before and from
    the local minima on a grid over the box, until one is there. The derivative is exact:
    ∂h/∂p = ∂h/∂strain · B.

    Parameters
    ----------
    matrices : B (n, 3, 3) of n arcs, whose strains are (ε, κ1, κ2) = B p + rest.
    rest : (3,) strains without pressure [1, 1/mm, 1/mm].
    length : H [mm].
    points : q (m, 3) [mm].
    low, high : ends of the box [kPa].

    Returns
    -------
    pressures (n, m, 3) [kPa] and tips (n, m, 3) [mm]; NaN for a matrix that is not finite.
    """
    count, m = len(matrices), len(points)
    shares, tips = np.full((count, m, 3), np.nan), np.full((count, m, 3), np.nan)
    start = rest + matrices @ np.full(3, low)
    scaled = np.ascontiguousarray(matrices * (high - low))
    _inverses(scaled, start, length, np.ascontiguousarray(points), shares, tips)
    # at an end of the box exactly that pressure
    inside = np.where(shares == 1, high, low + (high - low) * shares)
    return inside, tips


@compiled
def _inverses(
    matrices: FloatArray,
    starts: FloatArray,
    length: float,
    points: FloatArray,
    shares: FloatArray,
    tips: FloatArray,
) -> None:
    """Fill `shares` of the box (n, m, 3) and `tips` (n, m, 3); see `arc_inverse`."""
    grid = np.empty((SIDE, SIDE, SIDE, 3))
    squares = np.empty((SIDE, SIDE, SIDE))
    slopes = np.empty((3, 3))
    at, tip, best, best_tip = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    near = (REACHED * length) ** 2
    for c in range(len(matrices)):
        matrix, start = matrices[c], starts[c]
        if not (np.isfinite(matrix).all() and np.isfinite(start).all()):
            continue
        _fill(matrix, start, length, grid)
        for q in range(len(points)):
            point = points[q]
            least = np.inf
            if q > 0:
                best[:] = shares[c, q - 1]
                least = descend(matrix, start, length, point, best, best_tip, slopes)
            if not least <= near:
                _measure(grid, point, squares)
                for i in range(SIDE):
                    for j in range(SIDE):
                        for k in range(SIDE):
                            if least <= near or not _is_lowest(squares, i, j, k):
                                continue
                            at[0], at[1], at[2] = i, j, k
                            at /= SIDE - 1
                            found = descend(matrix, start, length, point, at, tip, slopes)
                            if found < least:
                                least = found
                                best[:] = at
                                best_tip[:] = tip
            shares[c, q] = best
            tips[c, q] = best_tip


@compiled
def _fill(matrix: FloatArray, start: FloatArray, length: float, grid: FloatArray) -> None:
    """Tips on the grid of starts."""
    at = np.empty(3)
    for i in range(SIDE):
        for j in range(SIDE):
            for k in range(SIDE):
                at[0], at[1], at[2] = i, j, k
                at /= SIDE - 1
                tip_at(matrix, start, length, at, grid[i, j, k])


@compiled
def _measure(grid: FloatArray, point: FloatArray, squares: FloatArray) -> None:
    for i in range(SIDE):
        for j in range(SIDE):
            for k in range(SIDE):
                total = 0.0
                for x in range(3):
                    total += (grid[i, j, k, x] - point[x]) ** 2
                squares[i, j, k] = total


@compiled
def _is_lowest(squares: FloatArray, i: int, j: int, k: int) -> bool:
    """Whether no neighbour along an axis of the grid is nearer; of equal ones the first counts."""
    here = squares[i, j, k]
    last = SIDE - 1
    return not (
        (i > 0 and squares[i - 1, j, k] <= here)
        or (j > 0 and squares[i, j - 1, k] <= here)
        or (k > 0 and squares[i, j, k - 1] <= here)
        or (i < last and squares[i + 1, j, k] < here)
        or (j < last and squares[i, j + 1, k] < here)
        or (k < last and squares[i, j, k + 1] < here)
    )
