"""Two offspring from two parents (paper, Recombination)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid

__all__ = ["RECOMBINATIONS", "Offspring", "fixed", "ranged"]

Offspring = tuple[FeaturePoints, FeaturePoints]


def ranged(
    a: FeaturePoints, b: FeaturePoints, grid: PolarGrid, share: float, rng: np.random.Generator
) -> Offspring:
    """Swap the feature points between two random angles (`share` plays no part).

    The counts of feature points may change, down to none; a section of no feature point is judged
    as such. Whether the interval runs up or round past the start makes no difference: swapping
    the rest gives the same two offspring.
    """
    span = np.radians(grid.span)
    low, high = np.sort(rng.uniform(0, span, 2))
    ours, theirs = (
        (angle >= low) & (angle <= high) for angle in (_from_start(a, grid), _from_start(b, grid))
    )
    return a.taking(~ours, b, theirs), b.taking(~theirs, a, ours)


def fixed(
    a: FeaturePoints, b: FeaturePoints, grid: PolarGrid, share: float, rng: np.random.Generator
) -> Offspring:
    """Swap the `share` of feature points nearest to a random angle; the counts stay.

    Nearest by angular distance, the lower index first among equals. Parents of different size swap
    that share of the smaller one.
    """
    span = np.radians(grid.span)
    angle = rng.uniform(0, span)
    count = round(share * min(len(a), len(b)))
    ours, theirs = np.zeros(len(a), dtype=np.bool_), np.zeros(len(b), dtype=np.bool_)
    for chosen, points in ((ours, a), (theirs, b)):
        away = np.abs(_from_start(points, grid) - angle)
        if grid.is_full_ring:
            away = np.minimum(away, 2 * np.pi - away)
        chosen[np.argsort(away, kind="stable")[:count]] = True
    return a.taking(~ours, b, theirs), b.taking(~theirs, a, ours)


def _from_start(points: FeaturePoints, grid: PolarGrid) -> FloatArray:
    """Angles counted from where the grid starts, in [0, 2π) [rad]."""
    return np.asarray(np.mod(points.angles - np.radians(grid.start), 2 * np.pi))


RECOMBINATIONS: dict[
    str,
    Callable[[FeaturePoints, FeaturePoints, PolarGrid, float, np.random.Generator], Offspring],
] = {"fixed": fixed, "range": ranged}
