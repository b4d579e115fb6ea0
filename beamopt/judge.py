"""Judging candidates: section → response → tips → loss, many at a time."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from itertools import pairwise

import numpy as np

from beamopt.rod.arc import arc_tips
from beamopt.rod.response import linear_response
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import FloatArray, PolarGrid
from beamopt.section.phenotype import phenotypes
from beamopt.workspace import loss, pressure_grid

__all__ = ["Judge", "Status", "Verdict", "judge_all"]


class Status(Enum):
    """How judging a candidate ended; the value is the text shown to people."""

    JUDGED = "judged"
    NO_FEATURE_POINTS = "recombination left no feature point"
    NO_MATERIAL = "the section has no material"


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
    length : H [mm].
    youngs_modulus : E [kPa].
    levels : the three pressure levels [kPa].
    target : (27, 3) target tips [mm], in the order of `pressure_grid(levels)`.
    neighbour_weight : λ of the second objective.

    """

    grid: PolarGrid
    wall_elements: int
    length: float
    youngs_modulus: float
    levels: tuple[float, float, float]
    target: FloatArray
    neighbour_weight: float

    @cached_property
    def pressures(self) -> FloatArray:
        """(27, 3) pressure combinations [kPa]."""
        return pressure_grid(self.levels)

    def tips(self, candidates: Sequence[FeaturePoints]) -> FloatArray:
        """(n, 27, 3) tips of every candidate [mm]; NaN without material."""
        return self._tips_and_ratio(candidates)[0]

    def __call__(self, candidates: Sequence[FeaturePoints]) -> list[Verdict]:
        """One verdict a candidate; the same whatever else is in the batch."""
        tips, ratio = self._tips_and_ratio(candidates)
        first = loss(tips, self.target)
        second = self.neighbour_weight * ratio
        return [
            self._verdict(points, float(L), float(K))
            for points, L, K in zip(candidates, first, second, strict=True)
        ]

    def _tips_and_ratio(self, candidates: Sequence[FeaturePoints]) -> tuple[FloatArray, FloatArray]:
        measured = phenotypes(self.grid, candidates, self.wall_elements)
        response = linear_response(measured.moments, self.youngs_modulus)
        with np.errstate(invalid="ignore"):
            tips = arc_tips(response.strains(self.pressures), self.length)
        return tips, measured.neighbour_ratio

    def _verdict(self, points: FeaturePoints, L: float, K: float) -> Verdict:
        if len(points) == 0:
            return Verdict(np.inf, np.inf, Status.NO_FEATURE_POINTS)
        if not np.isfinite(L):
            return Verdict(np.inf, np.inf, Status.NO_MATERIAL)
        return Verdict(L, K)


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
