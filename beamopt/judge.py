"""Judging candidates: section → response → tips → loss, many at a time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from itertools import pairwise

import numpy as np

from beamopt.arrays import FloatArray
from beamopt.rod.arc import arc_tips
from beamopt.rod.response import Response
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.moments import Moments
from beamopt.section.phenotype import Phenotypes, phenotypes
from beamopt.section.seal import UNSEALED, SealRules
from beamopt.workspace import NODES, loss, pressure_grid

__all__ = ["Judge", "Status", "Verdict", "judge_all"]


class Status(Enum):
    """How judging a candidate ended; the value is the text shown to people."""

    JUDGED = "judged"
    NO_FEATURE_POINTS = "recombination left no feature point"
    NO_MATERIAL = "the section has no material"
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
    length : H [mm].
    response_of : what makes a response of the sections' moments.
    levels : the three pressure levels [kPa].
    target : (27, 3) target tips [mm], in the order of `pressure_grid(levels)`.
    neighbour_weight : λ of the second objective.
    rules : what a section is sealed by before it is judged.
    """

    grid: PolarGrid
    wall_elements: int
    length: float
    response_of: Callable[[Moments], Response]
    levels: tuple[float, float, float]
    target: FloatArray
    neighbour_weight: float
    rules: SealRules = UNSEALED

    @cached_property
    def pressures(self) -> FloatArray:
        """(27, 3) pressure combinations [kPa]."""
        return pressure_grid(self.levels)

    def __post_init__(self) -> None:
        if self.target.shape != (NODES, 3) or not np.isfinite(self.target).all():
            raise ValueError(f"target: {NODES} finite tips (27, 3) in mm")

    def tips(self, candidates: Sequence[FeaturePoints]) -> FloatArray:
        """(n, 27, 3) tips of every candidate [mm]; NaN without material."""
        return self._tips(self._measured(candidates).moments)

    def __call__(self, candidates: Sequence[FeaturePoints]) -> list[Verdict]:
        """One verdict a candidate; the same whatever else is in the batch."""
        measured = self._measured(candidates)
        first = loss(self._tips(measured.moments), self.target)
        second = self.neighbour_weight * measured.neighbour_ratio
        rows = zip(candidates, measured.moments.area, measured.moments.is_stiff, strict=True)
        statuses = [_status(len(points), area, stiff) for points, area, stiff in rows]
        return [
            Verdict(float(L), float(K)) if status is Status.JUDGED else _failed(status)
            for L, K, status in zip(first, second, statuses, strict=True)
        ]

    def _measured(self, candidates: Sequence[FeaturePoints]) -> Phenotypes:
        return phenotypes(self.grid, candidates, self.wall_elements, self.rules)

    def _tips(self, moments: Moments) -> FloatArray:
        response = self.response_of(moments)
        with np.errstate(invalid="ignore"):
            return arc_tips(response.strains(self.pressures), self.length)


def _status(points: int, area: float, is_stiff: bool) -> Status:
    if points == 0:
        return Status.NO_FEATURE_POINTS
    if area == 0:
        return Status.NO_MATERIAL
    return Status.JUDGED if is_stiff else Status.NOT_STIFF


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
