"""A cross-section as a picture."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from beamopt.outline.outline import Outline
from beamopt.plot.style import BELOW, OUTLINE_COLOUR, SUPPLY_COLOURS, TYPE_COLOURS
from beamopt.section.cross_section import CrossSection
from beamopt.section.feature_points import SUPPLIES
from beamopt.section.grid import PolarGrid

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["OUTSIDE", "draw_section", "section_pixels"]

PIXELS = 720
OUTSIDE = -1


def section_pixels(section: CrossSection, pixels: int) -> NDArray[np.int64]:
    """(pixels, pixels) element types seen from the tip, first row at the top; −1 outside."""
    grid = section.grid
    centres = ((np.arange(pixels) + 0.5) / pixels * 2 - 1) * grid.outer_radius
    x, y = np.meshgrid(centres, centres[::-1])
    row, column, inside = grid.elements_at(x, y)
    types = np.full(x.shape, OUTSIDE, dtype=np.int64)
    types[inside] = section.labels[row[inside], column[inside]]
    return types


def draw_section(
    axes: Axes, section: CrossSection, title: str = "", outline: Outline | None = None
) -> None:
    """Draw a section in the paper's colours, chambers numbered by their supply.

    outline : drawn instead of the raster, where the section is that.
    """
    from matplotlib.patches import Patch

    if outline is None:
        _draw_raster(axes, section)
    else:
        _draw_outline(axes, outline)
    grid, moments = section.grid, (section if outline is None else outline).moments
    _number_chambers(axes, section)
    cx, cy = moments.centroid
    axes.plot(cx, cy, "+", color="black", ms=7, mew=1.0, zorder=3)
    areas = moments.chamber_areas
    handles = [Patch(fc=TYPE_COLOURS[0], label=f"material {moments.area:.0f} mm²")] + [
        Patch(fc=colour, label=f"supply {supply}: {area:.0f} mm²")
        for supply, colour, area in zip(SUPPLIES, SUPPLY_COLOURS, areas, strict=True)
    ]
    axes.legend(handles=handles, **BELOW)
    axes.set(aspect="equal", title=title, xlabel="x [mm]", ylabel="y [mm]")
    axes.set(xlim=_around(grid, 0), ylim=_around(grid, 1))


def _draw_raster(axes: Axes, section: CrossSection) -> None:
    from matplotlib.colors import to_rgba

    grid = section.grid
    outer = grid.outer_radius
    palette = np.array([to_rgba(colour) for colour in TYPE_COLOURS] + [(1, 1, 1, 0)])
    image = palette[section_pixels(section, PIXELS)]
    axes.imshow(image, extent=(-outer, outer, -outer, outer), interpolation="none", zorder=1)
    angles = np.linspace(grid.angles[0], grid.angles[-1], 361)
    for radius in (grid.inner_radius, outer):
        axes.plot(radius * np.cos(angles), radius * np.sin(angles), color=OUTLINE_COLOUR, lw=0.8)


def _draw_outline(axes: Axes, outline: Outline) -> None:
    """Material and chambers as polygons; the holes of one are the other's."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    shapes = [(TYPE_COLOURS[0], [one.points for one in piece.loops]) for piece in outline.pieces]
    shapes += [(TYPE_COLOURS[c.supply], [c.exterior, *c.holes]) for c in outline.chambers]
    for colour, loops in shapes:
        closed = [Path(np.concatenate([loop, loop[:1]]), closed=True) for loop in loops]
        path = Path.make_compound_path(*closed)
        axes.add_patch(PathPatch(path, fc=colour, ec=OUTLINE_COLOUR, lw=0.6, zorder=1))


def _around(grid: PolarGrid, axis: int) -> tuple[float, float]:
    """Limits that leave a little room around the ring or sector."""
    directions = np.stack([np.cos(grid.angles), np.sin(grid.angles)])[axis]
    reach = np.outer([grid.inner_radius, grid.outer_radius], directions)
    room = 0.05 * grid.outer_radius
    return float(reach.min() - room), float(reach.max() + room)


def _number_chambers(axes: Axes, section: CrossSection) -> None:
    """Write each supply's number where its chambers are thickest, far enough apart."""
    from matplotlib.patheffects import withStroke
    from scipy.ndimage import distance_transform_edt, label

    coarse = section_pixels(section, 160)
    scale = 2 * section.grid.outer_radius / 160
    for supply in SUPPLIES:
        pieces, count = label(coarse == supply)
        for piece in range(1, count + 1):
            depth = distance_transform_edt(np.pad(pieces == piece, 1))[1:-1, 1:-1]
            if depth.max() * scale < 0.6:
                continue
            row, column = np.unravel_index(int(depth.argmax()), depth.shape)
            x = (column + 0.5) * scale - section.grid.outer_radius
            y = section.grid.outer_radius - (row + 0.5) * scale
            text = axes.text(x, y, str(supply), ha="center", va="center", size=7.5, zorder=4)
            text.set_path_effects([withStroke(linewidth=2.0, foreground="white")])
