"""What a bound is asked about: tips at pressures, and the rod that should reach them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.rod.arc import arc_tips
from beamopt.rod.ladder import RodModel
from beamopt.target.target import Target

__all__ = ["Wanted", "rows_of", "wanted_of"]


@dataclass(frozen=True, eq=False)
class Wanted:
    """Tips that a rod of one uniform section should have, one a row.

    Parameters
    ----------
    pressures : (n, 3) [kPa]. tips : (n, 3) [mm].
    weights : (n,) w_j of L = Σ w_j |h_j − t_j|².
    length : H of the rod [mm].
    curvature : (2,) κ1, κ2 of the rod at rest, without pressure [1/mm].

    Raises
    ------
    ValueError : no row, arrays that do not fit each other, values that are not finite, weights
        below 0, or none above it.
    """

    pressures: FloatArray
    tips: FloatArray
    weights: FloatArray
    length: float
    curvature: FloatArray

    def __post_init__(self) -> None:
        rows = len(self.tips)
        shapes = self.pressures.shape, self.tips.shape, self.weights.shape, self.curvature.shape
        if rows == 0 or shapes != ((rows, 3), (rows, 3), (rows,), (2,)):
            raise ValueError(f"pressures, tips, weights, curvature have the shapes {shapes}")
        values = (self.pressures, self.tips, self.weights, self.curvature)
        if not all(np.isfinite(value).all() for value in values):
            raise ValueError("pressures, tips, weights, curvature: must be finite")
        if not (self.weights >= 0).all() or not self.weights.any() or not self.length > 0:
            raise ValueError("weights: at least 0, one above it; length: above 0")

    def tips_of(self, response: FloatArray) -> FloatArray:
        """(n, 3) tips [mm] of the rod whose response matrix is B (3, 3); see `LinearResponse`."""
        return arc_tips(self.strains_of(response), self.length)

    def strains_of(self, response: FloatArray) -> FloatArray:
        """(n, 3) strains (ε, κ1, κ2) of that rod, rest curvature included [1, 1/mm, 1/mm]."""
        strains = self.pressures @ response.T
        strains[:, 1:] += self.curvature
        return np.asarray(strains)

    def loss_of(self, response: FloatArray) -> float:
        """L of that rod [mm²]."""
        away = self.tips_of(response) - self.tips
        return float(self.weights @ (away * away).sum(axis=1))

    @property
    def largest_pressure(self) -> float:
        """Largest pressure of any row [kPa]; 1 where all are 0."""
        return float(np.abs(self.pressures).max()) or 1.0


def rows_of(target: Target) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Pressures (n, 3) [kPa], tips (n, 3) [mm] and weights (n,) of a target's rows that count.

    Directions and trajectories only add to L: without them a lower bound is one all the more.
    """
    aim = target.aim
    counts = aim.weights > 0
    return aim.pressures[counts], aim.tips[counts], aim.weights[counts]


def wanted_of(target: Target, model: RodModel) -> Wanted | None:
    """What a target asks of an actuator whose rod is an arc; None where no row of it counts."""
    pressures, tips, weights = rows_of(target)
    if not len(tips):
        return None
    rest = np.asarray(model.curvature[:2], dtype=np.float64)
    return Wanted(pressures, tips, weights, model.length, rest)
