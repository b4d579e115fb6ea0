"""Searching for a front: from the first population to the folder that shows it."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from pathlib import Path

from beamopt.base.errors import InputError
from beamopt.bound.certificate import quick_certificate
from beamopt.judge.judge import Judge, in_parts
from beamopt.pareto.folder import KIND, begin_folder, write_front
from beamopt.pareto.front import Front
from beamopt.pareto.journal import FrontJournal
from beamopt.pareto.scores import Score, scored
from beamopt.pareto.search import FrontNumbers, FrontRecord, FrontSearch, front_values
from beamopt.scene.generation_size import check_generation
from beamopt.scene.scene import Scene
from beamopt.search.stopping import StopReason
from beamopt.search.variation import Variation
from beamopt.section.feature_points import FeaturePoints
from beamopt.storage.result_folder import claimed
from beamopt.storage.timing import Timing

__all__ = ["POPULATION", "find_front"]

POPULATION = 100

Callback = Callable[[FrontRecord], None]


def find_front(
    scene: Scene,
    objectives: Sequence[str],
    out: str | Path | None = None,
    *,
    population: int = POPULATION,
    resume: bool = False,
    executor: Executor | None = None,
    workers: int = 1,
    callback: Callback | None = None,
    figures: bool = True,
) -> Front:
    """Search for designs of which none is better than another in all objectives.

    Parameters
    ----------
    scene : its sections, rules, operators, seed and number of generations.
    objectives : "L" and one or more of "ratio", "mass", "chambers"; see `chosen_objectives`.
    out : folder for the front; None keeps everything in memory.
    population : individuals of a generation.
    resume : go on with the search in `out`; it may be given more generations.
    executor, workers : judge each generation in `workers` parts; the result depends on neither.
    callback : called after every generation. KeyboardInterrupt, raised there or by Ctrl-C, ends
        the search with what it has, once it has a first population; while the journal is read it
        is raised again.

    Raises
    ------
    InputError : the target, or the folder or journal to go on with, can not be used; the search
        there has more generations than are asked for; or another process is writing to it.
    ImportError : pymoo is not installed.
    NotComputedError : a worker of the executor died; what is judged is in the folder.

    Examples
    --------
    >>> import beamopt
    >>> scene = beamopt.load_scene("random-section", ["search.generations=0"])
    >>> beamopt.find_front(scene, ["L", "mass"], population=8).evaluations
    8
    """
    points, elements = scene.section.feature_points, scene.grid.radial * scene.grid.angular
    check_generation("population", population, population, points, elements)
    search = FrontSearch(scene, objectives, population)
    target = scene.load_target()
    judge = Judge.of_scene(scene, target)
    judge = replace(judge, making=judge.making.counting())
    folder = None if out is None else Path(out)
    with ExitStack() as held:
        journal = None
        if folder is not None:
            held.enter_context(claimed(folder, KIND, resume=resume))
            journal = FrontJournal(folder / KIND.marker, scene, objectives, population)
            _check_length(journal, scene)
        history: list[FrontNumbers] = []
        judged = partial(scored, judge)
        evaluate = partial(in_parts, judged, executor=executor, workers=workers)

        def add(record: FrontRecord) -> None:
            values = front_values(record.front, objectives)
            history.append(FrontNumbers(record.index, record.evaluations, values))
            if callback is not None:
                callback(record)

        _replay(search, journal, add)
        if folder is not None:
            begin_folder(folder, scene)
        done, timing = _run(search, scene, evaluate, journal, add)
        ended = StopReason.GENERATIONS if search.front else StopReason.NOTHING
        front = Front(
            status=ended if done else StopReason.INTERRUPTED,
            scene=scene,
            objectives=tuple(objectives),
            population=population,
            designs=search.front,
            history=tuple(history),
            seen=search.seen,
            rejected=dict(search.rejected),
            timing=timing,
            bound=quick_certificate(scene, target),
        )
        if folder is not None:
            write_front(folder, front, judge, figures=figures)
    return front


def _check_length(journal: FrontJournal, scene: Scene) -> None:
    """Refuse to end a search earlier than it is."""
    there, asked = journal.last_generation, scene.search.generations
    if there > asked:
        said = f"at least {there}, as the search there has; or name another folder"
        raise InputError(journal.path, "search.generations", asked, said)


def _replay(search: FrontSearch, journal: FrontJournal | None, record: Callback) -> None:
    """Tell the search what is on record."""
    for scores in journal.replay(search) if journal is not None else ():
        record(search.tell(scores))


def _run(
    search: FrontSearch,
    scene: Scene,
    evaluate: Callable[[Sequence[FeaturePoints]], list[Score]],
    journal: FrontJournal | None,
    record: Callback,
) -> tuple[bool, Timing]:
    """Ask, judge and tell until all generations are done; says whether they are."""
    before, compiling, generations = search.evaluations, 0.0, scene.search.generations
    started = time.perf_counter()
    if search.generation <= generations and search.ask():
        Variation(scene).warm_up()
        evaluate(search.ask()[:1])  # every kernel once, so that none is compiled while it counts
        compiling = time.perf_counter() - started
    started, done = time.perf_counter(), False
    try:
        while search.generation <= generations and search.ask():
            scores = evaluate(search.ask())
            if journal is not None:
                journal.write(search, scores)
            record(search.tell(scores))
        done = True
    except KeyboardInterrupt:
        if search.generation == 0:
            raise
    judged = search.evaluations - before
    seconds = time.perf_counter() - started if judged else 0.0
    return done, Timing(seconds, judged, compiling)
