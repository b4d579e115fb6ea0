"""Judging candidates: section → response → tips → loss, many at a time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from itertools import pairwise
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray, IndexArray
from beamopt.base.lost_workers import results_on
from beamopt.judge.answers import Answers, SectionQuestion
from beamopt.rod.ladder import RodModel, Rung, SectionValues
from beamopt.rod.pressure_tree import parents_on_grid
from beamopt.scene.scene import Scene
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.manufacturing import FREE, MakingRules
from beamopt.section.moments import Moments
from beamopt.section.phenotype import Phenotypes, phenotypes
from beamopt.section.saint_venant import section_saint_venant
from beamopt.section.seal import UNSEALED, SealRules
from beamopt.target.aim import Aim
from beamopt.target.target import Target
from beamopt.target.workspace import pressure_grid

__all__ = ["Judge", "JudgeStatus", "Verdict", "in_parts", "judge_all"]

Found = TypeVar("Found")


class JudgeStatus(Enum):
    """How judging a candidate ended; the value is the text shown to people.

    Examples
    --------
    >>> import beamopt
    >>> beamopt.JudgeStatus.NO_MATERIAL.value
    'the section has no material'
    """

    JUDGED = "judged"
    NO_FEATURE_POINTS = "recombination left no feature point"
    NO_MATERIAL = "the section has no material"
    NO_EQUILIBRIUM = "the rod has no stable equilibrium under its loads at some pressures"
    NOT_STIFF = "the section has too little material to compute its bending stiffness"
    TOO_MANY_CHAMBERS = "more separate chambers of a supply than the scene allows"


@dataclass(frozen=True, slots=True)
class Verdict:
    """The losses of one candidate.

    L : first objective, Σ of squared node distances [mm²]; infinite unless judged.
    K : second objective λ r; infinite unless judged.
    R : what the scene's weighted rules add [mm²]; 0 without any.

    Examples
    --------
    >>> import beamopt
    >>> beamopt.Verdict(L=10.0, K=2.0).T
    12.0
    """

    L: float
    K: float
    status: JudgeStatus = JudgeStatus.JUDGED
    R: float = 0.0

    def __repr__(self) -> str:
        rules = f", R = {self.R:.4g} mm²" if self.R else ""
        return f"<Verdict: L = {self.L:.4g} mm², K = {self.K:.4g}{rules}, {self.status.name}>"

    @property
    def T(self) -> float:
        """The total loss L + K + R, which selection looks at."""
        return self.L + self.K + self.R

    @property
    def ruled_loss(self) -> float:
        """L + R, which the best is chosen by: L itself where no rule is weighted."""
        return self.L + self.R


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
    making : what is asked of it beside its tips.

    Examples
    --------
    >>> import beamopt
    >>> import numpy as np
    >>> scene = beamopt.load_scene("random-section")
    >>> judge: beamopt.Judge = beamopt.Judge.of_scene(scene, scene.load_target())
    >>> design = scene.design_of(scene.random_points(np.random.default_rng(0)))
    >>> [verdict.status.name for verdict in judge([design.points])]
    ['JUDGED']
    """

    grid: PolarGrid
    wall_elements: int
    rod: RodModel
    levels: tuple[float, float, float]
    aim: Aim
    neighbour_weight: float
    rules: SealRules = UNSEALED
    making: MakingRules = FREE

    @classmethod
    def of_scene(cls, scene: Scene, target: Target) -> Judge:
        """Make the judge of a scene's candidates for `target`."""
        return cls(
            grid=scene.grid.build(),
            wall_elements=scene.wall_elements,
            rod=scene.climb.model,
            levels=scene.pressures.levels,
            aim=target.aim,
            neighbour_weight=scene.search.neighbour_weight,
            rules=scene.seal.rules,
            making=scene.making.rules(scene.grid.build(), scene.actuator.length),
        )

    def __repr__(self) -> str:
        sealed = "sealed" if self.rules.sealed else "unsealed"
        return (
            f"<Judge: {len(self.aim)} tips, {len(self.aim.paths)} points of trajectories, "
            f"rod {self.rod.rung.value}, {sealed} sections, λ = {self.neighbour_weight:g}>"
        )

    @cached_property
    def _parents(self) -> IndexArray | None:
        on_grid = np.array_equal(self.aim.pressures, pressure_grid(self.levels))
        return parents_on_grid() if on_grid else None

    def tips(self, candidates: Sequence[FeaturePoints]) -> FloatArray:
        """(n, rows, 3) tips of every candidate [mm]; NaN without material or equilibrium."""
        return self._answers(self.measured(candidates))[0].tips

    def __call__(self, candidates: Sequence[FeaturePoints]) -> list[Verdict]:
        """One verdict a candidate; the same whatever else is in the batch."""
        return self.verdicts(self.measured(candidates), [len(points) for points in candidates])

    def verdicts(self, measured: Phenotypes, counts: Sequence[int]) -> list[Verdict]:
        """Verdicts on sections that are measured already, made of `counts` feature points."""
        answers, found = self._answers(measured)
        first = answers.loss(self.aim)
        second = self.neighbour_weight * measured.neighbour_ratio
        moments = measured.moments
        third, rejected = self.making.weighted(measured), self.making.rejected(measured)
        rows = zip(counts, moments.area, moments.is_stiff, rejected, found, strict=True)
        statuses = [_status(*row) for row in rows]
        return [
            Verdict(float(L), float(K), status, float(R))
            if status is JudgeStatus.JUDGED
            else _failed(status)
            for L, K, R, status in zip(first, second, third, statuses, strict=True)
        ]

    def measured(self, candidates: Sequence[FeaturePoints]) -> Phenotypes:
        """Moments and counts of every candidate, and labels where the rod needs them."""
        asked = self.rod.twists, self.making.counts_chambers, self.making.symmetry
        return phenotypes(self.grid, candidates, self.wall_elements, self.rules, *asked)

    def loss_of(self, section: SectionValues) -> float:
        """L of one section by its values [mm²]; infinite without equilibrium."""
        answers, found = self.question.of_section(section)
        return float(answers.loss(self.aim)) if found else np.inf

    def settled(self, section: SectionValues | Moments) -> Aim:
        """The aim with its paths' points as rows at the pressures that bring this section nearest.

        The gradient of its loss by the section, at fixed pressures, is that of L; see
        `Aim.settled`. The aim itself where it has no paths.

        Raises
        ------
        ValueError : the section has no equilibrium, or no material.
        """
        if not self.aim.has_paths:
            return self.aim
        values = SectionValues(section) if isinstance(section, Moments) else section
        return self.aim.settled(self.question.reach(values).pressures)

    @cached_property
    def question(self) -> SectionQuestion:
        """What is asked of every section."""
        low, _, high = self.levels
        return SectionQuestion(self.rod, self.aim, low, high, self._parents)

    def _answers(self, measured: Phenotypes) -> tuple[Answers, NDArray[np.bool_]]:
        """Answers (n, …) of every candidate, and (n,) whether all of a candidate's are there."""
        count = len(measured.moments.area)
        found = np.ones(count, dtype=bool)
        if self.rod.rung is Rung.ARC:
            with np.errstate(invalid="ignore"):
                return self.question.of_arcs(measured.moments), found
        rows, points = len(self.aim), len(self.aim.paths)
        tips, ways = (np.full((count, rows, 3), np.nan) for _ in range(2))
        squares = np.full((count, points), np.nan)
        for k in np.flatnonzero(measured.moments.is_stiff).tolist():
            one, found[k] = self.question.of_section(self.values(measured, k))
            tips[k], ways[k] = one.tips, one.directions
            if one.squares is not None:
                squares[k] = one.squares
        return Answers(tips, ways, squares), found

    def values(self, measured: Phenotypes, k: int) -> SectionValues:
        """What the rod needs to know of the k-th of sections that are measured already."""
        moments = Moments(measured.moments.raw[k])
        if not self.rod.twists:
            return SectionValues(moments)
        if measured.saint_venant:
            return SectionValues(moments, measured.saint_venant[k])
        labels, nu = measured.labels[k], self.rod.poissons_ratio
        return SectionValues(moments, section_saint_venant(self.grid, labels, nu))


def _status(
    points: int, area: float, is_stiff: bool, rejected: bool, has_tips: bool
) -> JudgeStatus:
    if points == 0:
        return JudgeStatus.NO_FEATURE_POINTS
    if area == 0:
        return JudgeStatus.NO_MATERIAL
    if not is_stiff:
        return JudgeStatus.NOT_STIFF
    if rejected:
        return JudgeStatus.TOO_MANY_CHAMBERS
    return JudgeStatus.JUDGED if has_tips else JudgeStatus.NO_EQUILIBRIUM


def _failed(status: JudgeStatus) -> Verdict:
    return Verdict(np.inf, np.inf, status)


def judge_all(
    judge: Judge,
    candidates: Sequence[FeaturePoints],
    executor: Executor | None = None,
    workers: int = 1,
) -> list[Verdict]:
    """Judge a batch in `workers` parts on any executor; the verdicts do not depend on either.

    Raises
    ------
    NotComputedError : a worker of the executor died.
    """
    return in_parts(judge, candidates, executor, workers)


def in_parts(
    judged: Callable[[Sequence[FeaturePoints]], list[Found]],
    candidates: Sequence[FeaturePoints],
    executor: Executor | None,
    workers: int,
) -> list[Found]:
    """Results of `judged` for all candidates, in their order, asked in `workers` parts at a time.

    Raises
    ------
    NotComputedError : a worker of the executor died.
    """
    if executor is None or workers <= 1 or len(candidates) < 2 * workers:
        return judged(candidates)
    bounds = np.linspace(0, len(candidates), workers + 1).astype(int)
    parts = [candidates[a:b] for a, b in pairwise(bounds)]
    return [one for found in results_on(executor, judged, parts) for one in found]
