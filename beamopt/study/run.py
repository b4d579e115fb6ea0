"""Running a study: independent searches on any number of processes, then table and figures."""

from __future__ import annotations

import json
import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from multiprocessing.connection import wait
from pathlib import Path
from typing import Any

from beamopt.errors import InputError
from beamopt.files import json_text, write_atomic
from beamopt.model import read_json
from beamopt.optimize import optimize
from beamopt.provenance import THREAD_SETTINGS
from beamopt.study.plan import Plan, Run
from beamopt.study.report import write_report
from beamopt.study.table import Outcome

__all__ = ["study"]

SCHEMA = "beamopt-study/1"


def study(
    out: str | Path,
    plan: Plan | None = None,
    *,
    workers: int = 1,
    resume: bool = False,
    callback: Callable[[Outcome, int, int], None] | None = None,
    figures: bool = True,
) -> list[Outcome]:
    """Run every search of a study and write its table, figures and designs to `out`.

    Parameters
    ----------
    out : the study's folder; every search has a run folder below `runs/`.
    plan : what to run; the paper's 48 searches if left out.
    workers : searches at once, each in a process of its own; the result does not depend on it.
    resume : go on with the study in `out`; it may be given more iterations.
    callback : called with each outcome as it comes, how many are done, and how many there are.
    figures : whether to draw.

    Returns
    -------
    list of Outcome : in the order of the table.

    Raises
    ------
    InputError : `out` holds something else, or can not be written.

    """
    started = time.perf_counter()
    plan, folder = plan or Plan(), Path(out)
    runs = plan.runs()
    for run in {run.target: run for run in runs}.values():
        run.scene().load_target()  # complains before anything is written
    _prepare(folder, plan, resume)
    outcomes: dict[Run, Outcome] = {}
    for outcome in _outcomes(runs, folder, workers):
        outcomes[outcome.run] = outcome
        if callback is not None:
            callback(outcome, len(outcomes), len(runs))
    ordered = [outcomes[run] for run in runs]
    seconds = time.perf_counter() - started
    write_report(folder, ordered, plan, seconds, workers, figures=figures)
    return ordered


def run_one(run: Run, folder: Path) -> Outcome:
    """Run one search, or go on with it where it was left."""
    result = optimize(run.scene(), folder / "runs" / run.name, resume=True, figures=False)
    last = result.history[-1]
    return Outcome(
        run,
        last.best.verdict,
        last.best_ever.verdict.L,
        result.evaluations,
        tuple(record.best.verdict.L for record in result.history),
        result.seconds,
    )


def _outcomes(runs: Sequence[Run], folder: Path, workers: int) -> Iterator[Outcome]:
    """Outcomes as they come: from this process, or from `workers` others."""
    if workers == 1:
        yield from (run_one(run, folder) for run in runs)
        return
    with _processes(workers) as executor:
        futures = [executor.submit(run_one, run, folder) for run in runs]
        for future in as_completed(futures):
            yield future.result()


@contextmanager
def _processes(workers: int) -> Iterator[Executor]:
    """Fresh processes with one thread each; on Ctrl-C the searches under way are finished."""
    before = {name: os.environ.get(name) for name in THREAD_SETTINGS}
    os.environ.update(dict.fromkeys(THREAD_SETTINGS, "1"))
    pool = ProcessPoolExecutor(
        workers, mp_context=multiprocessing.get_context("spawn"), initializer=_follow_first_process
    )
    try:
        yield pool
    finally:
        pool.shutdown(cancel_futures=True)
        for name, value in before.items():
            os.environ.pop(name) if value is None else os.environ.update({name: value})


def _follow_first_process() -> None:
    """Leave Ctrl-C, which goes to every process of a terminal, to the first one; end with it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    first = multiprocessing.parent_process()
    if first is not None:

        def end() -> None:
            wait([first.sentinel])
            os._exit(1)

        threading.Thread(target=end, daemon=True).start()


def _prepare(folder: Path, plan: Plan, resume: bool) -> None:
    """Make the folder, or check that the study in it is the one asked for."""
    described: dict[str, Any] = {
        "schema": SCHEMA,
        "seed": plan.seed,
        "overrides": list(plan.overrides),
        "iterations": plan.iterations,
    }
    there = folder / "study.json"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if any(folder.iterdir()) and not resume:
            raise InputError(folder, "", None, "holds files already; --resume goes on with a study")
        if there.exists():
            _check_same(there, described)
        write_atomic(there, json_text(described))
    except OSError as error:
        reason = (error.strerror or "can not be written").lower()
        raise InputError(folder, "", None, f"{reason}; name a folder that can be written") from None


def _check_same(there: Path, described: dict[str, Any]) -> None:
    old = read_json(there)
    for key in ("schema", "seed", "overrides"):
        if old.get(key) != described[key]:
            asked = json.dumps(described[key])
            raise InputError(there, key, old.get(key), f"the study there; now asked for: {asked}")
    if old.get("iterations", 0) > described["iterations"]:
        raise InputError(
            there,
            "iterations",
            old["iterations"],
            "a study can be given more iterations, not fewer",
        )
