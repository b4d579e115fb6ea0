"""Which feature points count: those that have a cell in the section.

A feature point without a cell makes no chamber, and so it may not make a wall or be a neighbour
either. Every view of a section (raster, outline, moments, neighbour ratio) is made of the points
that `cell_owners` returns, so that adding a point without a cell changes nothing.
"""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from beamopt.base.compiled import compiled
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import Domain, PolarGrid
from beamopt.section.raster import TIE

__all__ = ["NEAR", "cell_owners", "distinct", "first_of_places", "points_with_cells"]

NEAR = float(np.sqrt(TIE))
"""Feature points at most this far apart [mm] are in one place: 3.2·10⁻⁵ mm."""


def points_with_cells(grid: PolarGrid, points: FeaturePoints) -> FeaturePoints:
    """The feature points that have a cell in a grid's ring or sector, in their order."""
    return _chosen(points, cell_owners(points.x, points.y, grid.domain))


def distinct(points: FeaturePoints) -> FeaturePoints:
    """The feature points that are in no earlier one's place, in their order."""
    return _chosen(points, first_of_places(points.x, points.y))


def _chosen(points: FeaturePoints, own: IndexArray) -> FeaturePoints:
    if own.size == len(points):
        return points
    return FeaturePoints(points.x[own], points.y[own], points.type[own])


@compiled
def cell_owners(px: FloatArray, py: FloatArray, domain: Domain) -> IndexArray:
    """Ascending indices of the feature points that have a cell in `domain`.

    A point has none in two cases:

    - Its own place belongs to an earlier point, because the squared distance between the two is at
      most `TIE`. The rule for elements gives that place to the lowest index, and the border
      between the two would depend on the rule for ties alone.
    - It lies outside the domain, and so does its whole Voronoi cell.
    """
    own = first_of_places(px, py)
    outside = False
    for k in own:
        outside |= not _contains(domain, px[k], py[k])
    if not outside:
        return own
    kept = np.empty_like(own)
    count = 0
    for k in own:
        kept[count] = k
        count += _contains(domain, px[k], py[k]) or _reaches(px, py, own, k, domain)
    return kept[:count]


@compiled
def first_of_places(px: FloatArray, py: FloatArray) -> IndexArray:
    """Indices of the points that are no nearer than `NEAR` to an earlier one of them.

    Points are looked for in buckets along x, as many as there are points.
    """
    n = px.size
    own = np.empty(n, dtype=np.int64)
    if n == 0:
        return own
    low = px.min()
    scale = min(n / max(px.max() - low, NEAR), 0.5 / NEAR)
    first, after = np.full(n + 2, -1), np.empty(n, dtype=np.int64)
    count = 0
    for k in range(n):
        x, y, alone = px[k], py[k], True
        here = int((x - low) * scale)
        before = int(max(x - low - NEAR, 0.0) * scale)
        behind = int((x - low + NEAR) * scale)
        for bucket in range(before, behind + 1):
            q = first[bucket]
            while q >= 0 and alone:
                alone = (px[q] - x) ** 2 + (py[q] - y) ** 2 > TIE
                q = after[q]
        if alone:
            after[k], first[here] = first[here], k
            own[count] = k
            count += 1
    return own[:count]


@compiled
def _contains(domain: Domain, x: float, y: float) -> bool:
    squared = x * x + y * y
    if not domain.inner * domain.inner <= squared <= domain.outer * domain.outer:
        return False
    if domain.span >= 2 * np.pi:
        return True
    return bool((np.arctan2(y, x) - domain.start) % (2 * np.pi) <= domain.span)


@compiled
def _reaches(px: FloatArray, py: FloatArray, among: IndexArray, k: int, domain: Domain) -> bool:
    """Whether the cell of point k among others is anywhere in the domain."""
    if domain.span >= 2 * np.pi:
        away = np.sqrt(px[k] * px[k] + py[k] * py[k])
        if away > 0:
            share = (domain.outer if away > domain.outer else domain.inner) / away
            if _is_nearest(px, py, among, k, share * px[k], share * py[k]):
                return True
        return _cell_reaches(px, py, among, k, domain, 0.0, 0.0)
    half = domain.span / 2  # less than half a turn, as half planes need it
    return _cell_reaches(px, py, among, k, domain, domain.start, half) or _cell_reaches(
        px, py, among, k, domain, domain.start + half, half
    )


@compiled
def _is_nearest(
    px: FloatArray, py: FloatArray, among: IndexArray, k: int, x: float, y: float
) -> bool:
    squared, nearest = (px[k] - x) ** 2 + (py[k] - y) ** 2, True
    for q in among:
        nearest &= q == k or (px[q] - x) ** 2 + (py[q] - y) ** 2 > squared
    return nearest


@compiled
def _cell_reaches(
    px: FloatArray,
    py: FloatArray,
    among: IndexArray,
    k: int,
    domain: Domain,
    start: float,
    span: float,
) -> bool:
    """Whether the cell of point k has places between the radii, from `start` over `span` [rad].

    A `span` of 0 is the whole turn. The distances from the axis that a convex cell has are all
    those between its least and its greatest one.
    """
    e = domain.outer
    room = among.size + 8
    x, y = np.empty(room), np.empty(room)
    x[0], x[1], x[2], x[3] = -e, e, e, -e
    y[0], y[1], y[2], y[3] = -e, -e, e, e
    size = 4
    if span > 0:
        size = _clip(x, y, size, np.sin(start), -np.cos(start), 0.0)
        size = _clip(x, y, size, -np.sin(start + span), np.cos(start + span), 0.0)
    a, b = px[k], py[k]
    for q in among:
        if q != k:
            u, v = px[q] - a, py[q] - b
            size = _clip(x, y, size, u, v, (u * (px[q] + a) + v * (py[q] + b)) / 2)
            if size < 3:
                return False
    low, high = _distances(x[:size], y[:size])
    return bool(low < domain.outer and high > domain.inner)


@compiled
def _clip(x: FloatArray, y: FloatArray, size: int, nx: float, ny: float, c: float) -> int:
    """Cut a convex polygon to nx X + ny Y ≤ c, in place; returns its number of vertices."""
    outside = False
    for m in range(size):
        outside |= nx * x[m] + ny * y[m] > c
    if not outside:
        return size
    old_x, old_y = x[:size].copy(), y[:size].copy()
    count = 0
    for m in range(size):
        over = nx * old_x[m] + ny * old_y[m] - c
        before = nx * old_x[m - 1] + ny * old_y[m - 1] - c
        if (over > 0) != (before > 0):
            t = before / (before - over)
            x[count] = old_x[m - 1] + t * (old_x[m] - old_x[m - 1])
            y[count] = old_y[m - 1] + t * (old_y[m] - old_y[m - 1])
            count += 1
        if over <= 0:
            x[count], y[count] = old_x[m], old_y[m]
            count += 1
    return count


@compiled
def _distances(x: FloatArray, y: FloatArray) -> tuple[float, float]:
    """Least and greatest distance from the axis in a convex polygon, counter-clockwise."""
    low, high, inside = np.inf, 0.0, True
    for m in range(x.size):
        u, v = x[m - 1], y[m - 1]
        dx, dy = x[m] - u, y[m] - v
        inside &= dx * v - dy * u <= 0
        length = dx * dx + dy * dy
        t = min(max(-(u * dx + v * dy) / length, 0.0), 1.0) if length > 0 else 0.0
        low = min(low, np.hypot(u + t * dx, v + t * dy))
        high = max(high, np.hypot(x[m], y[m]))
    return (0.0 if inside else low), high
