"""Loss against sections judged and against processor time, a row a scene."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.plot.style import (
    ASIDE_COLOUR,
    DESIGN_COLOUR,
    SERIES_COLOURS,
    TARGET_COLOUR,
    new_figure,
    styled,
)
from tests.bench.search_tape import Mark

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["search_figure"]

BLUE, RED, GREEN, VIOLET = SERIES_COLOURS
SOLID, DASHED, DOTTED, MIXED = "-", (0, (5, 1.5)), (0, (1, 1.2)), "-."
LOOKS: dict[str, dict[str, Any]] = {
    "random search": {"color": ASIDE_COLOUR, "ls": SOLID},
    "paper FD": {"color": BLUE, "ls": SOLID},
    "paper FW": {"color": BLUE, "ls": DASHED},
    "paper RD": {"color": BLUE, "ls": MIXED},
    "paper RW": {"color": BLUE, "ls": DOTTED},
    "pymoo GA": {"color": VIOLET, "ls": SOLID},
    "CMA-ES": {"color": GREEN, "ls": SOLID},
    "CMA-ES on L": {"color": GREEN, "ls": DASHED},
    "refine": {"color": RED, "ls": SOLID, "lw": 2.4},
    "GA, then refine": {"color": RED, "ls": DASHED, "lw": 1.8},
    "memetic GA": {"color": DESIGN_COLOUR, "ls": MIXED, "lw": 1.8},
}
"""Methods of a kind share a colour; dashes tell them apart, also in print."""

OURS = ("refine", "GA, then refine", "memetic GA")
NAMES = {"CMA-ES": "CMA-ES on L + K"} | {method: f"ours: {method}" for method in OURS}
POINTS = 200  # along a line

Panels = Sequence[tuple[str, float, Mapping[str, Sequence[Sequence[Mark]]]]]


@styled
def search_figure(panels: Panels, papers: int, second: float) -> Figure:
    """The median of the seeds and their band, from lowest to highest; a dot where all have ended.

    panels : scene, bound of L [mm²], curves of the methods. papers : sections that the paper's
    search judges. second : of processor time [s]; both are drawn.
    """
    figure = new_figure(11.5, 3.6 * len(panels) + 0.9)
    grid = figure.subplots(len(panels), 2, squeeze=False)
    for (left, right), (scene, bound, curves) in zip(grid, panels, strict=True):
        for axes, of, marked in (
            (left, lambda mark: float(mark.evaluations), papers),
            (right, lambda mark: mark.seconds, second),
        ):
            for method, runs in curves.items():
                _draw(axes, method, runs, of)
            axes.set(xscale="log", yscale="log")
            axes.set_title(scene, loc="left")
            axes.grid(True)
            _draw_bound(axes, bound)
            said = f"{papers:,} sections" if axes is left else f"{second:g} s"
            _draw_budget(axes, marked, said)
        left.set_ylabel("lowest L so far [mm²]")
        right.sharey(left)
    grid[-1, 0].set_xlabel("sections judged; flips proposed to a model are not among them")
    grid[-1, 1].set_xlabel("processor time of everything, flips as well [s]")
    handles, labels = grid[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3, handlelength=4.2)
    return figure


def _draw(
    axes: Axes, method: str, runs: Sequence[Sequence[Mark]], of: Callable[[Mark], float]
) -> None:
    look = {"lw": 1.4} | LOOKS[method]
    begins = max(of(marks[0]) for marks in runs)
    ends = max(of(marks[-1]) for marks in runs)
    along = np.geomspace(max(begins, 1e-3), max(ends, begins, 1e-3), POINTS)
    losses = np.array([_steps(marks, of, along) for marks in runs])
    changes = np.any(np.diff(losses, axis=1), axis=0)
    kept = np.concatenate([[True], changes[:-1], [True]])  # a small file: flat parts are one line
    along, losses = along[kept], losses[:, kept]
    low, middle, high = losses.min(axis=0), np.median(losses, axis=0), losses.max(axis=0)
    emphasis, colour = 4 if method in OURS else 2, look["color"]
    axes.fill_between(along, low, high, color=colour, alpha=0.1, lw=0, step="post")
    name = NAMES.get(method, method)
    axes.plot(along, middle, label=name, zorder=emphasis, drawstyle="steps-post", **look)
    axes.plot(along[-1], middle[-1], "o", ms=4, color=colour, zorder=emphasis + 1)


def _steps(marks: Sequence[Mark], of: Callable[[Mark], float], along: FloatArray) -> FloatArray:
    """The lowest L so far at places along an axis; the first one also before it was there."""
    places = np.array([of(mark) for mark in marks])
    losses = np.array([mark.L for mark in marks])
    return np.asarray(losses[np.maximum(np.searchsorted(places, along, side="right") - 1, 0)])


def _draw_budget(axes: Axes, at: float, said: str) -> None:
    """Where methods are compared."""
    axes.axvline(at, color=DESIGN_COLOUR, lw=0.8, ls=DOTTED, zorder=1)
    place = {"xy": (at, 1.0), "xycoords": ("data", "axes fraction")}
    offset = {"xytext": (0, 2), "textcoords": "offset points", "ha": "center", "va": "bottom"}
    axes.annotate(said, **place, **offset, fontsize=7.5, color=DESIGN_COLOUR)


def _draw_bound(axes: Axes, bound: float) -> None:
    """The bound as a line, where it is anything."""
    if bound > 1e-6:
        axes.axhline(bound, color=TARGET_COLOUR, lw=1.2, ls=(0, (8, 3)), zorder=1)
        said = f"no section is below {bound:.2f} mm²"
        place = {"xy": (0.01, bound), "xycoords": ("axes fraction", "data")}
        offset = {"xytext": (0, -3), "textcoords": "offset points"}
        axes.annotate(said, **place, **offset, va="top", color=TARGET_COLOUR, fontsize=7.5)
