"""`femcheck chart`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from time import perf_counter

from pydantic import TypeAdapter
from rich.markup import escape
from rich.table import Table

from beamopt.base.errors import InputError
from beamopt.cli.exit_codes import end_with
from beamopt.cli.findings import say_findings
from beamopt.cli.progress import console, progress_bar, say_workers
from beamopt.scene.grid_keys import Levels
from femcheck.chart.campaign import TimeBudget, run_chart
from femcheck.chart.chart import ACCURACIES, Chart, seconds_text
from femcheck.cli.request import RunRequest, options_of
from femcheck.cli.subjects import question_of
from femcheck.cli.verdicts import code_of
from femcheck.models.question import Question

__all__ = ["chart_command", "levels_of"]

LEVELS: TypeAdapter[tuple[float, float, float]] = TypeAdapter(Levels)


def chart_command(request: RunRequest, levels: str | None, families: Sequence[str]) -> None:
    """Ask every model, show progress, and say which is the cheapest."""
    if not request.budget > 0:
        raise InputError("--seconds", "", request.budget, "above 0 s")
    law = options_of(request)
    question = question_of(request.designs[0], request, law)
    say_findings(question.design)
    if levels is not None:
        changed = {"pressures": levels_of(levels)}
        question = Question.of(question.name, question.design.model_copy(update=changed), law)
    folder = request.out or Path("charts") / question.name
    say_workers(request.workers)
    started = perf_counter()
    with progress_bar("models") as bar:
        task = bar.add_task(escape(question.name), total=None, said="starting")

        def show(done: int, total: int, said: str) -> None:
            bar.update(task, completed=done, total=total, said=said)
            if bar.disable:
                spent = perf_counter() - started
                console.print(f"{done} of {total}, {spent / 60:.1f} min: {said}", markup=False)

        chart = run_chart(
            question,
            folder,
            families=families or None,
            budget=TimeBudget(request.budget),
            workers=request.workers,
            resume=request.resume,
            progress=show,
        )
    _report(chart, folder)
    end_with(code_of(chart))


def levels_of(text: str) -> tuple[float, float, float]:
    """Three pressures [kPa] of "0,5,10".

    Raises
    ------
    InputError : they are not three ascending pressures that a design may have.
    """
    try:
        return LEVELS.validate_python(tuple(float(part) for part in text.split(",")))
    except ValueError:  # a ValidationError is one
        allowed = "three ascending pressures in kPa up to 2000, as 0,5,10"
        raise InputError("--levels", "", text, allowed) from None


def _report(chart: Chart, folder: Path) -> None:
    for line in chart.sentences():
        console.print(line, soft_wrap=True, markup=False)
    table = Table(title="the cheapest of every family", title_justify="left")
    table.add_column("model")
    for accuracy in ACCURACIES:
        table.add_column(f"within {accuracy:g} mm", justify="right")
    for family in dict.fromkeys(row.measured.family for row in chart.rows):
        cells = []
        for accuracy in ACCURACIES:
            best = chart.cheapest(accuracy, family)
            told = best is not None and accuracy >= chart.uncertainty
            cells.append(seconds_text(best.measured.seconds) if told and best else "–")
        table.add_row(family, *cells)
    console.print(table)
    console.print(f"files: {folder}/ (chart.csv, chart.png, …)", soft_wrap=True, markup=False)
