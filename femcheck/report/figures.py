"""Figures of one run: section, workspaces, parity, difference by combination, ends of the paths."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from beamopt.base.arrays import IndexArray
from beamopt.plot.section import draw_section
from beamopt.plot.style import (
    ASIDE_COLOUR,
    BELOW,
    DESIGN_COLOUR,
    SERIES_COLOURS,
    SUPPLY_COLOURS,
    new_figure,
    styled,
)
from beamopt.target.workspace import Workspace
from femcheck.report.solid_run import Combinations
from femcheck.solved.subject import Subject

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = [
    "above_figure",
    "diagonal_figure",
    "difference_figure",
    "ends_figure",
    "parity_figure",
    "section_figure",
]

BEAM_COLOUR, SOLID_COLOUR = DESIGN_COLOUR, SERIES_COLOURS[1]


@styled
def section_figure(subject: Subject) -> Figure:
    """The section as it was meshed, chambers numbered by their supply."""
    figure = new_figure(4.8, 5.2)
    sealed = subject.design.seal.rules.sealed
    outline = subject.outline if sealed else None
    draw_section(figure.add_subplot(), subject.design.section, "", outline)
    return figure


@styled
def above_figure(found: Combinations, levels: tuple[float, float, float]) -> Figure:
    """The workspaces of beam and solid from above."""
    figure = new_figure(4.8, 4.4)
    axes = figure.add_subplot()
    _draw_both(axes, (0, 1), found, levels)
    axes.set(aspect="equal", xlabel="x [mm]", ylabel="y [mm]")
    axes.grid(True)
    axes.margins(0.08)
    figure.legend(*axes.get_legend_handles_labels(), loc="outside upper center", ncols=2)
    return figure


@styled
def diagonal_figure(found: Combinations, levels: tuple[float, float, float]) -> Figure:
    """The workspaces of beam and solid, seen diagonally."""
    figure = new_figure(4.8, 4.4)
    axes: Any = figure.add_subplot(projection="3d")
    _draw_both(axes, (0, 1, 2), found, levels)
    tips = np.vstack([found.beam, found.solid])
    size = np.nanmax(tips, axis=0) - np.nanmin(tips, axis=0)
    axes.set_box_aspect(np.maximum(size, 20.0), zoom=0.92)
    axes.view_init(elev=24, azim=-60)
    axes.locator_params(nbins=4)
    axes.set(xlabel="x [mm]", ylabel="y [mm]", title="z [mm] upwards")
    figure.legend(*axes.get_legend_handles_labels(), loc="outside upper center", ncols=2)
    return figure


def _draw_both(
    axes: Any, dims: tuple[int, ...], found: Combinations, levels: tuple[float, float, float]
) -> None:
    """Edges of both hexahedra and their nodes: circles the beam's, crosses the solid's."""
    for name, tips, colour, dash, marker in (
        ("beam", found.beam, BEAM_COLOUR, "-", "o"),
        ("solid", found.solid, SOLID_COLOUR, (0, (4, 2)), "x"),
    ):
        for curve in Workspace(levels, tips).edge_curves():
            axes.plot(*curve[:, dims].T, color=colour, ls=dash, lw=1.0)
        look = {"ms": 4.0, "mew": 1.3 if marker == "x" else 0.8, "mfc": "none"}
        axes.plot(*tips[:, dims].T, marker, color=colour, label=name, **look)


@styled
def parity_figure(found: Combinations) -> Figure:
    """How far the solid's tip moves against how far the beam's does; they agree on the line."""
    figure = new_figure(4.8, 4.8)
    axes = figure.add_subplot()
    both = found.answered & found.loaded
    beam, solid = found.displacement[both], found.solid_displacement[both]
    most = 1.06 * float(np.max(np.concatenate([beam, solid, [1e-9]])))
    axes.plot([0, most], [0, most], color=ASIDE_COLOUR, lw=0.9, label="equal")
    supplies = (found.pressures[both] > 0).sum(axis=1)
    for count, marker in ((1, "o"), (2, "s"), (3, "^")):
        kept = supplies == count
        colour = SERIES_COLOURS[count - 1]
        text = ("one supply", "two supplies", "three supplies")[count - 1]
        axes.plot(beam[kept], solid[kept], marker, color=colour, ms=5, mfc="none", label=text)
    axes.set(aspect="equal", xlim=(0, most), ylim=(0, most))
    axes.set(xlabel="the beam's tip moves [mm]", ylabel="the solid's tip moves [mm]")
    axes.grid(True)
    axes.legend(loc="upper left")
    return figure


@styled
def difference_figure(found: Combinations, agree: float) -> Figure:
    """Distance between both tips as a share of the displacement, a bar a combination.

    agree : the share that was asked for.
    """
    figure = new_figure(9.6, 3.4)
    axes, rows = _bars(figure, found)
    share = 100 * found.share[rows]
    axes.bar(np.arange(len(rows)), np.nan_to_num(share), color=SERIES_COLOURS[0], width=0.7)
    _mark_missing(axes, ~found.answered[rows])
    known = share[np.isfinite(share)]
    most = float(known.max()) if known.size else 1.0
    if 100 * agree <= 3 * most:
        axes.axhline(100 * agree, color=SERIES_COLOURS[1], lw=1.2, ls="--")
        axes.set_title(f"dashed: {100 * agree:g} %, as asked", loc="right", fontsize=8.5)
    else:
        said = f"asked {100 * agree:g} %, {100 * agree / most:,.0f} times the highest bar"
        axes.set_title(said, loc="right", fontsize=8.5)
    axes.set_ylabel("difference / displacement [%]")
    return figure


@styled
def ends_figure(found: Combinations) -> Figure:
    """What share of the pressures asked for has a stable answer, a bar a combination."""
    figure = new_figure(9.6, 3.4)
    axes, rows = _bars(figure, found)
    asked = found.pressures[rows].max(axis=1)
    reached = np.where(found.answered[rows], asked, np.nan_to_num(found.ends_at[rows]))
    place = np.arange(len(rows))
    axes.bar(place, asked, color="#e3e3e3", width=0.7, label="asked")
    axes.bar(place, reached, color=SERIES_COLOURS[0], width=0.7, label="stable up to")
    for at, value in zip(place, reached, strict=True):
        axes.text(at, value, f"{value:.3g}", ha="center", va="bottom", size=7)
    axes.set_ylabel("largest of the pressures [kPa]")
    handles, labels = axes.get_legend_handles_labels()
    axes.legend(handles, labels, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2)
    return figure


def _bars(figure: Figure, found: Combinations) -> tuple[Any, IndexArray]:
    """Axes with a place a loaded combination, and below it which supplies are at which level."""
    axes = figure.add_subplot()
    rows = np.flatnonzero(found.loaded)
    rows = rows[np.argsort((found.pressures[rows] > 0).sum(axis=1), kind="stable")]
    axes.set_xticks(np.arange(len(rows)), [""] * len(rows))
    axes.tick_params(axis="x", length=0, pad=30)
    axes.set_xlim(-0.6, len(rows) - 0.4)
    axes.grid(True, axis="y")
    axes.set_axisbelow(True)
    most = float(found.pressures.max())
    below = axes.get_xaxis_transform()
    for supply, colour in enumerate(SUPPLY_COLOURS):
        height = -0.07 - 0.085 * supply
        for place, row in enumerate(rows):
            value = found.pressures[row, supply]
            look: Any = {"color": colour if value > 0 else "none", "mec": "#9a9a9a", "mew": 0.5}
            size = 4.0 + 5.0 * float(value) / most if value > 0 and most > 0 else 3.0
            axes.plot(place, height, "o", ms=size, transform=below, clip_on=False, **look)
        named: Any = {"ha": "right", "va": "center", "size": 7.5, "transform": below}
        axes.text(-0.9, height, f"supply {supply + 1}", **named)
    axes.set_title("below: pressure of each supply, larger dots higher", loc="left", fontsize=8.5)
    return axes, rows


def _mark_missing(axes: Any, missing: Any) -> None:
    places = np.flatnonzero(missing)
    if places.size:
        look = {"color": SERIES_COLOURS[1], "ls": "none", "clip_on": False}
        axes.plot(places, np.zeros(places.size), marker="x", **look, label="no answer")
        axes.legend(**BELOW)
