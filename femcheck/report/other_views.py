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
        f"ended: {run.summary.text('status')}",
        tuple(_tiles(run)),
        tuple(map(str, run.summary.list("warnings"))) if run.summary.has("warnings") else (),
        tuple(
            picture(figure, figure.name, SEARCH_CAPTIONS.get(figure.name, figure.name))
            for figure in run.figures
        ),
        tuple(download(table, f"search-{table.file.name}") for table in run.tables),
    )


def _tiles(run: SearchRun) -> Iterator[tuple[str, str]]:
    summary = run.summary
    if summary.has("best.L"):
        sealed = summary.has("outline.rms_distance")
        rms = summary.number("outline.rms_distance" if sealed else "best.rms_distance")
        loss = summary.number("outline.L" if sealed else "best.L")
        yield "distance from the target, RMS", f"{number(rms)} mm"
        yield "L", f"{number(loss, 4)} mm²"
        yield "K", f"{number(summary.number('best.K'), 4)} mm²"
    else:
        yield "best", summary.text("best.status")
    if summary.has("evaluations"):
        yield "sections judged", f"{summary.number('evaluations'):,.0f}"
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
