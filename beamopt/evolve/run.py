"""Running a search: from the first population to a reason to stop."""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import dataclass

from beamopt.evolve.algorithm import Generation, GeneticAlgorithm
from beamopt.evolve.improvement import Improvement
from beamopt.evolve.journal import Journal
from beamopt.evolve.stopping import StopReason, why_stop
from beamopt.judge import Judge, Status, judge_all
from beamopt.scene import Scene

__all__ = ["Ended", "run"]


@dataclass(frozen=True, slots=True)
class Ended:
    """How a search ended.

    status : why it stopped. history : one record a generation, the initial population first.
    seconds : time it took.
    """

    status: StopReason
    history: tuple[Generation, ...]
    seconds: float


def run(
    scene: Scene,
    judge: Judge,
    *,
    journal: Journal | None = None,
    executor: Executor | None = None,
    workers: int = 1,
    callback: Callable[[Generation], None] | None = None,
) -> Ended:
    """Ask, judge and tell until there is a reason to stop.

    Parameters
    ----------
    scene : the search's settings and its reasons to stop.
    judge : what candidates are judged with, usually `scene.judge(target)`.
    journal : where verdicts are kept; those it holds already are taken instead of judging again.
    executor, workers : judge each batch in `workers` parts on this executor; the result does not
        depend on either.
    callback : called after every generation with its record. KeyboardInterrupt, raised there or by
        Ctrl-C, ends the search with what it has, once it has a first population.

    Raises
    ------
    InputError : the journal is not this search's.
    """
    started = asking = time.perf_counter()
    improvement = Improvement(judge, scene) if scene.search.improved_share > 0 else None
    search = GeneticAlgorithm(scene, improvement)
    history: list[Generation] = []

    def told(record: Generation | None, seconds: float) -> StopReason | None:
        if record is None:
            return None
        history.append(record)
        if callback is not None:
            callback(record)
        return why_stop(scene, search, history, seconds)

    reason: StopReason | None = None
    try:
        for verdicts in journal.replay(search) if journal is not None else ():
            # what was judged already takes none of the time that this call may take
            reason = told(search.tell(verdicts), 0.0)
            if reason is not None:
                break
        asking = time.perf_counter()
        while reason is None:
            verdicts = judge_all(judge, search.ask(), executor, workers)
            if journal is not None:
                journal.write(search, verdicts)
            reason = told(search.tell(verdicts), time.perf_counter() - asking)
    except KeyboardInterrupt:
        if not history:
            raise
    status = reason or StopReason.INTERRUPTED
    if reason is not None and history[-1].best_ever.verdict.status is not Status.JUDGED:
        status = StopReason.NOTHING
    return Ended(status, tuple(history), time.perf_counter() - started)
