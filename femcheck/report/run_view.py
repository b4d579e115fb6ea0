"""A check or prediction as the page shows it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from markupsafe import Markup

from femcheck.report.embedding import Download, Picture, download, drawn, json_block, picture
from femcheck.report.figures import (
    above_figure,
    diagonal_figure,
    difference_figure,
    ends_figure,
    parity_figure,
)
from femcheck.report.packing import pack
from femcheck.report.shapes import RunShapes, read_shapes
from femcheck.report.solid_run import Combinations, SolidRun
from femcheck.report.still import side_view, still_figure
from femcheck.report.wording import (
    Badge,
    badge_of,
    meaning,
    number,
    per_cent,
    pressures_text,
)

__all__ = ["CombinationRow", "RunView", "ViewerModel", "view_of"]

NO_SHAPES = (
    "No model: the deformed meshes are not in this folder; femcheck run writes them, but they are "
    "not always kept."
)
SAVED_CAPTIONS = {
    "paths": "Pressure against the growth of the loaded chambers: where each path ends.",
    "axis": "Curvature and extension along the actuator, solid and beam, at the last stable "
    "equilibrium of each supply alone and of all alike.",
}


@dataclass(frozen=True, slots=True)
class CombinationRow:
    """A combination in the table. ending : its status and where; meaning : of the status."""

    pressures: tuple[str, str, str]
    cells: tuple[str, ...]
    ending: str
    answered: bool


@dataclass(frozen=True, slots=True)
class ViewerModel:
    """What turns. data : for the viewer. still : in its place on paper and without WebGL."""

    data: Markup
    levels: tuple[float, ...]
    first: tuple[int, int, int]
    still: Picture
    note: str


@dataclass(frozen=True, slots=True)
class RunView:
    """One run on the page; texts are not escaped yet."""

    anchor: str
    heading: str
    badge: Badge
    text: str
    advice: str
    notes: tuple[str, ...]
    tiles: tuple[tuple[str, str], ...]
    model: ViewerModel | None
    no_model: str
    figures: tuple[Picture, ...]
    columns: tuple[str, ...]
    rows: tuple[CombinationRow, ...]
    meanings: tuple[tuple[str, str], ...]
    downloads: tuple[Download, ...]


def view_of(run: SolidRun, anchor: str) -> RunView:
    """Read the shapes, draw the figures, word the numbers.

    Raises
    ------
    InputError : a deformed mesh that is damaged.
    """
    found, summary = run.combinations, run.summary
    shapes = read_shapes(run)
    law = summary.law
    question = "What the material does" if run.is_prediction else "Is the beam implemented right?"
    return RunView(
        anchor=anchor,
        heading=f"{question} Law: {law}" if question.endswith("?") else f"{question}: {law}",
        badge=badge_of(run),
        text=summary.text,
        advice=summary.advice or "",
        notes=tuple(_notes(run)),
        tiles=tuple(_tiles(run)),
        model=None if shapes is None or found is None else _model(run, found, shapes),
        no_model=NO_SHAPES,
        figures=tuple(_figures(run)),
        columns=_columns(run),
        rows=() if found is None else tuple(_rows(found, run.is_prediction)),
        meanings=() if found is None else _meanings(found),
        downloads=tuple(
            download(table, f"{run.subject.name}-{law}-{table.file.name}") for table in run.tables
        ),
    )


def _notes(run: SolidRun) -> Iterator[str]:
    """What a person should know about the section and its mesh."""
    summary = run.summary
    yield from map(str, summary.faults)
    yield from map(str, summary.mesh_notes)
    if summary.islands > 0:
        yield "with an island the beam is not what the solid converges to"
    median, worst = summary.sealing_median, summary.sealing_worst
    if median is not None and worst is not None:
        yield f"sealing moved the beam's tips by {median:.2f} (median) … {worst:.2f} mm"


def _tiles(run: SolidRun) -> Iterator[tuple[str, str]]:
    found, summary = run.combinations, run.summary
    if found is None:
        return
    answered = int((found.answered & found.loaded).sum())
    yield "combinations answered", f"{answered} of {int(found.loaded.sum())}"
    yield "worst difference", per_cent(summary.worst)
    yield "median difference", per_cent(summary.median)
    yield "tolerance asked", per_cent(summary.agree)
    if summary.stable_box is not None:
        yield "stable box", f"{number(summary.stable_box)} kPa"
    if summary.safe_box is not None:
        yield "advised at most", f"{number(summary.safe_box)} kPa"
    if summary.meshes is not None:
        yield "ratio of two meshes' limits", number(summary.largest_ratio)
    if summary.left is not None:
        yield "mesh and penalty leave", per_cent(summary.left)
    if np.isfinite(found.stretch).any():
        yield "largest stretch", number(float(np.nanmax(found.stretch)))


def _model(run: SolidRun, found: Combinations, shapes: RunShapes) -> ViewerModel:
    first = _first(found, shapes)
    levels = run.subject.design.pressures
    shape = shapes.shapes[shapes.of[first]]
    said = [_said(found, shapes, row) for row in range(len(shapes.of))]
    data = pack(shapes) | {
        "said": said,
        "answered": found.answered.tolist(),
        "azimuth": round(side_view(shape.line), 4),
        "centroid": [0.0, 0.0, run.subject.design.actuator.length / 2],
        "radius": run.subject.design.grid.outer_radius,
    }
    still = drawn("model", still_figure(shapes, shapes.of[first]), said[first])
    note = (
        "Of the standard mesh at the largest penalty c; the table extrapolates in 1/c."
        if not run.is_prediction
        else "Where a combination has no stable answer, the last stable shape on the way is shown."
    )
    place = (first // 9, first // 3 % 3, first % 3)
    return ViewerModel(json_block(data), tuple(levels), place, still, note)


def _first(found: Combinations, shapes: RunShapes) -> int:
    """The combination to begin with: its tip moves most, or without answers it stretches most."""
    own = found.answered & found.loaded & (np.array(shapes.of) >= 0)
    if own.any():
        return int(np.argmax(np.where(own, found.displacement, -1.0)))
    stretches = [shapes.shapes[place].stretch.max() if place >= 0 else 0.0 for place in shapes.of]
    return int(np.argmax(stretches))


def _said(found: Combinations, shapes: RunShapes, row: int) -> str:
    """A combination in a sentence."""
    asked = pressures_text(found.pressures[row])
    if found.answered[row]:
        moved = f"{asked}: the solid's tip moves {number(float(found.solid_displacement[row]))} mm"
        if not found.loaded[row]:
            return f"{asked}: at rest"
        off, share = float(found.difference[row]), float(found.share[row])
        return f"{moved}; it is {number(off)} mm from the beam's ({per_cent(share)})"
    none = f"{asked}: no answer, {found.ending(row)}."
    if shapes.of[row] < 0:
        return f"{none} There is no shape to show."
    last = pressures_text(shapes.shapes[shapes.of[row]].pressures)
    return f"{none} Shown: the last stable shape on the way, at {last}."


def _figures(run: SolidRun) -> Iterator[Picture]:
    found = run.combinations
    if found is None:
        return
    low, middle, high = run.subject.design.pressures
    caption = "Workspaces of beam and solid from above: where the tips go."
    yield drawn("above", above_figure(found, (low, middle, high)), caption)
    caption = "The same seen diagonally."
    yield drawn("diagonal", diagonal_figure(found, (low, middle, high)), caption)
    if (found.answered & found.loaded).any():
        agree = run.summary.agree
        caption = "Displacement of the tip: solid against beam."
        yield drawn("parity", parity_figure(found), caption)
        caption = "Distance between both tips as a share of the displacement."
        yield drawn("difference", difference_figure(found, agree), caption)
    if (found.loaded & ~found.answered).any():
        caption = "How far each combination's path is stable, beside the pressure asked for."
        yield drawn("ends", ends_figure(found), caption)
    for figure in run.figures:
        yield picture(figure, figure.name, SAVED_CAPTIONS.get(figure.name, figure.name))


def _columns(run: SolidRun) -> tuple[str, ...]:
    names = (
        "moves [mm]",
        "beam x [mm]",
        "y",
        "z",
        "solid x [mm]",
        "y",
        "z",
        "differs [mm]",
        "share",
    )
    return (*names, "stretch") if run.is_prediction else names


def _rows(found: Combinations, predicted: bool) -> Iterator[CombinationRow]:
    for row, pressures in enumerate(found.pressures):
        a, b, c = (number(float(value), 4) for value in pressures)
        cells = [
            _fixed(found.displacement[row], 2),
            *(_fixed(value, 2) for value in (*found.beam[row], *found.solid[row])),
            _fixed(found.difference[row], 4),
            per_cent(float(found.share[row])),
        ]
        if predicted:
            cells.append(number(float(found.stretch[row])))
        yield CombinationRow((a, b, c), tuple(cells), found.ending(row), bool(found.answered[row]))


def _fixed(value: Any, digits: int) -> str:
    return "–" if np.isnan(value) else f"{value:.{digits}f}".replace("-", "−")


def _meanings(found: Combinations) -> tuple[tuple[str, str], ...]:
    """Every status that occurs, how often, and what it means."""
    counts = Counter(zip(found.texts, found.endings, strict=True))
    return tuple((f"{text} ({count})", meaning(ended)) for (text, ended), count in counts.items())
