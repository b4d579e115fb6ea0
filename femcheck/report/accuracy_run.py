"""Answers to an accuracy: a folder of `femcheck run --accuracy`, read back and as on the page."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from beamopt.storage.input_file import read_text
from femcheck.report.content import Record, ReportTable, read_record, read_table
from femcheck.report.embedding import Download, download
from femcheck.report.wording import Badge, duration, number

__all__ = ["AccuracyRun", "AccuracyView", "TipRow", "accuracy_view", "read_accuracy_run"]

PRESSURES, NUMBERS = ("p1", "p2", "p3"), ("x", "y", "z", "estimate_mm", "difference_mm")
TRIED = ("model", "unknowns", "found", "of")


@dataclass(frozen=True, eq=False)
class AccuracyRun:
    """A folder of `femcheck run --accuracy`.

    tips, tried, timing : its tables. design_text : the file of its design.
    """

    folder: Path
    summary: Record
    provenance: Record
    tips: ReportTable
    tried: ReportTable
    timing: ReportTable
    design_text: str

    @property
    def name(self) -> str:
        """Of the design."""
        return self.summary.text("design")

    @property
    def badge(self) -> Badge:
        """Whether the accuracy was reached."""
        reached = self.summary.flag("reached")
        return Badge("reached" if reached else "not reached", "good" if reached else "bad")

    @property
    def seconds(self) -> float:
        """Processor time of all that was tried [s]."""
        return float(self.timing.numbers("value").sum())


def read_accuracy_run(folder: Path) -> AccuracyRun:
    """Read an answer to an accuracy.

    Raises
    ------
    InputError : the first file that is missing or damaged.
    """
    summary = read_record(folder / "summary.json")
    for key in ("design", "law", "ending", "chosen", "reason"):
        summary.text(key)
    summary.flag("reached")
    summary.number("accuracy_mm")
    summary.number_or_nan("worst_estimate_mm")
    tips, tried, timing = (
        read_table(folder / name) for name in ("tips.csv", "tried.csv", "timing.csv")
    )
    tips.numbers(*PRESSURES, *NUMBERS)
    tips.column("status")
    tried.numbers(*TRIED[1:])
    timing.numbers("value")
    return AccuracyRun(
        folder,
        summary,
        read_record(folder / "provenance.json"),
        tips,
        tried,
        timing,
        read_text(folder / "design.json"),
    )


@dataclass(frozen=True, slots=True)
class TipRow:
    """A combination. cells : tip, estimate of its error, distance of the beam's tip [mm]."""

    pressures: tuple[str, ...]
    status: str
    cells: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class AccuracyView:
    """An answer to an accuracy on the page. tried : model, unknowns, tips found, time."""

    anchor: str
    heading: str
    badge: Badge
    text: str
    reason: str
    tiles: tuple[tuple[str, str], ...]
    rows: tuple[TipRow, ...]
    tried: tuple[tuple[str, ...], ...]
    downloads: tuple[Download, ...]


def accuracy_view(run: AccuracyRun, anchor: str) -> AccuracyView:
    """An answer to an accuracy."""
    summary = run.summary
    asked = f"{number(summary.number('accuracy_mm'))} mm"
    return AccuracyView(
        anchor,
        f"Tips to {asked}",
        run.badge,
        summary.text("ending"),
        _reason(summary),
        (
            ("law", summary.text("law")),
            ("accuracy asked for", asked),
            ("largest estimate", _estimate(summary)),
            ("answered by", summary.text("chosen")),
            ("processor time", duration(run.seconds)),
        ),
        tuple(_rows(run.tips)),
        tuple(_tried(run)),
        tuple(
            download(table, f"accuracy-{table.file.name}")
            for table in (run.tips, run.tried, run.timing)
        ),
    )


def _estimate(summary: Record) -> str:
    worst = summary.number_or_nan("worst_estimate_mm")
    return "none" if math.isnan(worst) else f"{number(worst)} mm"


def _reason(summary: Record) -> str:
    """Why this rung; what the error is estimated from, where the folder says it."""
    reason = summary.text("reason")
    if not summary.has("estimate_is"):
        return reason
    others = ", ".join(map(str, summary.list("compared_with")))
    against = f" ({summary.text('chosen')} against {others})" if others else ""
    return f"{reason}. Error: {summary.text('estimate_is')}{against}."


def _rows(tips: ReportTable) -> Iterator[TipRow]:
    pressures, numbers = tips.numbers(*PRESSURES), tips.numbers(*NUMBERS)
    for place, status in enumerate(tips.column("status")):
        cells = (number(value, 4) for value in numbers[place])
        yield TipRow(tuple(f"{value:.4g}" for value in pressures[place]), status, tuple(cells))


def _tried(run: AccuracyRun) -> Iterator[tuple[str, ...]]:
    unknowns, found, of = run.tried.numbers(*TRIED[1:]).T
    seconds = run.timing.numbers("value")[:, 0]
    for place, model in enumerate(run.tried.column("model")):
        time = duration(float(seconds[place])) if place < len(seconds) else "–"
        tips = f"{found[place]:.0f} of {of[place]:.0f}"
        yield model, f"{unknowns[place]:,.0f}", tips, time
