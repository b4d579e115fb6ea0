"""Searching for a front: from the first population to the folder that shows it."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from beamopt.bound.certificate import quick_certificate
from beamopt.evolve.stopping import StopReason
from beamopt.file_lock import locked
from beamopt.folder import claim_folder
from beamopt.judge import in_parts
from beamopt.pareto.folder import JOURNAL, begin_folder, write_front
from beamopt.pareto.front import Front
from beamopt.pareto.journal import FrontJournal
from beamopt.pareto.scores import Score, scored
from beamopt.pareto.search import FrontRecord, FrontSearch
from beamopt.scene import Scene
from beamopt.section.feature_points import FeaturePoints

__all__ = ["POPULATION", "find_front"]

POPULATION = 100


def find_front(
    scene: Scene,
    objectives: Sequence[str],
    out: str | Path | None = None,
    *,
    population: int = POPULATION,
    resume: bool = False,
    executor: Executor | None = None,
    workers: int = 1,
    callback: Callable[[FrontRecord], None] | None = None,
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
        the search with what it has, once it has a first population.

    Raises
    ------
    InputError : the target, or the folder or journal to go on with, can not be used; or another
        process is writing to it.
    ImportError : pymoo is not installed.
    """
    search = FrontSearch(scene, objectives, population)
    target = scene.load_target()
    judge = scene.judge(target)
    judge = replace(judge, making=judge.making.counting())
    folder = None if out is None else Path(out)
    with ExitStack() as held:
        journal = None
        if folder is not None:
            claim_folder(folder, JOURNAL, resume=resume)
            held.enter_context(locked(folder / JOURNAL))
            journal = FrontJournal(folder / JOURNAL, scene, objectives, population)
            begin_folder(folder, scene)
        started = time.perf_counter()
        history: list[FrontRecord] = []
        judged = partial(scored, judge)
        evaluate = partial(in_parts, judged, executor=executor, workers=workers)
        status = _run(search, scene.search.generations, evaluate, journal, history, callback)
        front = Front(
            status=status,
            scene=scene,
            objectives=tuple(objectives),
            population=population,
            history=tuple(history),
            seen=np.array(search.seen).reshape(-1, len(objectives)),
            rejected=dict(search.rejected),
            seconds=time.perf_counter() - started,
            bound=quick_certificate(scene, target),
        )
        if folder is not None:
            write_front(folder, front, judge, figures=figures)
    return front


def _run(
    search: FrontSearch,
    generations: int,
    evaluate: Callable[[Sequence[FeaturePoints]], list[Score]],
    journal: FrontJournal | None,
    history: list[FrontRecord],
    callback: Callable[[FrontRecord], None] | None,
) -> StopReason:
    """Ask, judge and tell until all generations are done; records go to `history`."""

    def told(scores: list[Score]) -> None:
        history.append(search.tell(scores))
        if callback is not None:
            callback(history[-1])

    try:
        for scores in journal.replay(search) if journal is not None else ():
            if search.generation > generations:
                break
            told(scores)
        while search.generation <= generations and search.ask():
            scores = evaluate(search.ask())
            if journal is not None:
                journal.write(search, scores)
            told(scores)
    except KeyboardInterrupt:
        if not history:
            raise
        return StopReason.INTERRUPTED
    return StopReason.GENERATIONS if history[-1].front else StopReason.NOTHING
