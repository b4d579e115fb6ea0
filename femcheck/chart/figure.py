"""Error against processor time: a line a family; below, the cheapest within each accuracy."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from beamopt.plot.style import (
    ASIDE_COLOUR,
    DESIGN_COLOUR,
    SERIES_COLOURS,
    TARGET_COLOUR,
    new_figure,
    styled,
)
from femcheck.chart.chart import ACCURACIES, Chart, ChartRow, seconds_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["chart_figure"]

BLUE, RED, GREEN, VIOLET = SERIES_COLOURS
DASHED, DOTTED = (0, (5, 2)), (0, (1.2, 1.2))
LOOKS: dict[str, dict[str, Any]] = {
    "raster": {"color": ASIDE_COLOUR, "marker": "o", "ls": "-"},
    "beam": {"color": DESIGN_COLOUR, "marker": "*", "ls": "", "ms": 12, "zorder": 6},
    "rod, adaptive": {"color": BLUE, "marker": "D", "ls": "-"},
    "rod, modes": {"color": BLUE, "marker": "o", "ls": DASHED, "mfc": "white"},
    "rod, elements": {"color": BLUE, "marker": "s", "ls": DOTTED},
    "rod, shooting": {"color": GREEN, "marker": "^", "ls": "-"},
    "rod, multiple-shooting": {"color": GREEN, "marker": "v", "ls": DASHED, "mfc": "white"},
    "rod, collocation": {"color": GREEN, "marker": "X", "ls": DOTTED},
    "wedge18": {"color": RED, "marker": "s", "ls": "-", "ms": 7, "zorder": 5},
    "hex27": {"color": RED, "marker": "h", "ls": DASHED, "mfc": "white", "ms": 7},
    "felupe": {"color": RED, "marker": "P", "ls": DOTTED},
    "tet10": {"color": VIOLET, "marker": "^", "ls": "-"},
    "tet4": {"color": VIOLET, "marker": "v", "ls": DASHED, "mfc": "white"},
}
"""Rods of one kind and solids of one kind share a colour; markers and dashes tell all apart."""

SMALLEST = 1e-5  # mm: what is nearer is drawn there


@styled
def chart_figure(chart: Chart) -> Figure:
    """Largest error of a tip over processor time, and who is cheapest within each accuracy."""
    figure = new_figure(9.6, 7.4, below=0.04)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=[4.0, 1.35])
    tips = len(chart.question.pressures)
    above.set(xscale="log", yscale="log")
    above.set_title(f"{chart.question.name}, {chart.question.law_text}: {tips} tips")
    above.set_ylabel("largest error of a tip [mm]")
    for family in dict.fromkeys(row.measured.family for row in chart.rows):
        _line(above, family, [row for row in chart.rows if row.measured.family == family])
    _band(above, chart)
    above.grid(True)
    above.legend(loc="center left", bbox_to_anchor=(1.0, 0.45), handlelength=3.4, labelspacing=0.8)
    _cheapest(below, chart)
    below.set_xlabel("processor time for all tips [s]")
    figure.text(0.01, 0.008, " | ".join(chart.made_with), fontsize=7.0, color="#505050")
    return figure


def _line(axes: Axes, family: str, rows: list[ChartRow]) -> None:
    look = {"ms": 6, "lw": 1.3, "zorder": 4} | LOOKS.get(family, {"color": "k", "marker": "."})
    seconds = np.array([row.measured.seconds for row in rows])
    errors = np.maximum(np.array([row.error for row in rows]), SMALLEST)
    whole = np.array([row.is_whole for row in rows])
    aside = np.array([row.is_aside for row in rows])
    axes.plot(seconds[whole & ~aside], errors[whole & ~aside], label=family, **look)
    axes.plot(seconds[whole & aside], errors[whole & aside], **look | {"ls": "", "ms": 4})
    part = ~whole & np.isfinite(errors)
    axes.plot(seconds[part], errors[part], ls="", marker="x", color=look["color"], ms=8)
    shown = np.flatnonzero(whole & ~aside & (errors > SMALLEST))
    for k in {shown[0], shown[-1]} if len(rows) > 1 and shown.size else ():
        at = (seconds[k], errors[k])
        axes.annotate(
            rows[k].mark,
            at,
            xytext=(5, 5),
            textcoords="offset points",
            fontsize=6.5,
            color=look["color"],
        )


def _band(axes: Axes, chart: Chart) -> None:
    for accuracy in ACCURACIES:
        axes.axhline(accuracy, color=TARGET_COLOUR, lw=0.9, ls=(0, (8, 3)), zorder=2)
        at = (0.995, accuracy)
        axes.annotate(
            f"{accuracy:g} mm", at, xycoords=("axes fraction", "data"), xytext=(0, 2),
            textcoords="offset points", ha="right", fontsize=7.0, color=TARGET_COLOUR,
        )  # fmt: skip
    if np.isfinite(chart.uncertainty):
        band = max(chart.uncertainty, 2 * SMALLEST)
        low = min(axes.get_ylim()[0], band / 3)
        label = f"reference ± {chart.uncertainty:.1g} mm"
        axes.axhspan(low, band, color="#ececec", zorder=0, label=label)
        axes.set_ylim(bottom=low)


def _cheapest(axes: Axes, chart: Chart) -> None:
    """A row an accuracy: the cheapest of every family, and the name of the first."""
    for place, accuracy in enumerate(ACCURACIES):
        axes.axhline(place, color="#dddddd", lw=0.8, zorder=0)
        if accuracy < chart.uncertainty:
            _say(axes, place, "the reference does not tell")
            continue
        near = chart.within(accuracy)
        if not near:
            _say(axes, place, "none of them")
            continue
        firsts = {row.measured.family: row for row in reversed(near)}
        for family, row in firsts.items():
            look = {"ms": 6} | LOOKS.get(family, {"marker": "."}) | {"ls": ""}
            axes.plot([row.measured.seconds], [place], **look)
        best = near[0].measured
        said = f"{best.family} {best.resolution}".strip()
        axes.annotate(
            f"{said}: {seconds_text(best.seconds)}", (best.seconds, place), xytext=(0, 7),
            textcoords="offset points", fontsize=7.5, weight="bold",
        )  # fmt: skip
    axes.set_yticks(range(len(ACCURACIES)), [f"within {value:g} mm" for value in ACCURACIES])
    axes.set_ylim(len(ACCURACIES) - 0.6, -0.75)
    axes.set_title("the cheapest of every family", fontsize=9.0, loc="left")


def _say(axes: Axes, place: int, text: str) -> None:
    at: Any = {"xycoords": ("axes fraction", "data"), "fontsize": 7.5, "va": "center"}
    axes.annotate(text, (0.01, place - 0.2), color="#606060", **at)
