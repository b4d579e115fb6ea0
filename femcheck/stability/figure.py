"""The map drawn: statuses coloured and lettered, limits and the beam's validity as lines."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from typing import TYPE_CHECKING, Any

import numpy as np

from beamopt.plot.style import new_figure, styled
from femcheck.stability.axis import Axis
from femcheck.stability.ending import MapEnding
from femcheck.stability.found import AxisFound, MapRow, share_of_cell
from femcheck.stability.validity import AGREE, Interval, intervals_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["LOOKS", "height_of", "map_figure", "validity_lines"]

LOOKS: dict[MapEnding, tuple[str, str, str]] = {
    MapEnding.STABLE: ("s", "#d6e8f5", "#202020"),
    MapEnding.UNCHECKED: ("?", "#a8c4d8", "#202020"),
    MapEnding.UNSTABLE: ("u", "#f0e442", "#202020"),
    MapEnding.LIMIT_POINT: ("L", "#d55e00", "#ffffff"),
    MapEnding.BUCKLED: ("B", "#7a1f5c", "#ffffff"),
    MapEnding.BEYOND_LAW: ("l", "#c8a2c8", "#202020"),
    MapEnding.INVERTED: ("I", "#101010", "#ffffff"),
    MapEnding.STEP_TOO_SMALL: ("t", "#e69f00", "#202020"),
    MapEnding.LINEAR_SOLVER: ("n", "#505050", "#ffffff"),
    MapEnding.WORK_LIMIT: ("W", "#808080", "#ffffff"),
    MapEnding.TIME_OUT: ("T", "#808080", "#ffffff"),
    MapEnding.STOPPED: ("X", "#808080", "#ffffff"),
    MapEnding.NO_MESH: ("m", "#ffffff", "#606060"),
    MapEnding.NO_PAIR: ("e", "#ffffff", "#606060"),
}
"""Letter, colour, colour of the letter (after Okabe and Ito): what has an equilibrium is pale."""

LIMIT_COLOUR, VALID_COLOUR, EXACT_COLOUR = "#000000", "#006d4e", "#ffffff"
WIDTH, HEIGHT = 0.62, 0.27  # inches of a cell
ACROSS = 2
CASING = 1.6  # points of white round lines: they are seen on every colour


@styled
def map_figure(found: Sequence[AxisFound], title: str, caption: str) -> Figure:
    """All panels, two in a row, with a legend and a line that says what they were made with."""
    down = -(-len(found) // ACROSS)
    across = min(ACROSS, len(found))
    widest = max(len(one.axis.columns) for one in found)
    tallest = max(len(one.axis.pressures) for one in found)
    width = max(across * (0.9 + WIDTH * widest), 8.0)
    below = 1.35
    height = below + 0.45 + down * (1.15 + HEIGHT * tallest)
    figure = new_figure(width, height, below=below / height)
    grid = figure.subplots(down, across, squeeze=False).ravel()
    for axes, one in zip(grid, found, strict=False):
        _panel(axes, one)
    for axes in grid[len(found) :]:
        axes.set_axis_off()
    figure.suptitle(title)
    figure.legend(
        handles=_legend(found), loc="lower center", ncols=3, bbox_to_anchor=(0.5, 0.25 / height)
    )
    figure.text(0.5, 0.12 / height, caption, ha="center", va="center", fontsize=7, color="#606060")
    return figure


def _panel(axes: Axes, one: AxisFound) -> None:
    axis = one.axis
    for x, row in enumerate(one.rows):
        _cells(axes, x, row)
    _limit_line(axes, one)
    _validity(axes, one)
    across, down = len(axis.columns), len(axis.pressures)
    axes.set(xlim=(0, across), ylim=(0, down), xlabel=axis.label, ylabel="pressure [kPa]")
    axes.set_title(f"{axis.title}\n", fontsize=10, weight="bold", loc="left")
    axes.text(0, down + 0.18, _note(one), fontsize=7, color="#404040", va="bottom")
    small = 6.2 if any("\n" in column.label for column in axis.columns) else 8.0
    axes.set_xticks(np.arange(across) + 0.5, [c.label for c in axis.columns], fontsize=small)
    axes.set_yticks(np.arange(down) + 0.5, [f"{pressure:g}" for pressure in axis.pressures])
    axes.tick_params(length=0)
    for side in axes.spines.values():
        side.set_visible(False)


def _cells(axes: Axes, x: int, row: MapRow) -> None:
    """Letter of the status; beside it the difference to the beam, bold where the beam is valid."""
    from matplotlib.patches import Rectangle

    for y, cell in enumerate(row.cells):
        if cell is None:
            continue
        letter, colour, ink = LOOKS[cell.ending]
        axes.add_patch(Rectangle((x, y), 1, 1, facecolor=colour, edgecolor="white", lw=0.8))
        ground = {"facecolor": colour, "edgecolor": "none", "pad": 0.3}  # a halo weighs megabytes
        look: dict[str, Any] = {"va": "center", "color": ink, "zorder": 5, "bbox": ground}
        axes.text(x + 0.07, y + 0.5, letter, fontsize=7, weight="bold", ha="left", **look)
        share = share_of_cell(row, cell)
        if share is not None:
            weight = "bold" if share <= AGREE else "normal"
            text = _percent(share)
            axes.text(x + 0.94, y + 0.5, text, fontsize=6, weight=weight, ha="right", **look)


def _percent(share: float) -> str:
    percent = 100 * share
    return f"{percent:.1f} %" if percent < 9.95 else f"{percent:.0f} %"


def height_of(axis: Axis, pressure: float | None) -> float:
    """Height of a pressure [kPa] in a panel, linear between the rows; NaN where it has no room."""
    if pressure is None or not isfinite(pressure):
        return float("nan")
    levels = np.array(axis.pressures)
    count = len(levels)
    if pressure <= levels[-1]:
        places = np.concatenate([[0.0], np.arange(count) + 0.5])
        return float(np.interp(pressure, np.concatenate([[0.0], levels]), places))
    step = levels[-1] - (levels[-2] if count > 1 else 0.0)
    above = count - 0.5 + (pressure - float(levels[-1])) / float(step)
    return above if above <= count else float("nan")


def _limit_line(axes: Axes, one: AxisFound) -> None:
    """A bar at each column's limit, and a line from one to the next; circles of the closed form."""
    heights = [
        # a path that the computation lost has an end, but no limit
        height_of(
            one.axis, row.trace.critical if row.trace and row.trace.ending.says_none else None
        )
        for row in one.rows
    ]
    for x, height in enumerate(heights):
        _line(axes, [x + 0.04, x + 0.96], [height, height], color=LIMIT_COLOUR, lw=2.0)
    if one.axis.ordered:
        _line(axes, [x + 0.5 for x in range(len(heights))], heights, color=LIMIT_COLOUR, lw=1.0)
    exact = [height_of(one.axis, row.column.exact) for row in one.rows]
    if any(isfinite(height) for height in exact):
        middles = np.arange(len(exact)) + 0.5
        look: dict[str, Any] = {"color": EXACT_COLOUR, "ls": "", "marker": "o", "ms": 5}
        axes.plot(middles, exact, mec=LIMIT_COLOUR, zorder=6, **look)


def _line(axes: Axes, x: Sequence[float], y: Sequence[float], **look: Any) -> None:
    from matplotlib import patheffects

    casing = patheffects.withStroke(linewidth=look["lw"] + CASING, foreground="white")
    axes.plot(x, y, path_effects=[casing], zorder=4, solid_capstyle="butt", **look)


def validity_lines(
    intervals: Sequence[Sequence[Interval]],
) -> list[list[tuple[int, float]]]:
    """Lines (column, pressure [kPa]) along which the beam starts or stops being valid.

    A line goes on from one column to the next where both have as many intervals.
    """
    lines: list[list[tuple[int, float]]] = []
    running: dict[tuple[int, str], list[tuple[int, float]]] = {}
    before = -1
    for x, here in enumerate(intervals):
        if len(here) != before:
            running = {}
        before = len(here)
        for number, one in enumerate(here):
            for side, value, is_there in (
                ("low", one.low, one.begins),
                ("high", one.high, one.ends),
            ):
                if not is_there:
                    running.pop((number, side), None)
                    continue
                if (number, side) not in running:
                    running[number, side] = []
                    lines.append(running[number, side])
                running[number, side].append((x, value))
    return lines


def _validity(axes: Axes, one: AxisFound) -> None:
    """Hatched where the beam is valid; a line where it starts or stops being so."""
    found = [() if row.trace is None else intervals_of(row.trace.track) for row in one.rows]
    for x, intervals in enumerate(found):
        for part in intervals:
            low, high = (height_of(one.axis, value) for value in (part.low, part.high))
            bar: dict[str, Any] = {"facecolor": "none", "edgecolor": VALID_COLOUR, "lw": 0.0}
            axes.bar(x + 0.5, high - low, 0.98, low, hatch="////", zorder=3, alpha=0.45, **bar)
    look: dict[str, Any] = {"color": VALID_COLOUR, "lw": 1.6, "ls": (0, (3, 1.2))}
    for line in validity_lines(found):
        middles = [at + 0.5 for at, _ in line]
        heights = [height_of(one.axis, pressure) for _, pressure in line]
        if one.axis.ordered and len(line) > 1:
            _line(axes, middles, heights, **look)
            continue
        for middle, height in zip(middles, heights, strict=True):
            _line(axes, [middle - 0.46, middle + 0.46], [height, height], **look)


def _note(one: AxisFound) -> str:
    """Where the beam is valid, in a few words."""
    found = [
        intervals_of(row.trace.track)
        for row in one.rows
        if row.trace is not None and row.trace.track
    ]
    if not found:
        return "no path was followed"
    passed = sum(all(i.begins and i.ends for i in each) for each in found if each)
    stays = sum(not each[-1].ends for each in found if each)
    from_rest = sum(not each[0].begins for each in found if each)
    said = [
        f"{text} in {count} of {len(found)}"
        for text, count in (
            ("from rest on", from_rest),
            ("to the end of the path", stays),
            ("in a band, passing by,", passed),
        )
        if count
    ]
    return f"beam within {AGREE:.0%}: {', '.join(said) or 'nowhere'}"


def _legend(found: Sequence[AxisFound]) -> list[Any]:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    used = {cell.ending for one in found for row in one.rows for _, cell in row.solved}
    handles: list[Any] = [
        Patch(facecolor=colour, edgecolor="#808080", label=f"{letter}  {ending.value}")
        for ending, (letter, colour, _) in LOOKS.items()
        if ending in used
    ]
    point: dict[str, Any] = {"ls": "", "mfc": "#ffffff", "mec": "#000000"}
    handles += [
        Line2D([], [], color=LIMIT_COLOUR, lw=2.0, label="where the stable path from rest ends"),
        Line2D([], [], marker="o", ms=5, label="limit in closed form", **point),
        Line2D(
            [], [], color=VALID_COLOUR, lw=1.4, ls=(0, (4, 2)), label=f"beam off by {AGREE:.0%}"
        ),
        Patch(fc="none", ec=VALID_COLOUR, hatch="////", lw=0, label=f"beam within {AGREE:.0%}"),
        Line2D([], [], ls="", label="per cent: difference to the beam's tip"),
    ]
    return handles
