"""Judging candidates: section → response → tips → loss, many at a time."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from beamopt.aim import Aim
from beamopt.arrays import FloatArray, IndexArray
from beamopt.rod.ladder import RodModel, Rung, SectionValues
from beamopt.rod.pressure_tree import parents_on_grid
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.moments import Moments
from beamopt.section.phenotype import Phenotypes, phenotypes
from beamopt.section.saint_venant import section_saint_venant
from beamopt.section.seal import UNSEALED, SealRules
from beamopt.workspace import pressure_grid

__all__ = ["Judge", "Status", "Verdict", "judge_all"]


class Status(Enum):
    """How judging a candidate ended; the value is the text shown to people."""

    JUDGED = "judged"
    NO_FEATURE_POINTS = "recombination left no feature point"
    NO_MATERIAL = "the section has no material"
    NO_EQUILIBRIUM = "the rod has no stable equilibrium under its loads at some pressures"
    NOT_STIFF = "the section has too little material to compute its bending stiffness"


@dataclass(frozen=True, slots=True)
class Verdict:
    """The losses of one candidate.

    L : first objective, Σ of squared node distances [mm²]; infinite unless judged.
    K : second objective λ r; infinite unless judged.
    """

    L: float
    K: float
    status: Status = Status.JUDGED

    @property
    def T(self) -> float:
        """The total loss L + K, which selection looks at."""
        return self.L + self.K


@dataclass(frozen=True, eq=False)
class Judge:
    """Everything a candidate is judged with; calling it judges a batch.

    Parameters
    ----------
    grid, wall_elements : the section's raster.
    rod : the actuator but for its section.
    levels : the three pressure levels [kPa].
    aim : what tips should be.
    neighbour_weight : λ of the second objective.
    rules : what a section is sealed by before it is judged.
    """

    grid: PolarGrid
    wall_elements: int
    rod: RodModel
    levels: tuple[float, float, float]
    aim: Aim
    neighbour_weight: float
    rules: SealRules = UNSEALED

    @cached_property
    def _parents(self) -> IndexArray | None:
        on_grid = np.array_equal(self.aim.pressures, pressure_grid(self.levels))
        return parents_on_grid() if on_grid else None

    def tips(self, candidates: Sequence[FeaturePoints]) -> FloatArray:
        """(n, rows, 3) tips of every candidate [mm]; NaN without material or equilibrium."""
        return self._tips(self.measured(candidates))[0]

    def __call__(self, candidates: Sequence[FeaturePoints]) -> list[Verdict]:
        """One verdict a candidate; the same whatever else is in the batch."""
        return self.verdicts(self.measured(candidates), [len(points) for points in candidates])

    def verdicts(self, measured: Phenotypes, counts: Sequence[int]) -> list[Verdict]:
        """Verdicts on sections that are measured already, made of `counts` feature points."""
        tips, found = self._tips(measured)
        first = self.aim.loss(tips)
        second = self.neighbour_weight * measured.neighbour_ratio
        moments = measured.moments
        rows = zip(counts, moments.area, moments.is_stiff, found, strict=True)
        statuses = [_status(*row) for row in rows]
        return [
            Verdict(float(L), float(K)) if status is Status.JUDGED else _failed(status)
            for L, K, status in zip(first, second, statuses, strict=True)
        ]

    def measured(self, candidates: Sequence[FeaturePoints]) -> Phenotypes:
        """Moments and neighbour counts of every candidate, and labels where the rod needs them."""
        twists = self.rod.twists
        return phenotypes(self.grid, candidates, self.wall_elements, self.rules, twists)

    def _tips(self, measured: Phenotypes) -> tuple[FloatArray, NDArray[np.bool_]]:
        """Tips (n, rows, 3), and (n,) whether all of a candidate's are there."""
        rod, moments = self.rod, measured.moments
        count = len(moments.area)
        found = np.ones(count, dtype=bool)
        if rod.rung is Rung.ARC:
            with np.errstate(invalid="ignore"):
                return rod.arcs(moments, self.aim.pressures), found
        tips = np.full((count, len(self.aim), 3), np.nan)
        for k in np.flatnonzero(moments.is_stiff).tolist():
            values = self._values(measured, k)
            result = rod.tips(values, self.aim.pressures, self._parents, all_or_none=True)
            tips[k], found[k] = result.positions, result.failure is None
        return tips, found

    def _values(self, measured: Phenotypes, k: int) -> SectionValues:
        moments = Moments(measured.moments.raw[k])
        if not self.rod.twists:
            return SectionValues(moments)
        labels, nu = measured.labels[k], self.rod.poissons_ratio
        return SectionValues(moments, section_saint_venant(self.grid, labels, nu))


def _status(points: int, area: float, is_stiff: bool, has_tips: bool) -> Status:
    if points == 0:
        return Status.NO_FEATURE_POINTS
    if area == 0:
        return Status.NO_MATERIAL
    if not is_stiff:
        return Status.NOT_STIFF
    return Status.JUDGED if has_tips else Status.NO_EQUILIBRIUM


def _failed(status: Status) -> Verdict:
    return Verdict(np.inf, np.inf, status)


def judge_all(
    judge: Judge,
    candidates: Sequence[FeaturePoints],
    executor: Executor | None = None,
    workers: int = 1,
) -> list[Verdict]:
    """Judge a batch in `workers` parts on any executor; the verdicts do not depend on either."""
    if executor is None or workers <= 1 or len(candidates) < 2 * workers:
        return judge(candidates)
    bounds = np.linspace(0, len(candidates), workers + 1).astype(int)
    parts = [candidates[a:b] for a, b in pairwise(bounds)]
    return [verdict for part in executor.map(judge, parts) for verdict in part]
