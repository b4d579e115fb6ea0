"""The page: everything that was read, put into one file that needs nothing else."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Callable, Sequence
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
from markupsafe import Markup

from beamopt.plot.style import SUPPLY_COLOURS
from femcheck.report.accuracy_run import AccuracyRun, read_accuracy_run
from femcheck.report.design_view import design_views
from femcheck.report.embedding import json_block
from femcheck.report.folders import ContentKind, find_folders
from femcheck.report.origins import origin_of
from femcheck.report.other_runs import FigureRun, SearchRun, read_figure_run, read_search_run
from femcheck.report.other_views import figures_view
from femcheck.report.solid_run import SolidRun, read_solid_run
from femcheck.report.still import colour_table

__all__ = ["MARK", "report_page"]

MARK = '<meta name="generator" content="femcheck report">'
"""Stands in the head of every report, and of no other file."""

Run = SolidRun | AccuracyRun | SearchRun | FigureRun
READERS: dict[ContentKind, Callable[[Path], Run]] = {
    ContentKind.SOLID: read_solid_run,
    ContentKind.ACCURACY: read_accuracy_run,
    ContentKind.SEARCH: read_search_run,
    ContentKind.FIGURES: read_figure_run,
}
SCRIPTS = ("viewer.js", "page.js")


def report_page(paths: Sequence[Path], title: str = "") -> str:
    """The report of folders, as one HTML file; the same folders, the same text.

    paths : folders of `femcheck run`, `beamopt optimize`, charts and maps, or that hold such.
    title : made of the designs' names if left out.

    Raises
    ------
    InputError : a folder that is none of these, or a damaged file in one.
    """
    runs = [READERS[folder.kind](folder.path) for folder in find_folders(paths)]
    solids = [run for run in runs if isinstance(run, SolidRun)]
    answers = [run for run in runs if isinstance(run, AccuracyRun)]
    searches = [run for run in runs if isinstance(run, SearchRun)]
    charts = [run for run in runs if isinstance(run, FigureRun)]
    designs = design_views(solids, answers, searches)
    figures = [figures_view(run, f"chart-{place}") for place, run in enumerate(charts, 1)]
    names = dict.fromkeys([*(one.name for one in designs), *(one.name for one in figures)])
    return _render(
        {
            "title": title or ", ".join(names),
            "lines": [line for design in designs for line in design.lines],
            "designs": designs,
            "charts": figures,
            "origins": [origin_of(run) for run in runs],
            "version": version("beamopt"),
        }
    )


def _render(content: dict[str, Any]) -> str:
    """Fill the template; every text that is not marked as HTML is escaped."""
    from jinja2 import Environment, FunctionLoader, StrictUndefined

    environment = Environment(
        loader=FunctionLoader(_asset),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    style, script = _asset("style.css"), "\n".join(_asset(name) for name in SCRIPTS)
    colours = np.rint(255 * colour_table()).astype(np.uint8).tobytes()
    shared = {
        "map": base64.b64encode(colours).decode("ascii"),
        "supplies": list(SUPPLY_COLOURS),
    }
    return environment.get_template("page.html").render(
        **content,
        mark=Markup(MARK),
        style=Markup(style),
        script=Markup(script),
        style_hash=Markup(_hash(style)),
        script_hash=Markup(_hash(script)),
        shared=json_block(shared),
    )


def _asset(name: str) -> str:
    return files("femcheck.report").joinpath("assets", name).read_text(encoding="utf-8")


def _hash(text: str) -> str:
    """What the page's own policy knows its style and script by; it lets nothing else run."""
    digest = hashlib.sha256(text.encode("utf-8")).digest()
    return f"sha256-{base64.b64encode(digest).decode('ascii')}"
