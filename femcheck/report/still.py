"""The model as a picture, where nothing can turn: on paper, or without WebGL."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.plot.style import DESIGN_COLOUR, MATERIAL_COLOUR, new_figure, styled
from femcheck.report.packing import stretch_range
from femcheck.report.shapes import RunShapes

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["COLOURS", "colour_table", "side_view", "still_figure"]

COLOURS = "viridis"
"""Even steps of lightness, read alike by the colour-blind."""
ELEVATION = np.radians(16.0)


def colour_table() -> FloatArray:
    """(256, 3) colours from the smallest to the largest stretch, 0…1."""
    from matplotlib import colormaps

    return np.asarray(colormaps[COLOURS](np.linspace(0, 1, 256))[:, :3])


def side_view(line: FloatArray) -> float:
    """Azimuth of the eye [rad] from which a centreline (k, 3) is seen to bend sideways."""
    bent = line[-1, :2] - line[0, :2]
    if np.hypot(*bent) < 1e-6:
        return float(np.radians(-60.0))
    return float(np.arctan2(bent[1], bent[0]) - np.pi / 2)


@styled
def still_figure(shapes: RunShapes, shown: int) -> Figure:
    """The shape `shown`, coloured by its stretch, in front of the undeformed one; the beam's line.

    Drawn from back to front: the triangles are small beside the body.
    """
    from matplotlib.cm import ScalarMappable
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import ListedColormap, Normalize

    figure = new_figure(6.4, 5.2)
    axes = figure.add_subplot()
    shape, surface = shapes.shapes[shown], shapes.surface
    turn = _turn(side_view(shape.line))
    low, high = stretch_range(shapes)
    table = colour_table()
    rest = surface.rest @ turn.T
    order = np.argsort(rest[surface.triangles, 2].mean(axis=1))
    ghost = PolyCollection(list(rest[surface.triangles[order], :2]), fc=MATERIAL_COLOUR, alpha=0.1)
    at = shape.at @ turn.T
    corners = at[surface.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    facing = normals[:, 2] / np.where(lengths > 0, lengths, 1.0)
    front = np.flatnonzero(facing > 0)
    front = front[np.argsort(corners[front, :, 2].mean(axis=1), kind="stable")]
    level = (shape.stretch[surface.triangles[front]].mean(axis=1) - low) / (high - low)
    colours = table[np.clip(np.rint(255 * level), 0, 255).astype(int)]
    colours = colours * (0.55 + 0.45 * facing[front])[:, None]
    solid = PolyCollection(list(corners[front, :, :2]), fc=colours, ec=colours, lw=0.3)
    for collection in (ghost, solid):
        collection.set_rasterized(True)
        axes.add_collection(collection)
    axes.plot(*(shape.line @ turn.T)[:, :2].T, color=DESIGN_COLOUR, lw=2.0, label="the beam")
    axes.set(aspect="equal")
    axes.autoscale_view()
    axes.set_axis_off()
    axes.legend(loc="upper right")
    scale = ScalarMappable(Normalize(low, high), ListedColormap(table))
    bar = figure.colorbar(scale, ax=axes, orientation="horizontal", shrink=0.6, aspect=40, pad=0.02)
    bar.set_label("largest stretch in the surface")
    return figure


def _turn(azimuth: float) -> FloatArray:
    """Rows: to the right, up, and towards the eye."""
    towards = np.array(
        [
            np.cos(azimuth) * np.cos(ELEVATION),
            np.sin(azimuth) * np.cos(ELEVATION),
            np.sin(ELEVATION),
        ]
    )
    right = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    return np.stack([right, np.cross(towards, right), towards])
