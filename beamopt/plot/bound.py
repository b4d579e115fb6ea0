"""The ideal tips beside the wanted ones: what no section can come nearer to."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.plot.style import (
    ASIDE_COLOUR,
    BELOW,
    DESIGN_COLOUR,
    TARGET_COLOUR,
    new_figure,
    styled,
)
from beamopt.plot.workspace import draw_diagonal, draw_from_above
from beamopt.target.workspace import Workspace

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["bound_figure"]


@styled
def bound_figure(
    pressures: FloatArray,
    ideal: FloatArray,
    wanted: FloatArray,
    levels: tuple[float, float, float] | None = None,
    title: str = "",
) -> Figure:
    """Ideal tips (n, 3) over wanted ones (n, 3) [mm], and how far apart they are at (n, 3) [kPa].

    levels : where the rows are the 27 combinations of three levels; they are drawn as workspaces.
    """
    figure = new_figure(13.0, 5.6, below=0.08)
    left, bars = figure.add_subplot(131), figure.add_subplot(132)
    right = figure.add_subplot(133, projection="3d")
    if levels is None:
        _draw_points(left, (0, 1), ideal, wanted)
        left.set(aspect="equal", xlabel="x [mm]", ylabel="y [mm]", title="from above")
        left.grid(True)
        _draw_points(right, (0, 1, 2), ideal, wanted)
        right.set(xlabel="x [mm]", ylabel="y [mm]")
        right.view_init(elev=22, azim=-60)
    else:
        spaces = Workspace(levels, ideal), Workspace(levels, wanted)
        draw_from_above(left, *spaces)
        draw_diagonal(right, *spaces)
    right.set(zlabel="", title="diagonal, z upwards [mm]")  # a label there is cut off
    for axes in (left, right):
        for one, other in zip(ideal, wanted, strict=True):
            ends = np.stack([one, other])[:, : 2 if axes is left else 3]
            axes.plot(*ends.T, color=ASIDE_COLOUR, lw=0.8)
    handles, labels = left.get_legend_handles_labels()
    left.legend(handles, ["ideal" if label == "design" else label for label in labels], **BELOW)
    _draw_distances(bars, pressures, np.linalg.norm(ideal - wanted, axis=1))
    if title:
        figure.suptitle(title)
    return figure


def _draw_points(axes: Any, dims: tuple[int, ...], ideal: FloatArray, wanted: FloatArray) -> None:
    """Rows at any pressures, as points."""
    axes.plot(*ideal[:, dims].T, "o", color=DESIGN_COLOUR, ms=3.5, label="ideal")
    axes.plot(*wanted[:, dims].T, "x", color=TARGET_COLOUR, ms=5, label="target")


def _draw_distances(axes: Axes, pressures: FloatArray, distances: FloatArray) -> None:
    """A bar for each of the farthest rows, the farthest on top."""
    farthest = np.argsort(-distances, kind="stable")[:27][::-1]
    names = [", ".join(f"{value:g}" for value in pressures[k]) for k in farthest]
    axes.barh(np.arange(len(farthest)), distances[farthest], color=ASIDE_COLOUR, height=0.7)
    axes.set_yticks(np.arange(len(farthest)), names, fontsize=7)
    axes.set(xlabel="distance of the ideal tip from the target's [mm]")
    axes.set(title="at the pressures p1, p2, p3 [kPa]")
    axes.set_xlim(0, max(1e-6, 1.05 * float(distances.max())))
    axes.grid(True, axis="x")
    axes.set_axisbelow(True)
