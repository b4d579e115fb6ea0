"""Which points an actuator's tip reaches, at which pressures, and how near it comes."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.reach.arc_inverse import arc_inverse
from beamopt.reach.inverse import inverse_by_differences
from beamopt.rod.ladder import RodModel, Rung, SectionValues
from beamopt.rod.response import LinearResponse
from beamopt.section.moments import Moments

__all__ = ["TOLERANCE", "Reach", "ReachStatus", "arcs_are_linear", "reach", "reach_of_arcs"]

TOLERANCE = 0.1
"""Distance [mm] within which a point counts as reached, where nobody says otherwise."""


class ReachStatus(Enum):
    """How the search for a point's pressures ended; the value is the text shown to people."""

    REACHED = "reached"
    OUTSIDE = "outside"
    NO_TIP = "no equilibrium at any pressures that were tried"


@dataclass(frozen=True, eq=False)
class Reach:
    """What was found for m points.

    points : (m, 3) [mm]. pressures : (m, 3) [kPa] whose tips are nearest. tips : (m, 3) those [mm].
    NaN where no start had a tip.
    """

    points: FloatArray
    pressures: FloatArray
    tips: FloatArray

    @property
    def squares(self) -> FloatArray:
        """(m,) squared distances of the tips from the points [mm²]; NaN without a tip."""
        return np.asarray(((self.tips - self.points) ** 2).sum(axis=-1))

    @property
    def distances(self) -> FloatArray:
        """(m,) distances of the tips from the points [mm]; NaN without a tip."""
        return np.sqrt(self.squares)

    def statuses(self, tolerance: float) -> tuple[ReachStatus, ...]:
        """m of them; a point is reached where its tip is within `tolerance` [mm]."""
        return tuple(_status(distance, tolerance) for distance in self.distances.tolist())


def _status(distance: float, tolerance: float) -> ReachStatus:
    if np.isnan(distance):
        return ReachStatus.NO_TIP
    return ReachStatus.REACHED if distance <= tolerance else ReachStatus.OUTSIDE


def reach(
    model: RodModel, section: SectionValues, points: FloatArray, low: float, high: float
) -> Reach:
    """The pressures in [low, high]³ [kPa] whose tips are nearest to the points (m, 3) [mm].

    For arcs in a fraction of a millisecond, with exact derivatives; on other rungs with differences
    of the tips that they find, to about their tolerance.
    """
    if arcs_are_linear(model, section.moments):
        batch = Moments(section.moments.raw[None])
        pressures, tips = reach_of_arcs(model, batch, points, low, high)
        return Reach(points, pressures[0], tips[0])

    def tips_at(pressures: FloatArray) -> FloatArray:
        return model.tips(section, pressures).positions

    return Reach(points, *inverse_by_differences(tips_at, points, low, high))


def reach_of_arcs(
    model: RodModel, moments: Moments, points: FloatArray, low: float, high: float
) -> tuple[FloatArray, FloatArray]:
    """Pressures (n, m, 3) [kPa] and tips (n, m, 3) [mm] of a batch of n sections; see `reach`."""
    response = model.response_of(moments)
    if not isinstance(response, LinearResponse):
        raise TypeError("reach_of_arcs needs a linear response")
    rest = np.array([0.0, model.curvature[0], model.curvature[1]])
    matrices = np.broadcast_to(response.matrix, (len(moments.area), 3, 3))
    return arc_inverse(matrices, rest, model.length, points, low, high)


def arcs_are_linear(model: RodModel, moments: Moments) -> bool:
    """Whether the rods are arcs whose strains are linear in the pressures: see `reach_of_arcs`."""
    return model.rung is Rung.ARC and isinstance(model.response_of(moments), LinearResponse)
