"""Maps of verdicts: a row a method, a column a load, coloured, lettered and timed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from beamopt.plot.style import new_figure, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

__all__ = ["LOOKS", "Cell", "Panel", "map_figure"]

LOOKS: dict[str, tuple[str, str, str]] = {
    "RIGHT": ("R", "#d6e8f5", "#202020"),
    "REFUSED_RIGHTLY": ("r", "#a8c4d8", "#202020"),
    "INACCURATE": ("i", "#f0e442", "#202020"),
    "REFUSED_WRONGLY": ("x", "#d55e00", "#ffffff"),
    "TOO_SLOW": ("s", "#e69f00", "#202020"),
    "WRONG_BRANCH": ("W", "#7a1f5c", "#ffffff"),
    "NO_SUCH_TIP": ("N", "#101010", "#ffffff"),
    "UNDECIDED": ("?", "#ffffff", "#808080"),
}
"""Letter, colour, colour of the letter (after Okabe and Ito), by the name of a verdict.

The worse, the darker in print.
"""

NO_TEXTS: Mapping[str, str] = {}
CORNER = LOOKS["WRONG_BRANCH"][1]


@dataclass(frozen=True)
class Cell:
    """Several cases of one method.

    verdict : name of the commonest, a key of `LOOKS`. seconds : their median time.
    flagged : whether some of them got a wrong tip all the same, which is marked with a corner.
    success : share of them that are told as they are, where that is to be written.
    """

    verdict: str
    seconds: float
    flagged: bool
    success: float | None = None


@dataclass(frozen=True)
class Panel:
    """One map: rows, columns, and the cells of each row; None where there is no case."""

    title: str
    rows: Sequence[str]
    columns: Sequence[str]
    cells: Sequence[Sequence[Cell | None]]


@styled
def map_figure(
    panels: Sequence[Panel],
    title: str = "",
    across: int = 2,
    texts: Mapping[str, str] = NO_TEXTS,
) -> Figure:
    """Panels in rows of `across`; the legend in the place of one, or below.

    texts : of verdicts in the legend, by name; the name where there is none.
    """
    down = -(-len(panels) // across)
    room = down * across > len(panels)
    below = 0.0 if room else 1.15
    width = across * (1.9 + 0.45 * len(panels[0].columns))
    height = 0.5 + below + down * (0.6 + 0.3 * len(panels[0].rows))
    figure = new_figure(width, height, below=below / height)
    grid = figure.subplots(down, across, squeeze=False).ravel()
    for axes, panel in zip(grid, panels, strict=False):
        _draw(axes, panel)
    for axes in grid[len(panels) :]:
        axes.set_axis_off()
    if room:
        grid[-1].legend(
            handles=_legend(texts), loc="center", ncols=1, fontsize=11, labelspacing=0.9
        )
    else:
        figure.legend(handles=_legend(texts), loc="lower center", ncols=2)
    figure.suptitle(title)
    return figure


def _legend(texts: Mapping[str, str]) -> list[Patch]:
    from matplotlib.patches import Patch

    patches = [
        Patch(facecolor=colour, edgecolor="#808080", label=f"{letter}  {texts.get(name, name)}")
        for name, (letter, colour, _) in LOOKS.items()
    ]
    return [*patches, Patch(facecolor=CORNER, label="corner: some of the tips are wrong")]


def _draw(axes: Axes, panel: Panel) -> None:
    from matplotlib.patches import Polygon, Rectangle

    down, across = len(panel.rows), len(panel.columns)
    for y, row in enumerate(panel.cells):
        for x, cell in enumerate(row):
            if cell is None:
                continue
            letter, colour, ink = LOOKS[cell.verdict]
            axes.add_patch(Rectangle((x, y), 1, 1, facecolor=colour, edgecolor="white", lw=0.8))
            if cell.flagged:
                corner = [(x + 1, y), (x + 0.72, y), (x + 1, y + 0.4)]
                axes.add_patch(Polygon(corner, facecolor=CORNER, edgecolor="white", lw=0.5))
            middle: Any = {"ha": "center", "va": "center", "color": ink}
            at, said = x + 0.5, letter
            if cell.success is not None:
                at, said = x + 0.45, f"{letter} {cell.success:.0%}"
            axes.text(at, y + 0.35, said, fontsize=8, weight="bold", **middle)
            axes.text(x + 0.5, y + 0.76, _time(cell.seconds), fontsize=5.5, **middle)
    axes.set(xlim=(0, across), ylim=(down, 0), title=panel.title)
    axes.set_xticks(np.arange(across) + 0.5, panel.columns, fontsize=7.0)
    axes.set_yticks(np.arange(down) + 0.5, panel.rows)
    axes.tick_params(length=0)
    for side in axes.spines.values():
        side.set_visible(False)


def _time(seconds: float) -> str:
    """In ms, or s; nothing where it is not known."""
    if np.isnan(seconds):
        return ""
    return f"{1e3 * seconds:.2g} ms" if seconds < 0.0995 else f"{seconds:.2f} s"
