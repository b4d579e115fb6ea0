"""The shape derivative of a Voronoi section: how its moments change when feature points move."""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray, LabelArray
from beamopt.base.compiled import compiled
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import Domain, PolarGrid
from beamopt.section.neighbours import cell_neighbours, neighbours_of

__all__ = ["moment_slopes"]

GAUSS = 0.5 / np.sqrt(3.0)  # two points are exact for the cubics that are integrated


def moment_slopes(grid: PolarGrid, points: FeaturePoints, skin: float = 0.0) -> FloatArray:
    """Derivatives (n, 2, 4, 6) of the exact moments of every type by each point's x and y.

    Moving p_k by dp moves its edge to p_l with the normal speed (x − p_k)·dp / |p_l − p_k| towards
    p_l; the integral of {1, x, y, x², y², xy} times that speed along the edge goes from the type
    of l to that of k. Edges between equal types change nothing; walls are not looked at.

    skin : what is nearer to the ring's surfaces [mm] is material whatever happens.
    """
    slopes = np.zeros((len(points), 2, 4, 6))
    ring = grid.domain
    inner = ring.inner + skin if ring.inner > 0 else 0.0
    domain = ring._replace(inner=inner, outer=ring.outer - skin)
    edges = cell_neighbours(points.x, points.y, ring)
    begin, neighbours = neighbours_of(edges, len(points))
    _add_slopes(points.x, points.y, points.type, edges, begin, neighbours, domain, slopes)
    return slopes


@compiled
def _add_slopes(
    x: FloatArray,
    y: FloatArray,
    types: LabelArray,
    edges: IndexArray,
    begin: IndexArray,
    neighbours: IndexArray,
    domain: Domain,
    slopes: FloatArray,
) -> None:
    stops = np.empty(8)
    for e in range(edges.shape[0]):
        k, l = edges[e, 0], edges[e, 1]  # noqa: E741
        if types[k] == types[l]:
            continue
        dx, dy = x[l] - x[k], y[l] - y[k]
        distance = np.sqrt(dx * dx + dy * dy)
        # the bisector's points are foot + s·along, foot the one nearest to the axis
        ux, uy = -dy / distance, dx / distance
        mx, my = (x[k] + x[l]) / 2, (y[k] + y[l]) / 2
        middle = mx * ux + my * uy
        fx, fy = mx - middle * ux, my - middle * uy
        low, high = _between_others(x, y, k, l, fx, fy, ux, uy, begin, neighbours)
        low, high = max(low, -domain.outer), min(high, domain.outer)
        if low >= high:
            continue
        count = _stops(fx, fy, ux, uy, low, high, domain, stops)
        for piece in range(count - 1):
            a, b = stops[piece], stops[piece + 1]
            middle = (a + b) / 2
            if b > a and _inside(fx + middle * ux, fy + middle * uy, domain):
                for side in (-GAUSS, GAUSS):
                    s = middle + side * (b - a)
                    px, py = fx + s * ux, fy + s * uy
                    weight = (b - a) / 2 / distance
                    _move(slopes, k, types[k], types[l], px, py, px - x[k], py - y[k], weight)
                    _move(slopes, l, types[l], types[k], px, py, px - x[l], py - y[l], weight)


@compiled
def _between_others(
    x: FloatArray,
    y: FloatArray,
    k: int,
    l: int,  # noqa: E741
    fx: float,
    fy: float,
    ux: float,
    uy: float,
    begin: IndexArray,
    neighbours: IndexArray,
) -> tuple[float, float]:
    """The part of the bisector of k and l that no other neighbour of k is nearer to."""
    low, high = -np.inf, np.inf
    for q in neighbours[begin[k] : begin[k + 1]]:
        if q == l:
            continue
        # |x − p_k|² ≤ |x − p_q|²: 2 (p_q − p_k)·x ≤ |p_q|² − |p_k|²
        nx, ny = x[q] - x[k], y[q] - y[k]
        left = nx * (x[q] + x[k]) / 2 + ny * (y[q] + y[k]) / 2 - nx * fx - ny * fy
        slope = nx * ux + ny * uy
        if slope > 0:
            high = min(high, left / slope)
        elif slope < 0:
            low = max(low, left / slope)
        elif left < 0:
            return 0.0, 0.0
    return low, high


@compiled
def _stops(
    fx: float,
    fy: float,
    ux: float,
    uy: float,
    low: float,
    high: float,
    domain: Domain,
    stops: FloatArray,
) -> int:
    """Where a line may enter or leave the domain, ascending, with its ends."""
    stops[0], stops[1] = low, high
    count = 2
    away = fx * fx + fy * fy
    for radius in (domain.inner, domain.outer):
        if radius * radius > away:
            reach = np.sqrt(radius * radius - away)
            for s in (-reach, reach):
                if low < s < high:
                    stops[count] = s
                    count += 1
    if domain.span < 2 * np.pi:
        for angle in (domain.start, domain.start + domain.span):
            across = ux * np.sin(angle) - uy * np.cos(angle)
            if across != 0:
                s = (fy * np.cos(angle) - fx * np.sin(angle)) / across
                if low < s < high:
                    stops[count] = s
                    count += 1
    stops[:count].sort()
    return count


@compiled
def _inside(x: float, y: float, domain: Domain) -> bool:
    squared = x * x + y * y
    if not domain.inner * domain.inner < squared < domain.outer * domain.outer:
        return False
    turned = (np.arctan2(y, x) - domain.start) % (2 * np.pi)
    return bool(domain.span >= 2 * np.pi or turned < domain.span)


@compiled
def _move(
    slopes: FloatArray,
    point: int,
    gains: int,
    loses: int,
    x: float,
    y: float,
    along_x: float,
    along_y: float,
    weight: float,
) -> None:
    densities = (1.0, x, y, x * x, y * y, x * y)
    for m in range(6):
        for axis in range(2):
            change = weight * densities[m] * (along_x if axis == 0 else along_y)
            slopes[point, axis, gains, m] += change
            slopes[point, axis, loses, m] -= change
