"""A workspace as a picture: the quadratic hexahedron, its nodes, the backbones that lead there.

Where tips are no workspace, they are dots; trajectories are lines.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.plot.style import ASIDE_COLOUR, DESIGN_COLOUR, TARGET_COLOUR, pressure_colours
from beamopt.target.workspace import Workspace

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = [
    "Dots",
    "FollowedTrajectories",
    "draw_diagonal",
    "draw_down",
    "draw_from_above",
    "pressure_handles",
]

TANGENT = 8.0  # mm, of the line that shows where a tip points


@dataclass(frozen=True, eq=False)
class Dots:
    """Tips (n, 3) [mm] at any pressures (n, 3) [kPa], which no hexahedron joins.

    directions : (n, 3) unit tangents of the axis there; NaN for those that nobody asks for.
    """

    pressures: FloatArray
    tips: FloatArray
    directions: FloatArray

    def edge_curves(self) -> FloatArray:
        """None."""
        return np.zeros((0, 2, 3))


@dataclass(frozen=True, eq=False)
class FollowedTrajectories:
    """Trajectories, each (k, 3) [mm], and the tips (m, 3) that come nearest to all their points."""

    paths: Sequence[FloatArray]
    tips: FloatArray | None = None


def draw_from_above(
    axes: Axes,
    workspace: Workspace | Dots | None,
    target: Workspace | Dots | None = None,
    backbones: FloatArray | None = None,
    followed: FollowedTrajectories | None = None,
) -> None:
    """Draw the workspace seen along the actuator, x to the right and y up [mm]."""
    _draw(axes, (0, 1), workspace, target, backbones)
    if followed is not None:
        _draw_followed(axes, (0, 1), followed)
    axes.set(aspect="equal", xlabel="x [mm]", ylabel="y [mm]", title="from above")
    axes.grid(True)


def draw_diagonal(
    axes: Any,
    workspace: Workspace | Dots | None,
    target: Workspace | Dots | None = None,
    backbones: FloatArray | None = None,
    followed: FollowedTrajectories | None = None,
) -> None:
    """Draw the workspace seen diagonally, on three-dimensional axes [mm]."""
    _draw(axes, (0, 1, 2), workspace, target, backbones)
    shown = [w.tips for w in (workspace, target) if w is not None]
    if followed is not None:
        _draw_followed(axes, (0, 1, 2), followed)
        shown += [*followed.paths, *([] if followed.tips is None else [followed.tips])]
    points = np.vstack(shown + ([backbones.reshape(-1, 3)] if backbones is not None else []))
    axes.set_box_aspect(
        np.maximum(np.nanmax(points, axis=0) - np.nanmin(points, axis=0), 20.0), zoom=1.1
    )
    axes.view_init(elev=22, azim=-60)
    axes.locator_params(nbins=4)
    axes.locator_params(axis="y", nbins=3)
    axes.set(xlabel="x [mm]", ylabel="y [mm]", zlabel="z [mm]", title="diagonal")


def draw_down(axes: Any, down: FloatArray, near: FloatArray) -> None:
    """Draw an arrow that points down in the room, (3,) in the base's axes, beside the points."""
    low, high = np.nanmin(near, axis=0), np.nanmax(near, axis=0)
    size = 0.25 * float(np.max(high - low))
    start = np.array([low[0] - 0.3 * size, high[1], (low[2] + high[2]) / 2]) - down * size / 2
    axes.quiver(*start, *(down * size), color=ASIDE_COLOUR, lw=1.6, arrow_length_ratio=0.25)
    axes.text(*start, "down ", color=ASIDE_COLOUR, ha="right")


def pressure_handles() -> list[Any]:
    """Legend entries for backbones: colour is pressure, of supply 1 red, 2 green, 3 blue."""
    from matplotlib.lines import Line2D

    only = pressure_colours(np.eye(3))
    return [
        Line2D([], [], color=colour, lw=1.2, label=f"backbones: p{supply} alone")
        for supply, colour in enumerate(only, 1)
    ]


def _draw(
    axes: Any,
    dims: tuple[int, ...],
    workspace: Workspace | Dots | None,
    target: Workspace | Dots | None,
    backbones: FloatArray | None,
) -> None:
    if backbones is not None and workspace is not None:
        for line, colour in zip(backbones, pressure_colours(workspace.pressures), strict=True):
            axes.plot(*line[:, dims].T, color=colour, lw=0.8, alpha=0.75)
    for space, colour, style, marker, name in (
        (workspace, DESIGN_COLOUR, "-", "o", "design"),
        (target, TARGET_COLOUR, (0, (4, 2)), "x", "target"),
    ):
        if space is None:
            continue
        for curve in space.edge_curves():
            axes.plot(*curve[:, dims].T, color=colour, ls=style, lw=1.2)
        handle = {"label": name, "color": colour, "ls": "none", "marker": marker}
        axes.plot(*space.tips[:, dims].T, **handle, ms=3.5 if marker == "o" else 5)
        if isinstance(space, Dots):
            _draw_directions(axes, dims, space, colour)
    if isinstance(workspace, Dots) and isinstance(target, Dots):
        _draw_distances(axes, dims, workspace.tips, target.tips)


def _draw_distances(axes: Any, dims: tuple[int, ...], tips: FloatArray, wanted: FloatArray) -> None:
    """A line from each tip to where it should be."""
    for pair in np.stack([tips, wanted], axis=1)[..., list(dims)]:
        axes.plot(*pair.T, color=TARGET_COLOUR, lw=0.8)


def _draw_directions(axes: Any, dims: tuple[int, ...], dots: Dots, colour: str) -> None:
    """A short line the way that each tip points."""
    ends = np.stack([dots.tips, dots.tips + TANGENT * dots.directions], axis=1)
    for line in ends[~np.isnan(ends).any(axis=(1, 2))][..., list(dims)]:
        axes.plot(*line.T, color=colour, lw=1.6)


def _draw_followed(axes: Any, dims: tuple[int, ...], followed: FollowedTrajectories) -> None:
    for k, path in enumerate(followed.paths):
        label = {"label": "trajectory"} if k == 0 else {}
        axes.plot(*path[:, dims].T, color=TARGET_COLOUR, ls=(0, (4, 2)), lw=1.4, **label)
    if followed.tips is not None:
        handle: Any = {"label": "reached", "color": DESIGN_COLOUR, "ls": "none", "marker": "o"}
        axes.plot(*followed.tips[:, dims].T, **handle, ms=2.5)
        _draw_distances(axes, dims, followed.tips, np.concatenate(followed.paths))
