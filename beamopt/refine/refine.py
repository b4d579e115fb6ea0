"""Refining a section: types by annealing, positions by Gauss-Newton, judged on the true section."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum

from beamopt.base.random_streams import Purpose, stream
from beamopt.judge.judge import Judge, Verdict
from beamopt.refine.annealing import Cooling, anneal
from beamopt.refine.gauss_newton import DescentLimits, descend
from beamopt.refine.orbits import orbits_of, with_cells
from beamopt.refine.truth import Judged, Truth, View, judged_on
from beamopt.scene.search_keys import Refining
from beamopt.section.cell_owners import distinct
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.symmetry import Symmetry

__all__ = [
    "RefineStage",
    "RefineStatus",
    "Refined",
    "StageRecord",
    "improved",
    "refine",
    "rounds_of",
]

ROUNDS, SEALED_ROUNDS = 6, 16
OTHER_ENDS = 3  # ends of rounds that outlines are sought of, besides the best one's
FAR = 2.0  # times a loss that is good enough; their neighbour ratios are higher
RATIO_SHARE = 3  # one in so many rounds, once settled, looks for a lower neighbour ratio
FROM_THE_START = 3  # every so many rounds nothing is kept of the ones before


class RefineStatus(Enum):
    """How a refinement ended; the value is the text shown to people."""

    REFINED = "refined"
    UNCHANGED = "nothing better was found; the feature points are as they were"
    SYMMETRISED = "nothing better was found than the section made symmetric"
    NOT_JUDGED = "the section to refine can not be judged"


class RefineStage(Enum):
    """What a refinement does; the value stands in its table."""

    START = "start"
    ANNEALING = "annealing of types"
    DESCENT = "descent of positions"
    OUTLINE = "descent on the outline"


@dataclass(frozen=True, slots=True)
class StageRecord:
    """What a stage ended in.

    round : from 1 on. evaluations : sections judged so far. verdict : of the section that it ended
    in, which need not be the best.
    """

    stage: RefineStage
    round: int
    evaluations: int
    verdict: Verdict


@dataclass(frozen=True, eq=False)
class Refined:
    """What a refinement came to.

    before, after : verdicts on what counts, the outline where it is sealed, else the raster; the
    loss L + R and K after it are never above those before, and so, where λ is not 0, neither is
    the neighbour ratio. A section that is to be symmetric and is not is made so before `before`.
    ratio_before, ratio : neighbour ratios. flips : proposed to the model.
    """

    status: RefineStatus
    points: FeaturePoints
    before: Verdict
    after: Verdict
    ratio_before: float
    ratio: float
    stages: tuple[StageRecord, ...]
    flips: int

    @property
    def evaluations(self) -> int:
        """Sections judged."""
        return self.stages[-1].evaluations if self.stages else 1


def refine(
    judge: Judge,
    points: FeaturePoints,
    settings: Refining | None = None,
    *,
    seed: int = 0,
    symmetry: Symmetry | None = None,
    callback: Callable[[StageRecord], None] | None = None,
) -> Refined:
    """Anneal types, then move points, in rounds until the loss is as low as moving can bring it.

    The same for the same seed. Sealed sections are judged on their raster first, in the end on
    their outline's moments.

    Parameters
    ----------
    judge : what sections are judged with. points : to start from.
    settings : how long, how hot; the defaults of a scene if left out.
    symmetry : that sections are to have; other points are made symmetric before anything else.
    callback : called after each stage.

    Raises
    ------
    ValueError : sections are sealed, and a feature point that has a cell is farther than 4·10⁶
        outer radii from the axis.
    """
    settings = settings or Refining()
    sealed = judge.rules.sealed
    counts = judged_on(judge, View.OUTLINE if sealed else View.RASTER)
    start = points if symmetry is None else with_cells(points, symmetry)
    before = counts(start)
    if not before.found:
        nothing = (StageRecord(RefineStage.START, 0, 1, before.verdict),)
        unjudged = replace(before, points=points)
        return _refined(RefineStatus.NOT_JUDGED, unjudged, unjudged, nothing, 0)
    work = _Work(judge, settings, seed, symmetry, callback)
    work.evaluations = 1  # that before
    best = work.rounds(before.points)
    if sealed and best.found:
        best = work.on_outlines(best, counts, before)
    better = best.loss <= before.loss and best.verdict.K <= before.verdict.K
    better = better and (best.loss < before.loss or best.verdict.K < before.verdict.K)
    status = RefineStatus.REFINED
    if not better:
        same = symmetry is None or _are_one(start, points)
        status = RefineStatus.UNCHANGED if same else RefineStatus.SYMMETRISED
        best = replace(before, points=points) if same else before
    return _refined(status, before, best, tuple(work.stages), work.flips)


def _are_one(one: FeaturePoints, other: FeaturePoints) -> bool:
    """Whether two sets make one section by the same points in the same places."""
    first, second = (
        sorted(zip(each.x.tolist(), each.y.tolist(), each.type.tolist(), strict=True))
        for each in (distinct(one), distinct(other))
    )
    return first == second


def _refined(
    status: RefineStatus,
    before: Judged,
    after: Judged,
    stages: tuple[StageRecord, ...],
    flips: int,
) -> Refined:
    ratios = before.ratio, after.ratio
    return Refined(status, after.points, before.verdict, after.verdict, *ratios, stages, flips)


def improved(
    judge: Judge,
    points: FeaturePoints,
    settings: Refining,
    *,
    seed: int,
    symmetry: Symmetry | None = None,
) -> tuple[FeaturePoints, int]:
    """What the rounds of a refinement come to on the raster, and how many sections they judged.

    For use inside a search, which judges what comes out like any other candidate; its outline is
    not looked at.
    """
    work = _Work(judge, settings, seed, symmetry, None)
    best = work.rounds(points)
    return (best.points if best.found else points), work.evaluations


def rounds_of(settings: Refining, sealed: bool) -> int:
    """The most rounds: more where a search takes its time too, because its sections are sealed."""
    return settings.rounds or (SEALED_ROUNDS if sealed else ROUNDS)


def _is_better(one: Judged, settled: bool, other: Judged, other_settled: bool) -> bool:
    """Whether to keep `one`: of two that are settled that with the lower T, else the lower loss."""
    if settled and other_settled:
        return one.verdict.T < other.verdict.T
    if settled != other_settled:
        return settled
    return one.loss < other.loss


class _Work:
    """The stages of one refinement, counted."""

    def __init__(
        self,
        judge: Judge,
        settings: Refining,
        seed: int,
        symmetry: Symmetry | None,
        callback: Callable[[StageRecord], None] | None,
    ) -> None:
        self.judge, self.settings, self.seed = judge, settings, seed
        self.symmetry, self.callback = symmetry, callback
        self.stages: list[StageRecord] = []
        self.ends: list[Judged] = []  # of rounds, K no higher than at first
        self.evaluations = self.flips = 0

    def rounds(self, points: FeaturePoints) -> Judged:
        """The best of all rounds on the raster, K no higher than at first."""
        settings, judge = self.settings, self.judge
        truth = judged_on(judge, View.RASTER)
        schedule = Cooling(
            settings.flips, settings.walks, settings.hot, min(settings.cold, settings.hot)
        )
        start = truth(with_cells(points, self.symmetry))
        self._told(RefineStage.START, 0, start, 1)
        if not start.found:
            return start
        enough = settings.ratio_enough * start.verdict.K
        best, is_settled, settled_in, here = start, False, 0, start
        rounds = rounds_of(settings, judge.rules.sealed)
        for number in range(1, rounds + 1):
            rng = stream(self.seed, Purpose.REFINEMENT, number)
            orbits = orbits_of(len(here.points), self.symmetry)
            annealed, judged = anneal(judge, truth, here, orbits, schedule, rng)
            self.flips += schedule.flips
            self._told(RefineStage.ANNEALING, number, annealed, judged)
            most = best.verdict.K if is_settled else start.verdict.K
            limits = DescentLimits(settings.steps, most, settings.good_enough)
            moved, judged, settled = descend(judge, truth, annealed, orbits, limits, rng)
            self._told(RefineStage.DESCENT, number, moved, judged)
            if moved.verdict.K <= start.verdict.K:
                self.ends.append(moved)
                if _is_better(moved, settled, best, is_settled):
                    best, is_settled = moved, settled
            settled_in = settled_in or (number if is_settled else 0)
            low = enough >= best.verdict.K
            if is_settled and (low or number >= settled_in + rounds // RATIO_SHARE):
                break
            here = start if number % FROM_THE_START == 0 else best
        return best

    def on_outlines(self, best: Judged, truth: Truth, before: Judged) -> Judged:
        """The last steps, on the polygons that a sealed section is.

        Where they stay far above a loss that is good enough, from the ends of other rounds too: a
        chamber of about the smallest area may be filled in one view only, which no step mends.
        """
        found = self._on_outline(best, truth, before)
        others = sorted((one for one in self.ends if one is not best), key=lambda one: one.loss)
        for other in others[:OTHER_ENDS]:
            if found.loss <= FAR * self.settings.good_enough:
                break
            moved = self._on_outline(other, truth, before)
            found = moved if moved.loss < found.loss else found
        return found

    def _on_outline(self, best: Judged, truth: Truth, before: Judged) -> Judged:
        orbits = orbits_of(len(best.points), self.symmetry)
        rng = stream(self.seed, Purpose.REFINEMENT, 0)
        start = truth(best.points)
        if not start.found:
            return before
        limits = DescentLimits(
            self.settings.outline_steps, before.verdict.K, self.settings.good_enough
        )
        moved, judged, _ = descend(self.judge, truth, start, orbits, limits, rng)
        self._told(RefineStage.OUTLINE, 0, moved, judged + 1)
        return moved

    def _told(self, stage: RefineStage, number: int, judged: Judged, evaluations: int) -> None:
        self.evaluations += evaluations
        record = StageRecord(stage, number, self.evaluations, judged.verdict)
        self.stages.append(record)
        if self.callback is not None:
            self.callback(record)
