"""A front of two objectives, with a few of its sections beside it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.plot.section import draw_section
from beamopt.plot.style import ASIDE_COLOUR, SERIES_COLOURS, new_figure, styled
from beamopt.scene.design import Design

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["pareto_figure", "spans_decades"]

MOST_BEATEN = 2000  # points; more would only make the file large

BLUE, RED = SERIES_COLOURS[:2]


@styled
def pareto_figure(
    front: FloatArray,
    seen: FloatArray,
    labels: Sequence[str],
    shown: Sequence[tuple[int, str, Design]],
    title: str = "",
) -> Figure:
    """The first objective upwards, the second to the right; better is down and to the left.

    front : (n, 2) values of the designs that none beats. seen : (m, 2) of all that were judged.
    labels : of the objectives. shown : place on the front, title and design of sections to draw.
    """
    figure = new_figure(11.0, 5.6)
    rows = max(len(shown), 1)
    grid = figure.add_gridspec(rows, 2, width_ratios=(3.4, 1))
    axes = figure.add_subplot(grid[:, 0])
    _draw(axes, front, seen, labels)
    for place, (k, said, design) in enumerate(shown):
        letter = chr(ord("A") + place)
        x, y = front[k, 1], front[k, 0]
        axes.plot([x], [y], "o", ms=9, mfc="none", mec=RED, mew=1.4, zorder=4)
        axes.annotate(
            letter, (x, y), xytext=(7, 6), textcoords="offset points", color=RED, weight="bold"
        )
        _thumbnail(figure.add_subplot(grid[place, 1]), design, f"{letter}: {said}")
    axes.set_title(title)
    return figure


def _draw(axes: Axes, front: FloatArray, seen: FloatArray, labels: Sequence[str]) -> None:
    from matplotlib.ticker import MaxNLocator

    order = np.argsort(front[:, 1], kind="stable")
    every = max(-(-len(seen) // MOST_BEATEN), 1)
    few = seen[::every]
    axes.plot(few[:, 1], few[:, 0], ".", ms=3, color=ASIDE_COLOUR, alpha=0.35, mew=0,
              label="judged, beaten by another", zorder=1)  # fmt: skip
    axes.plot(front[order, 1], front[order, 0], "-", lw=1.0, color=BLUE, zorder=2)
    axes.plot(front[:, 1], front[:, 0], "o", ms=4, color=BLUE, label="front", zorder=3)
    for k, scale, name in ((0, axes.set_yscale, "y"), (1, axes.set_xscale, "x")):
        if spans_decades(front[:, k]):
            scale("log")
        _leave_room(axes, name, front[:, k])
        if (front[:, k] == np.round(front[:, k])).all():
            (axes.xaxis if name == "x" else axes.yaxis).set_major_locator(MaxNLocator(integer=True))
    axes.set(xlabel=labels[1], ylabel=labels[0])
    axes.grid(True)
    axes.legend(loc="upper right", frameon=True, markerscale=2.0)


def spans_decades(values: FloatArray) -> bool:
    """Whether values are to be seen by their logarithm: above 0, and a hundredfold apart."""
    return bool(values.size and values.min() > 0 and values.max() > 100 * values.min())


def _leave_room(axes: Axes, name: str, values: FloatArray) -> None:
    """Limits around the front, so that what is far worse does not squeeze it."""
    low, high = float(values.min()), float(values.max())
    if spans_decades(values):
        room = (high / low) ** 0.08
        limits = low / room, high * room
    else:
        room = 0.08 * (high - low) or 0.05 * max(abs(high), 1.0)
        limits = low - room, high + room
    (axes.set_xlim if name == "x" else axes.set_ylim)(*limits)


def _thumbnail(axes: Axes, design: Design, title: str) -> None:
    sealed = design.seal.rules.sealed
    draw_section(axes, design.section, title, design.outline if sealed else None)
    legend = axes.get_legend()
    if legend is not None:
        legend.remove()
    axes.set_axis_off()
