"""What an aim needs to know of sections: tips, where they point, how near they come to paths."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from beamopt.reach.reach import Reach, arcs_are_linear, reach, reach_of_arcs
from beamopt.rod.arc import arc_tip_directions, arc_tips
from beamopt.rod.ladder import RodModel, SectionValues
from beamopt.section.moments import Moments
from beamopt.target.aim import Aim

__all__ = ["Answers", "SectionQuestion"]


@dataclass(frozen=True, eq=False)
class Answers:
    """Of one section, or of a batch along leading axes.

    tips : (…, n, 3) at the aim's rows [mm]. directions : (…, n, 3) unit tangents there, where they
    count. squares : (…, m) squared distances from the paths' points [mm²], where there are any.
    """

    tips: FloatArray
    directions: FloatArray | None = None
    squares: FloatArray | None = None

    def loss(self, aim: Aim) -> FloatArray:
        """(…) L [mm²]; see `Aim.loss`."""
        return aim.loss(self.tips, self.directions, self.squares)


@dataclass(frozen=True, eq=False)
class SectionQuestion:
    """What is asked of sections.

    rod : the actuator but for its section. aim : what its tip should do. low, high : of the
    pressures at which paths are followed [kPa]. parents : (n, 3) see `StrainModes`.
    """

    rod: RodModel
    aim: Aim
    low: float
    high: float
    parents: IndexArray | None = None

    def of_arcs(self, moments: Moments) -> Answers:
        """For a batch of sections (b,) whose rods are arcs; NaN for those without material."""
        rod, aim = self.rod, self.aim
        if not aim.turns:
            found = Answers(rod.arcs(moments, aim.pressures))
        else:
            strains = rod.arc_strains(moments, aim.pressures)
            ways = arc_tip_directions(strains, rod.length)
            found = Answers(arc_tips(strains, rod.length), ways)
        if not aim.has_paths:
            return found
        return Answers(found.tips, found.directions, self._squares_of_arcs(moments))

    def of_section(self, section: SectionValues) -> tuple[Answers, bool]:
        """For one section, and whether its rod has an equilibrium wherever it is asked for."""
        rod, aim = self.rod, self.aim
        answers, there = Answers(np.zeros((0, 3)), np.zeros((0, 3))), True
        if len(aim):
            found = rod.tips(section, aim.pressures, self.parents, all_or_none=True)
            answers, there = Answers(found.positions, found.directions), found.failure is None
        if aim.has_paths and there:
            squares = self.reach(section).squares
            answers = Answers(answers.tips, answers.directions, squares)
            there = not np.isnan(squares).any()
        return answers, there

    def reach(self, section: SectionValues) -> Reach:
        """How near a section's tip comes to the paths' points, and at which pressures."""
        return reach(self.rod, section, self.aim.paths, self.low, self.high)

    def _squares_of_arcs(self, moments: Moments) -> FloatArray:
        points = self.aim.paths
        if arcs_are_linear(self.rod, moments):
            _, tips = reach_of_arcs(self.rod, moments, points, self.low, self.high)
            return np.asarray(((tips - points) ** 2).sum(axis=-1))
        squares = np.full((len(moments.area), len(points)), np.nan)
        for k in np.flatnonzero(moments.is_stiff).tolist():
            squares[k] = self.reach(SectionValues(Moments(moments.raw[k]))).squares
        return squares
