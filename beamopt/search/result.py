"""What a search found, and how it ended."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from beamopt.base.brief import Brief
from beamopt.bound.certificate import Certificate, quick_certificate
from beamopt.judge.answers import Answers
from beamopt.judge.judge import Judge, Verdict
from beamopt.reach.reach import Reach
from beamopt.refine.folder import EarlierRefinement
from beamopt.refine.refine_design import Refinement
from beamopt.rod.ladder import Rung
from beamopt.rod.pressure_tree import parents_on_grid
from beamopt.scene.design import Design
from beamopt.scene.scene import Scene
from beamopt.search.algorithm import Generation
from beamopt.search.history import History
from beamopt.search.stopping import StopReason
from beamopt.storage.timing import Timing
from beamopt.target.target import Target
from beamopt.target.workspace import pressure_grid

if TYPE_CHECKING:
    from pandas import DataFrame

__all__ = ["Optimisation"]


@dataclass(frozen=True, eq=False)
class Optimisation:
    """The outcome of `optimize`.

    status : why it stopped.
    scene, target : what was searched for.
    best : the design with the lowest L + R of all that were judged.
    final : the design with the lowest L + R in the last population, the paper's result.
    last : the last generation.
    history : the numbers of every generation, the initial population first.
    timing : of the sections that were judged now.
    refinement : of the best design, where the scene asks for it and there was one.
    there : what became of a refinement that the run folder held already.

    Examples
    --------
    >>> import beamopt
    >>> scene = beamopt.load_scene("random-section", ["search.generations=0"])
    >>> found: beamopt.Optimisation = beamopt.optimize(scene)
    >>> found.status.name
    'GENERATIONS'
    """

    status: StopReason
    scene: Scene
    target: Target
    best: Design
    final: Design
    last: Generation
    history: History
    timing: Timing
    refinement: Refinement | None = None
    there: EarlierRefinement = EarlierRefinement.NONE

    def __repr__(self) -> str:
        return (
            f"<Optimisation {Brief(self.scene.name)}: L = {self.verdict.L:.4g} mm², "
            f"{self.rms_distance:.3g} mm a tip, {self.evaluations} sections judged, "
            f"{self.status.name}>"
        )

    @property
    def seconds(self) -> float:
        """Time that the search took, without compiling [s]."""
        return self.timing.seconds

    @property
    def verdict(self) -> Verdict:
        """Losses L, K, T of the best design."""
        return self.last.best_ever.verdict

    @property
    def rms_distance(self) -> float:
        """Root mean square distance of the best design's tips from the target's [mm]."""
        return self.target.aim.rms_distance(self.verdict.L)

    @property
    def outline_loss(self) -> float:
        """L of what the best design is [mm²]: of its outline where it is sealed.

        The search judges a raster; for unsealed designs the two are the same. Infinite where the
        outline's rod has no equilibrium.
        """
        return self._judge.loss_of(self.best.values)

    @cached_property
    def answers(self) -> Answers:
        """The best design's tips at the target's pressures, NaN where its rod has none."""
        return self._judge.question.of_section(self.best.values)[0]

    @cached_property
    def reach(self) -> Reach | None:
        """How the best design follows the target's trajectories; None where it has none."""
        return self._judge.question.reach(self.best.values) if self.target.paths else None

    def to_frame(self) -> DataFrame:
        """Tips of the best design and of the target, a row each, as a data frame (needs pandas)."""
        from beamopt.judge.answer_tables import tips_table_csv
        from beamopt.storage.frames import frame_of

        return frame_of(tips_table_csv(self.target.aim, self.answers))

    @cached_property
    def _judge(self) -> Judge:
        return Judge.of_scene(self.scene, self.target)

    @cached_property
    def bound(self) -> Certificate:
        """How low L can be for this target, whatever the section."""
        return quick_certificate(self.scene, self.target)

    @property
    def neglected(self) -> float | None:
        """How far the loads that its rung leaves out move the best design's tips at most [mm].

        None where nothing is left out; infinite where there is no equilibrium under them.
        """
        model, design = self.scene.climb.model, self.best
        if not model.loads.any or model.rung is Rung.LOADED:
            return None
        pressures = pressure_grid(self.scene.pressures.levels)
        full = model.on(Rung.LOADED).tips(design.values, pressures, parents_on_grid())
        away = np.linalg.norm(full.positions - design.workspace.tips, axis=1)
        return float(away.max()) if full.failure is None else math.inf

    @property
    def evaluations(self) -> int:
        """Sections judged."""
        return self.last.evaluations
