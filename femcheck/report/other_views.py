"""Searches, charts and maps as the page shows them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from markupsafe import Markup

from femcheck.report.embedding import Download, Picture, download, picture
from femcheck.report.markdown import to_html
from femcheck.report.other_runs import FigureRun, SearchRun
from femcheck.report.wording import duration, number

__all__ = ["FiguresView", "SearchView", "figures_view", "search_view"]

SEARCH_CAPTIONS = {
    "best": "The section found beside its workspace; crosses and dashes are the target.",
    "convergence": "The loss over the generations.",
}


@dataclass(frozen=True, slots=True)
class SearchView:
    """A search on the page."""

    name: str
    text: str
    tiles: tuple[tuple[str, str], ...]
    notes: tuple[str, ...]
    figures: tuple[Picture, ...]
    downloads: tuple[Download, ...]


@dataclass(frozen=True, slots=True)
class FiguresView:
    """A chart or a map. reading : as HTML, escaped."""

    name: str
    anchor: str
    verdict: str
    figures: tuple[Picture, ...]
    reading: Markup
    downloads: tuple[Download, ...]


def search_view(run: SearchRun) -> SearchView:
    """A search."""
    return SearchView(
        run.name,
        f"ended: {run.summary.status}",
        tuple(_tiles(run)),
        tuple(map(str, run.summary.warnings)),
        tuple(
            picture(figure, figure.name, SEARCH_CAPTIONS.get(figure.name, figure.name))
            for figure in run.figures
        ),
        tuple(download(table, f"search-{table.file.name}") for table in run.tables),
    )


def _tiles(run: SearchRun) -> Iterator[tuple[str, str]]:
    found = run.summary
    if found.L is not None:
        sealed = found.outline_rms_distance is not None
        rms = found.outline_rms_distance if sealed else found.rms_distance
        yield "distance from the target, RMS", f"{number(rms)} mm"
        yield "L", f"{number(found.outline_loss if sealed else found.L, 4)} mm²"
        yield "K", f"{number(found.K, 4)} mm²"
    else:
        yield "best", found.best_status
    if found.evaluations is not None:
        yield "sections judged", f"{found.evaluations:,.0f}"
    yield "time", duration(run.seconds)


def figures_view(run: FigureRun, anchor: str) -> FiguresView:
    """A chart or a map."""
    name = run.folder.resolve().name
    return FiguresView(
        name,
        anchor,
        run.verdict,
        tuple(picture(figure, figure.name, figure.name) for figure in run.figures),
        to_html(run.reading),
        tuple(download(table, f"{name}-{table.file.name}") for table in run.tables),
    )
