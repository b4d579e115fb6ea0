"""Optimise a scene: from a target workspace to a cross-section."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from pathlib import Path

from beamopt.judge.judge import Judge, JudgeStatus
from beamopt.refine.refine import StageRecord
from beamopt.refine.refine_design import refine_points
from beamopt.scene.design import Design
from beamopt.scene.scene import Scene
from beamopt.search.algorithm import Generation, Individual
from beamopt.search.journal import SearchJournal
from beamopt.search.loop import SearchOutcome, run
from beamopt.search.result import Optimisation
from beamopt.search.run_folder import RunFolder
from beamopt.search.stopping import StopReason
from beamopt.target.target import Target

__all__ = ["optimize"]


def optimize(
    scene: Scene,
    out: str | Path | None = None,
    *,
    resume: bool = False,
    executor: Executor | None = None,
    workers: int = 1,
    callback: Callable[[Generation], None] | None = None,
    refining: Callable[[StageRecord], None] | None = None,
    figures: bool = True,
) -> Optimisation:
    """Search for the section whose workspace is nearest to the scene's target.

    Parameters
    ----------
    scene : what to search, and how.
    out : the run folder; None keeps everything in memory.
    resume : go on with the run in `out` where it was left (also when it is complete).
    executor, workers, callback : see `beamopt.search.loop.run`.
    refining : called after every stage of a refinement, where the scene asks for one.
    figures : whether to draw into the run folder.

    Raises
    ------
    InputError : the target, or the folder or journal to go on with, can not be used.
    NotComputedError : a worker of the executor died; what is judged is in the folder.

    Examples
    --------
    >>> import beamopt
    >>> scene = beamopt.load_scene("random-section", ["search.generations=1"])
    >>> found = beamopt.optimize(scene, "run", figures=False)
    >>> found.evaluations
    38
    """
    target = scene.load_target()
    with ExitStack() as held:
        folder, journal = None, None
        if out is not None:
            folder = held.enter_context(RunFolder.open(Path(out), resume=resume))
            folder.check(scene)
            journal = held.enter_context(SearchJournal(folder.journal))
        ended = run(
            scene,
            Judge.of_scene(scene, target),
            journal=journal,
            executor=executor,
            workers=workers,
            callback=callback,
            ready=None if folder is None else partial(folder.begin, scene, target),
        )
        result = _refined(_result(scene, target, ended), refining)
        if folder is not None and not (_only_refining_was_cut(ended, result) and folder.has_result):
            result = replace(result, there=folder.write_result(result, figures=figures))
    return result


def _only_refining_was_cut(ended: SearchOutcome, result: Optimisation) -> bool:
    """True if the search had ended before, and refining it now was interrupted."""
    return ended.timing.judged == 0 and result.status is not ended.status


def _refined(result: Optimisation, callback: Callable[[StageRecord], None] | None) -> Optimisation:
    """With the best design refined, where the scene asks for it and the search came to an end."""
    ended = result.status is not StopReason.INTERRUPTED
    if not (result.scene.refine.finish and ended and result.verdict.status is JudgeStatus.JUDGED):
        return result
    points = result.last.best_ever.points
    try:
        found = refine_points(points, result.scene, result.target, callback)
    except KeyboardInterrupt:
        return replace(result, status=StopReason.INTERRUPTED)
    return replace(result, refinement=found)


def _result(scene: Scene, target: Target, ended: SearchOutcome) -> Optimisation:
    last = ended.last
    best, final = (_design(scene, one) for one in (last.best_ever, last.best))
    return Optimisation(ended.status, scene, target, best, final, last, ended.history, ended.timing)


def _design(scene: Scene, one: Individual) -> Design:
    verdict = one.verdict
    losses = {} if verdict.status is not JudgeStatus.JUDGED else {"L": verdict.L, "K": verdict.K}
    if losses and scene.making.rules_set:
        losses["R"] = verdict.R
    return scene.design_of(one.points, {"scene": scene.name, "seed": scene.search.seed, **losses})
