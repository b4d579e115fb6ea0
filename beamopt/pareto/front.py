"""A front: what a search for several objectives found, and how it ended."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.brief import Brief
from beamopt.bound.certificate import Certificate
from beamopt.judge.judge import Judge, JudgeStatus
from beamopt.pareto.search import Candidate, FrontNumbers, front_values
from beamopt.plot.pareto import spans_decades
from beamopt.scene.design import Design
from beamopt.scene.scene import Scene
from beamopt.search.stopping import StopReason
from beamopt.storage.timing import Timing
from beamopt.storage.writing import csv_text

if TYPE_CHECKING:
    from pandas import DataFrame

__all__ = ["Front", "design_name", "designs_of", "front_csv"]

MOST_DESIGNS = 30

BENT = 0.95  # sum of both objectives; on the line between a front's ends it is 1


@dataclass(frozen=True, eq=False)
class Front:
    """The outcome of `find_front`.

    status : why it stopped. scene, objectives, population : what was searched for, and how.
    designs : the front, by the first objective, lowest first; each beats no other.
    history : the numbers of every generation, the initial population first.
    seen : (n, objectives) values of all that were judged.
    rejected : how many could not be judged or may not be made, by reason.
    timing : of the sections that were judged now.
    bound : how low L can be, whatever the section, or why that is not known.

    Examples
    --------
    >>> import beamopt
    >>> scene = beamopt.load_scene("random-section", ["search.generations=0"])
    >>> front: beamopt.Front = beamopt.find_front(scene, ["L", "mass"], population=8)
    >>> bool((front.values[1:, 0] > front.values[:-1, 0]).all())
    True
    """

    status: StopReason
    scene: Scene
    objectives: tuple[str, ...]
    population: int
    designs: tuple[Candidate, ...]
    history: tuple[FrontNumbers, ...]
    seen: FloatArray
    rejected: Mapping[JudgeStatus, int]
    timing: Timing
    bound: Certificate

    def __repr__(self) -> str:
        between = " and ".join(self.objectives)
        return (
            f"<Front {Brief(self.scene.name)}: {len(self.designs)} designs between {between}, "
            f"lowest L = {self.lowest_loss:.4g} mm², {self.evaluations} sections judged, "
            f"{self.status.name}>"
        )

    @property
    def seconds(self) -> float:
        """Time that the search took, without compiling [s]."""
        return self.timing.seconds

    @property
    def values(self) -> FloatArray:
        """(n, objectives) what the front's designs reach."""
        return front_values(self.designs, self.objectives)

    @property
    def lowest_loss(self) -> float:
        """L of the design with the lowest [mm²]; infinite without any."""
        return min((one.score.verdict.L for one in self.designs), default=math.inf)

    @property
    def evaluations(self) -> int:
        """Sections judged."""
        return self.history[-1].evaluations

    @property
    def knee(self) -> int:
        """The design farthest below the line between both ends, in the first two objectives.

        Each objective goes from 0 to 1 along the front, by its logarithm where its figure has
        that. Of a front without a bend it is the design in the middle.
        """
        sums = self._above_both
        return int(sums.argmin()) if self.bends else len(sums) // 2

    @property
    def bends(self) -> bool:
        """Whether there is a design well below the line between both ends."""
        return bool(self._above_both.min() < BENT)

    @property
    def _above_both(self) -> FloatArray:
        """(n,) sum of the first two objectives, each from 0 to 1; 1 on the line of the ends."""
        shown = self.values[:, :2].copy()
        for k in range(shown.shape[1]):
            shown[:, k] = np.log(shown[:, k]) if spans_decades(shown[:, k]) else shown[:, k]
        shown -= shown.min(axis=0)
        spread = shown.max(axis=0)
        return np.asarray((shown / np.where(spread > 0, spread, 1.0)).sum(axis=1))

    def to_frame(self) -> DataFrame:
        """Losses, masses and chambers of the front's designs, as a data frame (needs pandas)."""
        from beamopt.storage.frames import frame_of

        return frame_of(front_csv(self, Judge.of_scene(self.scene, self.scene.load_target())))

    def worth_keeping(self) -> list[int]:
        """Places of at most 30 designs along the front: best of each objective, knee, others."""
        count = len(self.designs)
        if count <= MOST_DESIGNS:
            return list(range(count))
        chosen = {0, self.knee, *self.values.argmin(axis=0).tolist()}
        evenly = np.linspace(0, count - 1, MOST_DESIGNS - len(chosen)).round().astype(int)
        return sorted(chosen | set(evenly.tolist()))


def designs_of(front: Front) -> dict[int, Design]:
    """Designs that get a file, by their places on the front."""
    return {k: _design(front, k) for k in front.worth_keeping()}


def design_name(k: int) -> str:
    """Name of a design's file, by its place on the front."""
    return f"front-{k:03d}.json"


def front_csv(front: Front, judge: Judge) -> str:
    """A row a design, by L: losses [mm²], ratio, mass [g], chambers per supply, its file if any.

    Of sealed designs that are kept also the L of the outline, which is what they are.
    """
    sealed, designs = front.scene.seal.rules.sealed, designs_of(front)
    header = "index,L,K,R,ratio,mass_g,chambers_1,chambers_2,chambers_3,design"
    rows = []
    for k, one in enumerate(front.designs):
        score, losses = one.score, one.score.verdict
        numbers = losses.L, losses.K, losses.R, score.ratio, score.mass
        row: list[object] = [k, *numbers, *score.chambers, design_name(k) if k in designs else None]
        if sealed:
            row.append(judge.loss_of(designs[k].values) if k in designs else None)
        rows.append(row)
    return csv_text(header + (",L_of_outline" if sealed else ""), rows)


def _design(front: Front, k: int) -> Design:
    one, scene = front.designs[k], front.scene
    losses = one.score.verdict
    values = dict(zip(front.objectives, one.score.values(front.objectives), strict=True))
    notes = {"scene": scene.name, "seed": scene.search.seed, **values, "L": losses.L, "K": losses.K}
    notes |= {"R": losses.R} if scene.making.rules_set else {}
    return scene.design_of(one.points, notes)
