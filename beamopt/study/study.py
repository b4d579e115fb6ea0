"""Running a study: independent searches on any number of processes, then table and figures."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Literal

from pydantic import Field

from beamopt.base.errors import InputError
from beamopt.base.tasks import Tasks
from beamopt.refine.refine_design import Refinement
from beamopt.search.optimize import optimize
from beamopt.search.stopping import StopReason
from beamopt.storage.campaign import Campaign
from beamopt.storage.checked_keys import CheckedKeys, Count, parse, quantity
from beamopt.storage.input_file import read_json
from beamopt.storage.result_folder import FolderKind, claimed, clear_leftovers, own_subfolder
from beamopt.storage.timing import read_times
from beamopt.storage.writing import json_text, refuse_link, write_changed
from beamopt.study.plan import TARGETS, Plan, Run
from beamopt.study.report import names, write_report
from beamopt.study.table import Outcome, RefinedOutcome, StudyOutcomes

__all__ = ["run_study"]

Callback = Callable[[Outcome, int, int], None]


KIND = FolderKind("a study", "study.json", ('{"schema":"beamopt-study/',))


class StudyFile(CheckedKeys):
    """What `study.json` says of the study in its folder."""

    schema_: Literal["beamopt-study/1"] = Field(default="beamopt-study/1", alias="schema")
    seed: Count = quantity(..., "seed of the first iteration", low=0)
    overrides: list[str] = quantity(..., "keys replaced in every scene")
    iterations: Count = quantity(..., "runs of each target and combination", low=1)
    targets: list[str] = quantity(list(TARGETS), "bundled scenes that are searched")
    refine: bool = quantity(False, "whether every search ends by refining its best design")


def run_study(
    out: str | Path,
    plan: Plan | None = None,
    *,
    workers: int = 1,
    resume: bool = False,
    callback: Callback | None = None,
    figures: bool = True,
) -> StudyOutcomes:
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
    StudyOutcomes : a list of outcomes in the order of the table.

    Raises
    ------
    InputError : `out` holds something else, or can not be written.
    NotComputedError : the processes of some searches died; all others are done.

    Examples
    --------
    >>> import beamopt
    >>> small = ("search.generations=0",)
    >>> plan = beamopt.Plan(1, overrides=small, targets=("random-section",), refine=False)
    >>> len(beamopt.run_study("study", plan, figures=False))
    4
    """
    started = time.perf_counter()
    plan, folder = plan or Plan(), Path(out)
    runs = plan.runs()
    for run in {run.target: run for run in runs}.values():
        run.scene().load_target()  # complains before anything is written
    with claimed(folder, KIND, resume=resume):
        _prepare(folder, plan)
        ordered = StudyOutcomes(_outcomes(runs, folder, workers, callback))
        seconds = time.perf_counter() - started
        write_report(folder, ordered, plan, seconds, workers, figures=figures)
    return ordered


def run_one(run: Run, folder: Path) -> Outcome:
    """Run one search, or go on with it where it was left."""
    own = folder / "runs" / run.name
    refuse_link(own)
    result = optimize(run.scene(), own, resume=True, figures=False)
    if result.status is StopReason.INTERRUPTED:
        raise KeyboardInterrupt  # a cut search is no result; it is gone on with on resume
    last, times = result.last, read_times(own / "timing.csv")
    return Outcome(
        run,
        last.best.verdict,
        last.best_ever.verdict.L,
        result.evaluations,
        tuple(record.best_loss for record in result.history),
        times.get("search", math.nan),
        None
        if result.refinement is None
        else _refined(result.refinement, times.get("refinement", math.nan)),
    )


def _refined(found: Refinement, seconds: float) -> RefinedOutcome:
    refined = found.refined
    return RefinedOutcome(
        refined.before.L,
        refined.after.L,
        refined.ratio_before,
        refined.ratio,
        refined.evaluations,
        seconds,
    )


def _outcomes(
    runs: Sequence[Run], folder: Path, workers: int, callback: Callback | None
) -> list[Outcome]:
    """Outcomes of all runs, in this process or in `workers` others."""
    by_name = {run.name: run for run in runs}
    work = Tasks(run_one, {name: (run, folder) for name, run in by_name.items()})

    def report(_: str, outcome: Outcome) -> None:
        if callback is not None:
            callback(outcome, len(work.results) - len(work.lost), len(runs))

    Campaign(workers).solve_every(work, report, "--resume searches again")
    return [outcome for name in by_name if (outcome := work.results[name]) is not None]


def _prepare(folder: Path, plan: Plan) -> None:
    """Check that the study in the folder, if any, is the one asked for; keep what is asked."""
    asked = StudyFile(
        seed=plan.seed,
        overrides=list(plan.overrides),
        iterations=plan.iterations,
        targets=list(plan.targets),
        refine=plan.refine,
    )
    there = folder / KIND.marker
    if there.exists():
        _check_same(there, asked)
    clear_leftovers(folder, (there.name, *names(plan)))
    write_changed(there, json_text(asked.model_dump(by_alias=True)))
    own_subfolder(folder / "runs")


def _check_same(there: Path, asked: StudyFile) -> None:
    old = parse(StudyFile, read_json(there), there)
    for key in ("seed", "overrides", "targets", "refine"):
        before, now = getattr(old, key), getattr(asked, key)
        if before != now:
            raise InputError(there, key, before, f"the study there; now asked for: {now}")
    if old.iterations > asked.iterations:
        allowed = "a study can be given more iterations, not fewer"
        raise InputError(there, "iterations", old.iterations, allowed)
