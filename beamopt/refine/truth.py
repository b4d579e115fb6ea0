"""What a refinement judges on: the true section, as raster or as outline."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum
from functools import cached_property

import numpy as np

from beamopt.judge.answers import Answers
from beamopt.judge.judge import Judge, JudgeStatus, Verdict
from beamopt.outline.saint_venant import outline_saint_venant
from beamopt.rod.ladder import SectionValues
from beamopt.section.feature_points import SUPPLIES, FeaturePoints
from beamopt.section.moments import Moments
from beamopt.section.phenotype import Phenotypes
from beamopt.target.aim import Aim

__all__ = ["Judged", "Truth", "View", "judged_on"]


class View(Enum):
    """Which section is judged; the value stands in the history."""

    RASTER = "raster"
    OUTLINE = "outline"


@dataclass(frozen=True, eq=False)
class Judged:
    """A section that was judged.

    section : what the rod knows of it. judge : what judged it. ratio : its neighbour ratio.
    """

    points: FeaturePoints
    verdict: Verdict
    section: SectionValues
    judge: Judge
    ratio: float

    @property
    def found(self) -> bool:
        """Whether it could be judged."""
        return self.verdict.status is JudgeStatus.JUDGED

    @property
    def loss(self) -> float:
        """L and the weighted rules [mm²]; infinite where it could not be judged."""
        return self.verdict.ruled_loss

    @cached_property
    def aim(self) -> Aim:
        """What its tips should be, points of paths as rows at the pressures found best."""
        return self.judge.settled(self.section) if self.found else self.judge.aim

    @cached_property
    def answers(self) -> Answers:
        """Its tips, and where they point, at the rows of `aim`; none where it was not judged."""
        if not self.found:
            return Answers(np.zeros((0, 3)))
        return answers_to(self.judge, self.aim, self.section)


Truth = Callable[[FeaturePoints], Judged]
"""Judges one section."""


def judged_on(judge: Judge, view: View) -> Truth:
    """Judge of feature points on their raster, or on their outline: moments, torsion, chambers.

    How symmetric a section is, is measured on the raster in any case.
    """
    from beamopt.outline.build import build_outline

    def truth(points: FeaturePoints) -> Judged:
        measured = judge.measured([points])
        if view is View.OUTLINE:
            outline = build_outline(judge.grid, points, judge.rules, inspected=False)
            measured = replace(measured, moments=Moments(outline.moments.raw[None]))
            if judge.rod.twists and measured.moments.is_stiff[0]:
                known = outline_saint_venant(outline, judge.rod.poissons_ratio)
                measured = replace(measured, saint_venant=(known,))
            if judge.making.counts_chambers:
                found = [chamber.supply for chamber in outline.chambers]
                chambers = np.array([[found.count(supply) for supply in SUPPLIES]])
                measured = replace(measured, chambers=chambers)
        return _judged(judge, points, measured)

    return truth


def _judged(judge: Judge, points: FeaturePoints, measured: Phenotypes) -> Judged:
    verdict = judge.verdicts(measured, [len(points)])[0]
    ratio = float(measured.neighbour_ratio[0])
    if verdict.status is not JudgeStatus.JUDGED:
        unknown = SectionValues(Moments(np.zeros((4, 6))))
        return Judged(points, verdict, unknown, judge, ratio)
    return Judged(points, verdict, judge.values(measured, 0), judge, ratio)


def answers_to(judge: Judge, aim: Aim, section: SectionValues) -> Answers:
    """Tips of a section at the rows of an aim without paths."""
    parents = judge.question.parents if aim is judge.aim else None
    return replace(judge.question, aim=aim, parents=parents).of_section(section)[0]
