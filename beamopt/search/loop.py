"""Running a search: from the first population to a reason to stop."""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import dataclass, fields

from beamopt.base.errors import InputError
from beamopt.judge.judge import Judge, JudgeStatus, judge_all
from beamopt.scene.scene import Scene
from beamopt.search.algorithm import Generation, GeneticAlgorithm
from beamopt.search.history import History
from beamopt.search.improvement import Improvement
from beamopt.search.journal import SearchJournal
from beamopt.search.stopping import StopReason, why_stop
from beamopt.search.variation import Variation
from beamopt.storage.timing import Timing

__all__ = ["SearchOutcome", "run"]


@dataclass(frozen=True, slots=True)
class SearchOutcome:
    """How a search ended.

    status : why it stopped. last : the last generation.
    history : the numbers of every generation, the initial population first.
    timing : of what was judged now.
    """

    status: StopReason
    last: Generation
    history: History
    timing: Timing


def run(
    scene: Scene,
    judge: Judge,
    *,
    journal: SearchJournal | None = None,
    executor: Executor | None = None,
    workers: int = 1,
    callback: Callable[[Generation], None] | None = None,
    ready: Callable[[], None] | None = None,
) -> SearchOutcome:
    """Ask, judge and tell until there is a reason to stop.

    Parameters
    ----------
    scene : the search's settings and its reasons to stop.
    judge : what candidates are judged with, usually `beamopt.Judge.of_scene(scene, target)`.
    journal : where verdicts are kept; those it holds already are taken instead of judging again.
    executor, workers : judge each batch in `workers` parts on this executor; the result does not
        depend on either.
    callback : called after every generation with its record. KeyboardInterrupt, raised there or by
        Ctrl-C, ends the search with what it has, once it has a first population; while the
        journal is read it is raised again.
    ready : called once the journal is read and found to be this search's.

    Raises
    ------
    InputError : the journal is not this search's, or goes beyond a reason to stop.
    NotComputedError : a worker of the executor died; what is judged is in the journal.

    Examples
    --------
    >>> import beamopt
    >>> scene = beamopt.load_scene("random-section", ["search.generations=1"])
    >>> ended = beamopt.run(scene, beamopt.Judge.of_scene(scene, scene.load_target()))
    >>> ended.status.name
    'GENERATIONS'
    """
    improvement = Improvement(judge, scene) if scene.search.improved_share > 0 else None
    search = GeneticAlgorithm(scene, improvement)
    history = History()
    last: Generation | None = None

    def told(record: Generation | None, seconds: float) -> StopReason | None:
        nonlocal last
        if record is None:
            return None
        last = record
        history.add(record)
        if callback is not None:
            callback(record)
        return why_stop(scene, search, history, seconds)

    reason: StopReason | None = None
    for verdicts in journal.replay(search) if journal is not None else ():
        if journal is not None and reason is not None:
            raise _beyond(journal, scene, reason, len(history) - 1)
        # what was judged already takes none of the time that this call may take
        reason = told(search.tell(verdicts), 0.0)
    if ready is not None:
        ready()
    before = search.evaluations
    compiling = _compiling(judge, scene, search) if reason is None else 0.0
    asking = time.perf_counter()
    try:
        while reason is None:
            verdicts = judge_all(judge, search.ask(), executor, workers)
            if journal is not None:
                journal.write(search, verdicts)
            reason = told(search.tell(verdicts), time.perf_counter() - asking)
    except KeyboardInterrupt:
        if last is None:
            raise
    assert last is not None
    status = reason or StopReason.INTERRUPTED
    if reason is not None and last.best_ever.verdict.status is not JudgeStatus.JUDGED:
        status = StopReason.NOTHING
    judged = search.evaluations - before
    seconds = time.perf_counter() - asking if judged else 0.0
    return SearchOutcome(status, last, history, Timing(seconds, judged, compiling))


def _compiling(judge: Judge, scene: Scene, search: GeneticAlgorithm) -> float:
    """Run every kernel once, so that none is compiled while sections are timed; returns seconds.

    On a judge of its own: one that counts its calls counts those of the search only.
    """
    started = time.perf_counter()
    own = Judge(**{each.name: getattr(judge, each.name) for each in fields(Judge)})
    candidates = search.ask()[:1]
    own(candidates)
    Variation(scene).warm_up()
    if scene.search.improved_share > 0:
        Improvement(own, scene)(candidates[0], 0, 0)
    return time.perf_counter() - started


KEYS = {
    StopReason.GENERATIONS: "search.generations",
    StopReason.EVALUATIONS: "stop.evaluations",
    StopReason.STALL: "stop.stall",
    StopReason.LOSS: "stop.loss",
}
"""The key that a search stops for; a time is counted anew."""


def _beyond(
    journal: SearchJournal, scene: Scene, reason: StopReason, generation: int
) -> InputError:
    """The error of a search that was given less than it had before."""
    key = KEYS[reason]
    table, _, name = key.partition(".")
    value = getattr(getattr(scene, table), name)
    said = (
        f"the search there ended after generation {journal.last_generation}; this would end it "
        f"after {generation}: ask for as much, or name another folder"
    )
    return InputError(journal.path, key, value, said)
