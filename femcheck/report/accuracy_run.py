"""Answers to an accuracy: a folder of `femcheck run --accuracy`, read back and as on the page."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from beamopt.storage.input_file import read_text
from femcheck.report.content import ReportTable, read_table
from femcheck.report.embedding import Download, download
from femcheck.report.summaries import AccuracySummary, ProvenanceKeys, read_keys
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
    summary: AccuracySummary
    provenance: ProvenanceKeys
    tips: ReportTable
    tried: ReportTable
    timing: ReportTable
    design_text: str

    @property
    def name(self) -> str:
        """Of the design."""
        return self.summary.design

    @property
    def badge(self) -> Badge:
        """Whether the accuracy was reached."""
        reached = self.summary.reached
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
    summary = read_keys(AccuracySummary, folder / "summary.json")
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
        read_keys(ProvenanceKeys, folder / "provenance.json"),
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
    asked = f"{number(summary.accuracy_mm)} mm"
    return AccuracyView(
        anchor,
        f"Tips to {asked}",
        run.badge,
        summary.ending,
        _reason(summary),
        (
            ("law", summary.law),
            ("accuracy asked for", asked),
            ("largest estimate", _estimate(summary.worst_estimate_mm)),
            ("answered by", summary.chosen),
            ("processor time", duration(run.seconds)),
        ),
        tuple(_rows(run.tips)),
        tuple(_tried(run)),
        tuple(
            download(table, f"accuracy-{table.file.name}")
            for table in (run.tips, run.tried, run.timing)
        ),
    )


def _estimate(worst: float | None) -> str:
    return "none" if worst is None else f"{number(worst)} mm"


def _reason(summary: AccuracySummary) -> str:
    """Why this rung; what the error is estimated from, where the folder says it."""
    if summary.estimate_is is None:
        return summary.reason
    others = ", ".join(map(str, summary.compared_with))
    against = f" ({summary.chosen} against {others})" if others else ""
    return f"{summary.reason}. Error: {summary.estimate_is}{against}."


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
