"""Error against time of methods: a line a method, a point a resolution."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray
from beamopt.plot.style import (
    ASIDE_COLOUR,
    DESIGN_COLOUR,
    SERIES_COLOURS,
    TARGET_COLOUR,
    new_figure,
    styled,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["Line", "error_figure"]

BLUE, RED, GREEN, VIOLET = SERIES_COLOURS
LOOKS: dict[str, dict[str, Any]] = {
    "arc": {"color": DESIGN_COLOUR, "marker": "*", "ls": "", "ms": 11, "zorder": 5},
    "chain": {"color": DESIGN_COLOUR, "marker": "P", "ls": "", "ms": 8, "zorder": 5},
    "adaptive": {"color": BLUE, "marker": "D", "ls": "-", "ms": 6},
    "modes": {"color": BLUE, "marker": "o", "ls": "--", "mfc": "white"},
    "elements": {"color": RED, "marker": "s", "ls": "-"},
    "shooting": {"color": GREEN, "marker": "^", "ls": "-"},
    "shooting-magnus": {"color": GREEN, "marker": "^", "ls": "--", "mfc": "white"},
    "multiple-shooting": {"color": VIOLET, "marker": "v", "ls": "-."},
    "multiple-shooting-magnus": {"color": VIOLET, "marker": "v", "ls": ":", "mfc": "white"},
    "collocation": {"color": ASIDE_COLOUR, "marker": "X", "ls": (0, (5, 1.5))},
}
"""Pairs that differ in a detail share a colour; markers, dashes and fillings tell all apart."""

SMALLEST = 1e-15  # mm: less is nothing


@dataclass(frozen=True, eq=False)
class Line:
    """A method's points.

    resolutions : written at the first and the last one. seconds, errors : (n,) [s], [mm].
    whole : (n,) whether all cases have a tip; hollow crosses where they do not.
    """

    name: str
    resolutions: Sequence[int | None]
    seconds: FloatArray
    errors: FloatArray
    whole: NDArray[np.bool_]


@styled
def error_figure(
    lines: Sequence[Line], tolerance: float, uncertainty: float, title: str = ""
) -> Figure:
    """Largest error of a tip over the time for all of them; better is down and to the left.

    tolerance : of the scene [mm]. uncertainty : of the reference [mm]; below it nothing is told.
    """
    figure = new_figure(9.2, 5.4)
    axes = figure.add_subplot()
    axes.set(xscale="log", yscale="log", title=title)
    axes.set(xlabel="time for all tips [ms]", ylabel="largest error of a tip [mm]")
    for line in lines:
        _draw(axes, line, uncertainty)
    _limits(axes, lines, tolerance, uncertainty)
    axes.grid(True)
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), handlelength=3.6, labelspacing=0.9)
    return figure


def _draw(axes: Axes, line: Line, uncertainty: float) -> None:
    look = {"ms": 5.5, "lw": 1.4, "zorder": 3} | LOOKS.get(
        line.name, {"color": DESIGN_COLOUR, "marker": "."}
    )
    shown = np.isfinite(line.errors) & (line.errors > SMALLEST) & np.isfinite(line.seconds)
    good, bad = shown & line.whole, shown & ~line.whole
    axes.plot(1e3 * line.seconds[good], line.errors[good], label=line.name, **look)
    failed = {"ls": "", "marker": "x", "color": look["color"], "ms": 7, "zorder": 3}
    axes.plot(1e3 * line.seconds[bad], line.errors[bad], **failed)
    ends = np.flatnonzero(good & (line.errors > uncertainty))
    for k in {ends[0], ends[-1]} if ends.size else ():
        if line.resolutions[k] is not None:
            at = (1e3 * line.seconds[k], line.errors[k])
            axes.annotate(
                str(line.resolutions[k]), at, xytext=(5, 4), textcoords="offset points",
                color=look["color"], fontsize=7.0,
            )  # fmt: skip


def _limits(axes: Axes, lines: Sequence[Line], tolerance: float, uncertainty: float) -> None:
    """The scene's tolerance as a line, what is below the reference's uncertainty in grey."""
    errors = np.concatenate([line.errors for line in lines])
    errors = errors[np.isfinite(errors) & (errors > SMALLEST)]
    low, high = min([*errors, tolerance]) / 3, 3 * max([*errors, tolerance])
    axes.set_ylim(low, high)
    axes.axhline(tolerance, color=TARGET_COLOUR, lw=1.2, ls=(0, (8, 3)), label="scene's tolerance")
    if uncertainty > low:
        said = f"reference: ± {uncertainty:.1g} mm"
        axes.axhspan(low, uncertainty, color="#ececec", zorder=0, label=said)
