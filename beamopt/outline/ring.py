"""The ring, or sector of one, that a section is cut from, as a polygon."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.section.grid import PolarGrid

if TYPE_CHECKING:
    from shapely import Geometry, Polygon

__all__ = [
    "USUAL_RADIUS",
    "arc",
    "circle",
    "fine_sagitta",
    "quad_segs",
    "ring_polygon",
    "shrunk_ring",
    "usual_sagitta",
]

USUAL_RADIUS = 25.0
"""mm; every outline is built at this outer radius, then scaled: lengths in these modules are meant
at it."""

FEWEST_VERTICES, MOST_VERTICES = 128, 100_000  # of a full turn
QUARTER = 0.5, 16
"""mm; up to this radius, a quarter of a circle has so many edges in a buffer: 0.6 µm off."""


def fine_sagitta(grid: PolarGrid) -> float:
    """How far the edges of the smooth outline may be from its arcs [mm]: 0.5 µm at 25 mm."""
    return 2e-5 * grid.outer_radius


def usual_sagitta(grid: PolarGrid) -> float:
    """Largest distance of a design's outline from the smooth one [mm]: 40 µm at 25 mm."""
    return 1.6e-3 * grid.outer_radius


def arc(radius: float, first: float, last: float, sagitta: float) -> FloatArray:
    """(n, 2) vertices [mm] of an arc about the origin, both ends [rad] included.

    The ends lie on the arc, the vertices between them so far outside that the straight edges
    enclose the sector's area exactly.
    """
    if radius == 0 or first == last:
        return radius * np.array([[np.cos(first), np.sin(first)]])
    count = max(2, _steps(radius, abs(last - first), sagitta))
    phi = np.linspace(first, last, count + 1)
    at = np.full(count + 1, float(radius))
    step = abs(last - first) / count
    # n r² δ = (2 r ρ + (n − 2) ρ²) sin δ, solved for the radius ρ of the vertices between
    ratio = count * step / np.sin(step)
    at[1:-1] *= ratio / (1 + np.sqrt(1 + (count - 2) * ratio))
    return np.asarray(at[:, None] * np.stack([np.cos(phi), np.sin(phi)], axis=1))


def circle(radius: float, sagitta: float) -> FloatArray:
    """(n, 2) vertices [mm] of a regular polygon of the circle's area, counter-clockwise."""
    count = _steps(radius, 2 * np.pi, sagitta)
    step = 2 * np.pi / count
    phi = np.arange(count) * step
    at = radius * float(np.sqrt(step / np.sin(step)))
    return at * np.stack([np.cos(phi), np.sin(phi)], axis=1)


def quad_segs(radius: float) -> int:
    """Edges of a quarter of a circle in a buffer, all buffers' edges alike far off their arcs."""
    usual, count = QUARTER
    return round(count * math.sqrt(max(1.0, radius / usual)))


def _steps(radius: float, angle: float, sagitta: float) -> int:
    step = 2 * np.arccos(max(1 - sagitta / radius, np.cos(np.pi / FEWEST_VERTICES)))
    return max(1, min(int(np.ceil(angle / max(step, 1e-9))), MOST_VERTICES))


def ring_polygon(grid: PolarGrid) -> Polygon:
    """The whole ring or sector."""
    return _band(grid, grid.inner_radius, grid.outer_radius)


def shrunk_ring(grid: PolarGrid, skin: float) -> Geometry:
    """Where chambers may be: everything farther than `skin` [mm] from any surface."""
    import shapely

    inner, outer = grid.inner_radius, grid.outer_radius
    low, high = inner + skin if inner > 0 else 0.0, outer - skin
    if low >= high:
        return shapely.Polygon()
    band = _band(grid, low, high)
    if grid.is_full_ring:
        return band
    ends = np.radians([grid.start, grid.start + grid.span])
    across = np.array([inner, outer])[:, None]
    lines = [across * np.array([np.cos(end), np.sin(end)]) for end in ends]
    # not one offset of the sector: GEOS loses area where a skin is wider than the inner radius
    skins = shapely.buffer(shapely.linestrings(lines), skin, quad_segs=quad_segs(skin))
    return band.difference(shapely.union_all(skins))


def _band(grid: PolarGrid, inner: float, outer: float) -> Polygon:
    """Between two radii, however near they are to each other."""
    import shapely

    sagitta = fine_sagitta(grid)
    if grid.is_full_ring:
        rim = circle(outer, sagitta)
        return shapely.Polygon(rim, [inner / outer * rim[::-1]] if inner > 0 else [])
    first, last = np.radians(grid.start), np.radians(grid.start + grid.span)
    rim = arc(outer, first, last, sagitta)
    if outer - inner > 10 * sagitta:  # a copy of the rim may have edges of a micrometre
        back = arc(inner, last, first, sagitta)
    else:  # vertices at the same angles, so that the two arcs can not cross
        back = inner / outer * rim[::-1]
    return shapely.Polygon(np.concatenate([rim, back]))
