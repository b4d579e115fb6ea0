"""Refining a design: what `beamopt refine` and the end of a search do."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

from beamopt.judge.judge import Judge
from beamopt.refine.refine import Refined, RefineStatus, StageRecord, improved, refine
from beamopt.scene.design import Design
from beamopt.scene.scene import Scene
from beamopt.scene.search_keys import Refining
from beamopt.section.feature_points import FeaturePoints
from beamopt.target.target import Target

__all__ = ["Refinement", "refine_design", "refine_points"]

SHORTEST = Refining(flips=10, walks=1, steps=1, rounds=1)


@dataclass(frozen=True, eq=False)
class Refinement:
    """A refined design.

    design : in L + R and in K never worse than the points before were, judged by the scene's rules.
    refined : how it came about. seconds : time it took.
    compiling : before it, for kernels to be compiled or loaded [s].

    Examples
    --------
    >>> import beamopt
    >>> little = ["search.generations=0", "refine.flips=100", "refine.rounds=1", "refine.steps=1"]
    >>> scene = beamopt.load_scene("random-section", little)
    >>> best = beamopt.optimize(scene).best
    >>> found: beamopt.Refinement = beamopt.refine_design(best, scene)
    >>> found.refined.after.L <= found.refined.before.L
    True
    """

    design: Design
    refined: Refined
    seconds: float
    compiling: float = 0.0

    def __repr__(self) -> str:
        before, after = self.refined.before.L, self.refined.after.L
        return (
            f"<Refinement: L from {before:.4g} to {after:.4g} mm², "
            f"{self.refined.evaluations} sections judged, {self.refined.status.name}>"
        )

    @property
    def times(self) -> dict[str, float]:
        """Seconds, by the names that `timing.csv` has them under."""
        return {"refinement": self.seconds, "refinement compilation": self.compiling}


def refine_design(
    design: Design,
    scene: Scene,
    target: Target | None = None,
    callback: Callable[[StageRecord], None] | None = None,
) -> Refinement:
    """Refine a design for a scene's target, after the scene's rules, whatever its own were.

    Raises
    ------
    InputError : the design is drawn, or the scene's target can not be used.

    Examples
    --------
    >>> import beamopt
    >>> little = ["search.generations=0", "refine.flips=100", "refine.rounds=1", "refine.steps=1"]
    >>> scene = beamopt.load_scene("random-section", little)
    >>> beamopt.refine_design(beamopt.optimize(scene).best, scene).refined.status.name
    'REFINED'
    """
    return refine_points(design.points, scene, target or scene.load_target(), callback)


def refine_points(
    points: FeaturePoints,
    scene: Scene,
    target: Target,
    callback: Callable[[StageRecord], None] | None = None,
) -> Refinement:
    """Refine feature points for a target; the same for the same scene, seed and points."""
    judge, symmetry = Judge.of_scene(scene, target), scene.making.repair(scene.grid.build())
    begun = time.perf_counter()
    improved(judge, points, SHORTEST, seed=0, symmetry=symmetry)  # runs every kernel once
    started = time.perf_counter()
    found = refine(
        judge,
        points,
        scene.refine,
        seed=scene.search.seed,
        symmetry=symmetry,
        callback=callback,
    )
    notes = {"scene": scene.name, "seed": scene.search.seed, **_losses(scene, found)}
    seconds = time.perf_counter() - started
    return Refinement(scene.design_of(found.points, notes), found, seconds, started - begun)


def _losses(scene: Scene, found: Refined) -> dict[str, object]:
    """What a design notes of its losses; nothing where it could not be judged."""
    if found.status is RefineStatus.NOT_JUDGED:
        return {}
    after, before = found.after, found.before
    losses: dict[str, object] = {"L": after.L, "K": after.K}
    if scene.making.rules_set:
        losses["R"] = after.R
    return losses | {"refined_from": {"L": before.L, "K": before.K}}
