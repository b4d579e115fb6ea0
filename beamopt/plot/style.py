"""One look for every figure: colours that survive printing and colour-blindness, stable files."""

from __future__ import annotations

import io
from collections.abc import Callable
from contextlib import AbstractContextManager
from functools import partial, wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, ParamSpec

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.storage.writing import write_atomic

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = [
    "ASIDE_COLOUR",
    "BELOW",
    "DESIGN_COLOUR",
    "MATERIAL_COLOUR",
    "OUTLINE_COLOUR",
    "SERIES_COLOURS",
    "SUPPLY_COLOURS",
    "TARGET_COLOUR",
    "TYPE_COLOURS",
    "count_generations",
    "figure_bytes",
    "log_losses",
    "new_figure",
    "pressure_colours",
    "save_figure",
    "styled",
]

P = ParamSpec("P")

MATERIAL_COLOUR = "#a9a9a9"
SUPPLY_COLOURS = ("#cf3f35", "#ffd84d", "#173a86")
TYPE_COLOURS = (MATERIAL_COLOUR, *SUPPLY_COLOURS)
"""Material grey, supplies red, yellow, blue: apart in lightness too, and numbered where drawn."""

DESIGN_COLOUR = "#303030"
OUTLINE_COLOUR = "#404040"
ASIDE_COLOUR = "#8c8c8c"  # for lines that are not the point of a figure
TARGET_COLOUR = "#e0218a"
SERIES_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#8a5aa8")
"""For lines that stand for methods (after Okabe and Ito)."""

BELOW: Any = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.13), "ncols": 2}
"""Where a legend stands that would cover what is drawn."""

TICK = r"$\mathdefault"  # how labels of ticks begin, which are formulas

_RC: Any = {
    "svg.hashsalt": "beamopt",
    "font.size": 9.0,
    "axes.titlesize": 10.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.7,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "legend.frameon": False,
}


def styled(draw: Callable[P, Figure]) -> Callable[P, Figure]:
    """Let a function draw in the project's style, without changing the caller's settings.

    Names of files and scenes stand in the figure as they are: no text is a formula.
    """

    @wraps(draw)
    def drawn(*args: P.args, **kwargs: P.kwargs) -> Figure:
        with _our_settings():
            figure = draw(*args, **kwargs)
        _show_as_they_are(figure)
        return figure

    return drawn


def _show_as_they_are(figure: Figure) -> None:
    from matplotlib.text import Text

    for text in figure.findobj(Text):
        said = text.get_text()
        if said and not said.startswith(TICK):
            text.set_parse_math(False)
            text.set_text("".join(c if c.isprintable() or c == "\n" else "\ufffd" for c in said))


def _our_settings() -> AbstractContextManager[None]:
    """Matplotlib's defaults and ours, whatever the person's own settings are."""
    from matplotlib import style

    return style.context(["default", _RC])


def new_figure(width: float, height: float, below: float = 0.0) -> Figure:
    """An empty figure of `width` × `height` inches, a share `below` of it left for legends."""
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    layout = ConstrainedLayoutEngine(rect=(0.0, below, 1.0, 1.0 - below))
    figure = Figure(figsize=(width, height), layout=layout)
    vars(figure)["_repr_png_"] = partial(_shown, figure)
    return figure


def _shown(figure: Figure) -> bytes:
    """The figure as notebooks show it; they know by themselves those of pyplot only."""
    stream = io.BytesIO()
    with _our_settings():
        figure.savefig(stream, format="png", dpi=100)
    return stream.getvalue()


def log_losses(axes: Axes, losses: FloatArray) -> None:
    """A logarithmic axis for losses, where there are any: those of nothing judged are infinite."""
    finite = losses[np.isfinite(losses)]
    if finite.size and finite.min() > 0:
        axes.set_yscale("log")


def count_generations(axes: Axes) -> None:
    """Mark whole generations only along the x axis."""
    from matplotlib.ticker import MaxNLocator

    axes.xaxis.set_major_locator(MaxNLocator(integer=True))


def save_figure(figure: Figure, *paths: Path, made_by: str | None = None) -> None:
    """Write a figure by each path's ending (.svg, .png, .pdf); the same one, the same bytes.

    made_by : what the file says that it was made by; matplotlib if left out.
    """
    endings = (path.suffix.lower()[1:] for path in paths)
    contents = figure_bytes(figure, *endings, made_by=made_by)
    for path, content in zip(paths, contents, strict=True):
        write_atomic(path, content)


def figure_bytes(figure: Figure, *endings: str, made_by: str | None = None) -> list[bytes]:
    """A figure as files of each ending (svg, png, pdf) hold it; the same one, the same bytes."""
    dateless: dict[str, Any] = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}
    maker = {"png": "Software", "svg": "Creator", "pdf": "Creator"}
    contents = []
    with _our_settings():
        figure.draw_without_rendering()
        figure.set_layout_engine("none")  # laid out now, once for all endings
        for ending in endings:
            stream = io.BytesIO()
            about = dateless.get(ending, {}) | ({maker[ending]: made_by} if made_by else {})
            figure.savefig(stream, format=ending, dpi=150, metadata=about)
            contents.append(stream.getvalue())
    return contents


def pressure_colours(pressures: FloatArray) -> FloatArray:
    """(n, 3) RGB of pressures (n, 3): supply 1 red, 2 green, 3 blue, by intensity (paper, Fig.)."""
    most = float(np.max(pressures))
    return np.asarray(pressures / most if most > 0 else np.zeros_like(pressures))
