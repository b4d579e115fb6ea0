"""`femcheck run --accuracy`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from rich.markup import escape
from rich.table import Table

from beamopt.base.errors import InputError
from beamopt.cli.exit_codes import end_with, joined
from beamopt.cli.findings import say_findings
from beamopt.cli.progress import console, counted, say_workers
from femcheck.accuracy.ending import Within, beam_difference
from femcheck.accuracy.folder import run_accuracy
from femcheck.accuracy.within import RungChoice
from femcheck.chart.chart import seconds_text
from femcheck.cli.request import RunRequest
from femcheck.cli.subjects import folders_of, question_of, refuse_twins
from femcheck.cli.verdicts import code_of
from femcheck.models.question import LawChoice, Question
from femcheck.solid.elements import DEFAULT_ELEMENT

__all__ = ["accuracy_command", "accuracy_of"]

RUNGS: tuple[RungChoice, ...] = ("auto", "beam", "solid")


def accuracy_of(text: str) -> float:
    """ "0.1mm", "0.1 mm" or "0.1" as millimetres.

    Raises
    ------
    InputError : it is none above 0.
    """
    number = text.strip().removesuffix("mm").strip()
    try:
        value = float(number)
    except ValueError:
        value = np.nan
    if not 0 < value < np.inf:
        raise InputError("--accuracy", "", text, "a length above 0, as 0.1mm")
    return value


def accuracy_command(request: RunRequest, options: LawChoice) -> None:
    """Answer every question to the accuracy; end with the code of all verdicts."""
    rung, accuracy = _rung(request.rung), accuracy_of(request.accuracy or "")
    for name, usual in (("layers", None), ("element", DEFAULT_ELEMENT), ("size", 1.0)):
        value = getattr(request, name)
        if value != usual:
            raise InputError(f"--{name}", "", value, "chosen by --accuracy: leave it out")
    if not request.budget > 0:
        raise InputError("--budget", "", request.budget, "above 0 s")
    questions = _questions(request, options)
    folders = folders_of(request, [question.name for question in questions])
    say_workers(request.workers)
    codes = []
    for question, folder in zip(questions, folders, strict=True):
        found = _followed(question, accuracy, rung, folder, request)
        _report(found, folder)
        codes.append(code_of(found, options.agree))
    end_with(joined(codes))


def _questions(request: RunRequest, options: LawChoice) -> list[Question]:
    """Of designs, runs and scenes; loads are welcome, as long as the law is the beam's."""
    questions = [question_of(source, request, options) for source in request.designs]
    for one in questions:
        say_findings(one.design, one.name if len(questions) > 1 else "")
    refuse_twins(request, [question.name for question in questions])
    return questions


def _rung(text: str) -> RungChoice:
    for rung in RUNGS:
        if rung == text:
            return rung
    raise InputError("--rung", "", text, f"one of {', '.join(RUNGS)}")


def _followed(
    question: Question, accuracy: float, rung: RungChoice, folder: Path, request: RunRequest
) -> Within:
    with counted("models", question.name, said="choosing") as show:
        try:
            return run_accuracy(
                question,
                accuracy,
                folder,
                rung=rung,
                most_seconds=request.budget,
                workers=request.workers,
                resume=request.resume,
                progress=show,
            )
        except InputError as error:
            if error.key != "rung":
                raise
            raise InputError("--rung", "", error.value, error.allowed) from None


def _report(found: Within, folder: Path) -> None:
    console.print(f"[bold]{escape(found.question.name)}[/]")
    lines = [
        ("law", found.question.law_text),
        ("rung", found.reason),
        ("chosen", f"{found.chosen}, {seconds_text(found.seconds)} of processor time in all"),
        *(("tried", _tried(one)) for one in _described(found)),
        (f"{found.accuracy:g} mm", found.ending.value),
        ("error", _error(found)),
        ("files", f"{folder}/ (tips.csv, tried.csv, summary.json, …)"),
    ]
    for name, text in lines:
        console.print(f"  {name:<16}{text}", soft_wrap=True, markup=False)
    if found.reply is not None:
        console.print(_table(found))


def _error(found: Within) -> str:
    """What is known of the error, and from which comparison."""
    if np.isnan(found.worst):
        return found.source.value
    others = ", ".join(found.compared_with)
    source = f"{found.source.value} ({found.chosen} against {others})"
    return f"estimated up to {found.worst:.2g} mm: {source}"


def _described(found: Within) -> list[tuple[str, str, float]]:
    return [(one.name, one.reply.size, one.seconds) for one in found.tried]


def _tried(one: tuple[str, str, float]) -> str:
    name, size, seconds = one
    meshed = f" ({size})" if size else ""
    return f"{name}{meshed}: {seconds_text(seconds)}"


def _table(found: Within) -> Table:
    assert found.reply is not None
    _, difference = beam_difference(found)
    table = Table(title=f"tips, {found.question.law_text}", title_justify="left")
    for name in ("p1 [kPa]", "p2", "p3", "x [mm]", "y", "z", "± [mm]", "beam differs [mm]"):
        table.add_column(name, justify="right")
    table.add_column("status")
    for row, pressures in enumerate(found.question.pressures.tolist()):
        tip, estimate, away = found.reply.tips[row], found.estimate[row], difference[row]
        table.add_row(
            *(f"{value:g}" for value in pressures),
            *("–" if np.isnan(x) else f"{x:.3f}" for x in tip),
            "–" if np.isnan(estimate) else f"{estimate:.2g}",
            "–" if np.isnan(away) else f"{away:.3f}",
            str(found.reply.endings[row]),
        )
    return table
