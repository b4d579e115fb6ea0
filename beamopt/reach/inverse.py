"""The pressures of many points for any actuator, with derivatives by differences."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray, IndexArray

__all__ = ["inverse_by_differences"]

Forward = Callable[[FloatArray], FloatArray]
"""Pressures (k, 3) → tips (k, 3), NaN where there is none."""

SIDE = 3  # starts are looked for on SIDE³ pressures
STARTS = 3  # of them for each point
STEP = 2e-3  # of the box, for differences: its error only slows the steps down
MOST_STEPS = 40
REACHED = 1e-6  # of the largest coordinate of a tip: no other start is tried
STILL = 1e-7  # of the box: a step that is none
FLAT = 1e-10  # share of |r|² below which a step gains nothing


def inverse_by_differences(
    tips_at: Forward, points: FloatArray, low: float, high: float
) -> tuple[FloatArray, FloatArray]:
    """Pressures in [low, high]³ whose tips are nearest to points; see `arc_inverse`.

    All points at once: each step asks for the tips of all of them together. From the nearest of a
    grid over the box, and where that does not reach from what reaches the points before and after.

    Returns
    -------
    pressures (m, 3) [kPa] and tips (m, 3) [mm]; NaN where no start has a tip.
    """
    axis = np.linspace(0.0, 1.0, SIDE)
    grid = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)

    def tips_of(shares: FloatArray) -> FloatArray:
        return tips_at(np.where(shares == 1, high, low + (high - low) * shares))

    known = tips_of(grid)
    away = np.linalg.norm(known - points[:, None, :], axis=-1)
    nearest = np.argsort(np.where(np.isnan(away), np.inf, away), axis=1, kind="stable")
    search = _Search(tips_of, points, float(np.nanmax(np.abs(known), initial=1.0)))
    search.descend(grid[nearest[:, :STARTS]])
    around = np.roll(search.shares, 1, axis=0), np.roll(search.shares, -1, axis=0)
    search.descend(np.stack(around, axis=1))
    shares = np.where(np.isinf(search.squares)[:, None], np.nan, search.shares)
    return np.where(shares == 1, high, low + (high - low) * shares), search.tips


class _Search:
    """The best shares of the box (m, 3) so far, their tips [mm] and squared distances [mm²]."""

    def __init__(self, tips_of: Forward, points: FloatArray, size: float) -> None:
        self.tips_of, self.points = tips_of, points
        self.near = (REACHED * size) ** 2
        self.shares = np.full_like(points, 0.5)
        self.tips = np.full_like(points, np.nan)
        self.squares = np.full(len(points), np.inf)

    def descend(self, starts: FloatArray) -> None:
        """Go down from (m, s, 3) shares for points that are not reached, and keep what is best."""
        open_ = np.flatnonzero(self.squares > self.near)
        if not open_.size:
            return
        count = starts.shape[1]
        points = np.repeat(self.points[open_], count, axis=0)
        at, tips = _descended(self.tips_of, points, starts[open_].reshape(-1, 3), self.near)
        squares = _squares(tips, points).reshape(-1, count)
        best: IndexArray = squares.argmin(axis=1)
        rows = np.arange(len(open_))
        better = squares[rows, best] < self.squares[open_]
        which, chosen = open_[better], (rows * count + best)[better]
        self.shares[which], self.tips[which] = at[chosen], tips[chosen]
        self.squares[which] = squares[rows, best][better]


def _descended(
    tips_of: Forward, points: FloatArray, starts: FloatArray, near: float
) -> tuple[FloatArray, FloatArray]:
    """Levenberg–Marquardt, projected on the unit box; shares (k, 3) and tips (k, 3)."""
    at = starts.copy()
    tips, slopes = _tips_and_slopes(tips_of, at)
    squares = _squares(tips, points)
    damping = np.full(len(at), 1e-4)
    going = np.isfinite(squares)
    for _ in range(MOST_STEPS):
        open_ = np.flatnonzero(going & (squares > near * 1e-6))
        if not open_.size:
            break
        step = _steps(slopes[open_], tips[open_] - points[open_], at[open_], damping[open_])
        tried = np.clip(at[open_] + step, 0.0, 1.0)
        found, found_slopes = _tips_and_slopes(tips_of, tried)
        lower = _squares(found, points[open_])
        gain = squares[open_] - lower
        still = np.abs(tried - at[open_]).max(axis=1) < STILL
        still |= (gain > 0) & (gain < FLAT * squares[open_])
        better = gain > 0
        which = open_[better]
        at[which], tips[which], squares[which] = tried[better], found[better], lower[better]
        slopes[which] = found_slopes[better]
        damping[open_] *= np.where(better, 1 / 16, 8.0)
        going[open_] = ~still & (damping[open_] < 1e8)
    return at, tips


def _tips_and_slopes(tips_of: Forward, at: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Tips (k, 3) and their derivatives (k, 3, 3) by shares, inwards; 0 beside what has no tip."""
    steps = np.where(at > 0.5, -STEP, STEP)
    moved = np.concatenate([at[:, None, :], at[:, None, :] + np.eye(3) * steps[:, None, :]], axis=1)
    tips = tips_of(moved.reshape(-1, 3)).reshape(-1, 4, 3)
    slopes = (tips[:, 1:] - tips[:, :1]) / steps[..., None]
    return tips[:, 0], np.nan_to_num(slopes).transpose(0, 2, 1)


def _steps(slopes: FloatArray, away: FloatArray, at: FloatArray, damping: FloatArray) -> FloatArray:
    """(k, 3) damped Gauss–Newton steps in what may move without leaving the box."""
    gradient = np.einsum("kxj,kx->kj", slopes, away)
    normal = np.einsum("kxi,kxj->kij", slopes, slopes)
    held: NDArray[np.bool_] = ((at <= 0) & (gradient > 0)) | ((at >= 1) & (gradient < 0))
    normal[held[:, :, None] | held[:, None, :]] = 0.0
    largest = np.maximum(np.einsum("kii->ki", normal).max(axis=1), 1e-30)
    normal += np.eye(3) * (damping * largest)[:, None, None]
    normal += np.eye(3) * (held * largest[:, None])[:, None, :]
    return -np.linalg.solve(normal, np.where(held, 0.0, gradient)[..., None])[..., 0]


def _squares(tips: FloatArray, points: FloatArray) -> FloatArray:
    """(k,) squared distances [mm²]; infinite without a tip."""
    squares = ((tips - points) ** 2).sum(axis=-1)
    return np.where(np.isnan(squares), np.inf, squares)
