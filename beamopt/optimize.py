"""Optimise a scene: from a target workspace to a cross-section."""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import Executor
from contextlib import nullcontext
from pathlib import Path

from beamopt.design import Design
from beamopt.evolve.algorithm import Generation, GeneticAlgorithm, Individual
from beamopt.evolve.journal import Journal
from beamopt.evolve.stopping import StopReason, why_stop
from beamopt.judge import Status, judge_all
from beamopt.result import Optimisation
from beamopt.run_folder import RunFolder
from beamopt.scene import Scene
from beamopt.target import Target

__all__ = ["optimize"]


def optimize(
    scene: Scene,
    out: str | Path | None = None,
    *,
    resume: bool = False,
    executor: Executor | None = None,
    workers: int = 1,
    callback: Callable[[Generation], None] | None = None,
    figures: bool = True,
) -> Optimisation:
    """Search for the section whose workspace is nearest to the scene's target.

    Parameters
    ----------
    scene : what to search, and how.
    out : the run folder; None keeps everything in memory.
    resume : go on with the run in `out` where it was left (also when it is complete).
    executor, workers : judge each batch in `workers` parts on this executor; the result does not
        depend on either.
    callback : called after every generation with its record. KeyboardInterrupt, raised there or by
        Ctrl-C, ends the search with what it has.
    figures : whether to draw into the run folder.

    Raises
    ------
    InputError : the target, or the folder or journal to go on with, can not be used.

    """
    started = time.perf_counter()
    target = scene.load_target()
    folder = None if out is None else RunFolder.open(Path(out), scene, target, resume=resume)
    judge = scene.judge(target)
    search = GeneticAlgorithm(scene)
    history: list[Generation] = []
    status = StopReason.INTERRUPTED

    def complete(record: Generation | None) -> bool:
        """Whether the search ends with this record."""
        nonlocal status
        if record is None:
            return False
        history.append(record)
        if callback is not None:
            callback(record)
        reason = why_stop(scene, search, history, time.perf_counter() - started)
        status = reason or status
        return reason is not None

    with nullcontext() if folder is None else Journal(folder.journal) as journal:
        try:
            done = False
            for verdicts in journal.replay(search) if journal is not None else ():
                done = complete(search.tell(verdicts))
                if done:
                    break
            while not done:
                verdicts = judge_all(judge, search.ask(), executor, workers)
                if journal is not None:
                    journal.write(search, verdicts)
                done = complete(search.tell(verdicts))
        except KeyboardInterrupt:
            if not history:
                raise
    result = _result(status, scene, target, history, time.perf_counter() - started)
    if folder is not None:
        folder.write_result(result, figures=figures)
    return result


def _result(
    status: StopReason,
    scene: Scene,
    target: Target,
    history: list[Generation],
    seconds: float,
) -> Optimisation:
    last = history[-1]
    best, final = (_design(scene, one) for one in (last.best_ever, last.best))
    return Optimisation(status, scene, target, best, final, tuple(history), seconds)


def _design(scene: Scene, one: Individual) -> Design:
    verdict = one.verdict
    losses = {} if verdict.status is not Status.JUDGED else {"L": verdict.L, "K": verdict.K}
    return scene.design_of(one.points, {"scene": scene.name, "seed": scene.search.seed, **losses})
