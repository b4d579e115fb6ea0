"""Searches, and folders of figures such as charts and maps, read back from disk."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

from beamopt.storage.input_file import read_text
from beamopt.storage.result_folder import design_file
from femcheck.report.content import ReportTable, read_table
from femcheck.report.saved_figure import SavedFigure, read_figures
from femcheck.report.summaries import ProvenanceKeys, SearchSummary, read_keys

__all__ = ["FigureRun", "SearchRun", "read_figure_run", "read_search_run"]

OF_PEOPLE = ("target-source", "target-path")


@dataclass(frozen=True, eq=False)
class SearchRun:
    """A folder of `beamopt optimize`.

    design_text : the best design's file, "" where nothing could be judged.
    """

    folder: Path
    summary: SearchSummary
    provenance: ProvenanceKeys
    tables: tuple[ReportTable, ...]
    figures: tuple[SavedFigure, ...]
    design_text: str

    @property
    def name(self) -> str:
        """Scene and seed."""
        return f"{self.summary.scene}, seed {self.summary.seed:.0f}"

    @property
    def seconds(self) -> float:
        """Time of the search [s]."""
        timing = next((one for one in self.tables if one.file.name == "timing.csv"), None)
        if timing is None:
            return math.nan
        whole = [what == "search" for what in timing.column("what")]
        return float(timing.numbers("value")[whole].sum())


@dataclass(frozen=True, eq=False)
class FigureRun:
    """A folder of figures with their tables.

    reading : its `reading.md`, "" where there is none.
    """

    folder: Path
    provenance: ProvenanceKeys
    tables: tuple[ReportTable, ...]
    figures: tuple[SavedFigure, ...]
    reading: str

    @property
    def verdict(self) -> str:
        """What it says in one sentence, if it says so."""
        return self.provenance.verdict


def read_search_run(folder: Path) -> SearchRun:
    """Read a search.

    Raises
    ------
    InputError : the first file that is missing or damaged.
    """
    summary = read_keys(SearchSummary, folder / "summary.json")
    best = design_file(folder)
    return SearchRun(
        folder,
        summary,
        read_keys(ProvenanceKeys, folder / "provenance.json"),
        _tables(folder),
        read_figures(folder),
        read_text(best) if best.exists() else "",
    )


def read_figure_run(folder: Path) -> FigureRun:
    """Read a folder of figures.

    Raises
    ------
    InputError : the first file that is damaged.
    """
    reading = folder / "reading.md"
    return FigureRun(
        folder,
        read_keys(ProvenanceKeys, folder / "provenance.json"),
        _tables(folder),
        read_figures(folder),
        read_text(reading) if reading.exists() else "",
    )


def _tables(folder: Path) -> tuple[ReportTable, ...]:
    """Its tables but for those that a person wrote, which may hold comments and gaps."""
    files = sorted(folder.glob("*.csv"))
    return tuple(read_table(file) for file in files if not file.name.startswith(OF_PEOPLE))
