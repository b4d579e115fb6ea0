"""Making a chart: every model asked once, each on a core of its own; a kill loses little."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor, Future
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path

import numpy as np

from beamopt.base.errors import InputError
from beamopt.base.processes import processes
from beamopt.base.provenance import provenance
from beamopt.base.tasks import Work
from beamopt.plot.style import save_figure
from beamopt.storage.campaign import Campaign, Pool, Progress, claimed_journal
from beamopt.storage.result_folder import FolderKind
from beamopt.storage.writing import csv_text, json_text, write_atomic
from femcheck.chart.chart import ACCURACIES, Chart, chart_csv
from femcheck.chart.figure import chart_figure
from femcheck.chart.kept import JOURNAL, SUBJECT, asked_of, chart_of, measured_in
from femcheck.chart.lineup import Series, line_up
from femcheck.chart.measure import Measured, key_of, measure, written
from femcheck.continuation.ended import Ended, NoReply
from femcheck.continuation.outcome import Status
from femcheck.models.question import Question
from femcheck.models.reply import Model, nothing
from femcheck.models.solid import SolidModel
from femcheck.solved.folder import PACKAGES

__all__ = ["TimeBudget", "run_chart"]

CHEAPEST = "accuracy_mm,family,resolution,error_mm,cpu_seconds"
FILES = (
    *("chart.csv", "cheapest.csv", "reading.md", "provenance.json"),
    *("chart.svg", "chart.png"),
)
KIND = FolderKind("a chart", JOURNAL, ('{"schema":"femcheck-chart/',), files=FILES)
GROWTH = 1.8  # a finer model of a series takes at least so many times as long


@dataclass(frozen=True, slots=True)
class TimeBudget:
    """seconds : of processor time that a model may be expected to take; others are left out.

    None are left out by default.
    """

    seconds: float = np.inf


def run_chart(
    question: Question,
    out: Path,
    *,
    families: Sequence[str] | None = None,
    budget: TimeBudget | None = None,
    workers: int = 1,
    resume: bool = False,
    progress: Progress | None = None,
    pool: Pool = processes,
) -> Chart:
    """Ask all models and write table, figure, reading and provenance to `out`.

    Parameters
    ----------
    families : of which models are asked; all if left out.
    workers : models asked at once.
    resume : go on with what is in `out`; where all is there, only the files are written anew.
    progress : called with how many models are done, how many there are, and what was last.

    Raises
    ------
    InputError : `out` holds something else, or can not be written; there is no such family.

    Examples
    --------
    >>> import femcheck
    >>> from pathlib import Path
    >>> import beamopt
    >>> drawn = beamopt.load_design(str(beamopt.load_scene("gravity").target.file))
    >>> subject = femcheck.sealed_copy("round", drawn, 1.0)
    >>> question = femcheck.Question.of("round", subject.design, femcheck.CheckOptions())
    >>> chart = femcheck.run_chart(question, Path("chart"), families=["beam"])
    >>> len(chart.rows)
    1
    """
    series = line_up(question, families)
    if not series:
        raise InputError("--family", "", ", ".join(families or ()), "none of them can be asked")
    with claimed_journal(out, KIND, asked_of(question), SUBJECT, resume=resume) as journal:
        measured = measured_in(journal, question.law.limits.iterations)
        work = _ChartWork(question, series, budget or TimeBudget(), measured)

        def store(_: str, one: Measured) -> None:
            if np.isfinite(one.seconds):  # what was left out may be asked with more time
                journal.add(written(one))

        Campaign(workers, pool, progress).solve(work, store, lambda key, _: key)
        chart = chart_of(question, measured)
        _write(chart, out, workers)
    return chart


@dataclass
class _ChartWork(Work[str, Measured]):
    """Each series from coarse to fine: a finer model waits until its cost can be guessed.

    results : replies by model, those of earlier charts among them.
    """

    question: Question
    series: Sequence[Series]
    budget: TimeBudget
    results: dict[str, Measured]

    def __post_init__(self) -> None:
        self._models = {key_of(m): (one, m) for one in self.series for m in one.all}

    @property
    def keys(self) -> list[str]:
        """Series by series."""
        return list(self._models)

    def is_ready(self, key: str) -> bool:
        """Whether all coarser models of its series are done."""
        series, model = self._models[key]
        coarser = takewhile(lambda one: one is not model, series.all)
        return all(key_of(one) in self.results for one in coarser)

    def submit(self, executor: Executor, key: str) -> Future[Measured]:
        """Have a model asked; one that takes too long is left out."""
        series, model = self._models[key]
        why = _too_dear(series, model, self.results, self.budget)
        if why is None:
            return executor.submit(measure, self.question, model)
        left_out: Future[Measured] = Future()
        left_out.set_result(_without(self.question, model, why))
        return left_out

    def stopped(self, key: str) -> Measured:
        """The reply of a model whose process died; --resume asks it again."""
        return _without(self.question, self._models[key][1], Ended(Status.STOPPED))


def _too_dear(
    series: Series, model: Model, measured: dict[str, Measured], budget: TimeBudget
) -> Ended | None:
    """Why a model is left out; None where it is asked."""
    guess = _guessed(series, model, measured)
    if guess > budget.seconds:
        return Ended(NoReply.TOO_DEAR, detail=f"more than {budget.seconds:g} s")
    return Ended(NoReply.UNKNOWN_COST) if guess == np.inf else None


def _guessed(series: Series, model: Model, measured: dict[str, Measured]) -> float:
    """Seconds that a model will take, at least; infinite where a coarser one has none."""
    if model in series.models:
        coarser = series.models[: series.models.index(model)]
        known = [measured[key_of(one)].seconds for one in coarser]
        grown = known[-1] / known[-2] if len(known) > 1 and known[-2] > 0 else GROWTH
        guess = known[-1] * max(grown, 1.0) if known else 0.0
    else:
        guess = next(
            measured[key_of(one)].seconds * one.size / model.size
            for one in series.models
            if isinstance(one, SolidModel) and isinstance(model, SolidModel)
            if one.layers == model.layers
        )
    return np.inf if np.isnan(guess) else guess


def _without(question: Question, model: Model, why: Ended) -> Measured:
    return Measured(model.family, model.resolution, nothing(question, why), float("nan"))


def _write(chart: Chart, out: Path, workers: int) -> None:
    write_atomic(out / "chart.csv", chart_csv(chart))
    best = [
        (accuracy, one.measured.family, one.measured.resolution, one.error, one.measured.seconds)
        for accuracy in ACCURACIES
        if accuracy >= chart.uncertainty
        for one in chart.within(accuracy)
    ]
    write_atomic(out / "cheapest.csv", csv_text(CHEAPEST, best))
    write_atomic(out / "reading.md", "\n".join(f"- {line}" for line in chart.sentences()) + "\n")
    said = {"workers": workers, "design": chart.question.name, "law": chart.question.law_text}
    about = {"measured_with": chart.made_with, **provenance(PACKAGES)}
    write_atomic(out / "provenance.json", json_text({**said, **about}))
    save_figure(chart_figure(chart), out / "chart.svg", out / "chart.png")
