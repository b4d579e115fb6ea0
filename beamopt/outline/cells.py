"""Exact Voronoi cells of feature points, and the regions that cells of one type make."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.section.feature_points import MATERIAL, SUPPLIES, FeaturePoints

if TYPE_CHECKING:
    from shapely import Geometry, Polygon

__all__ = ["regions", "territories"]

LATTICE = 1e-6  # mm; vertices that neighbouring cells share are the same after rounding to this
FARTHEST = 1e8  # mm; beyond that a bisector's place is lost to rounding


def regions(points: FeaturePoints, extent: float) -> tuple[Geometry, ...]:
    """For supplies 1, 2, 3 the union of their points' cells, within ±`extent` [mm].

    Raises
    ------
    ValueError : a feature point farther than 10⁸ mm from the axis.
    """
    return _unions(_in_order(points), extent)


def territories(points: FeaturePoints, extent: float) -> tuple[Geometry, ...]:
    """The same among the points of chambers alone: nearer to one's own chambers than to others'.

    They hold the regions and share no area, so that what stays half a wall away from the edge of
    its own territory is a whole wall away from every other supply.

    Raises
    ------
    ValueError : a feature point farther than 10⁸ mm from the axis.
    """
    points = _in_order(points)
    own = points.type != MATERIAL
    return _unions(FeaturePoints(points.x[own], points.y[own], points.type[own]), extent)


def _in_order(points: FeaturePoints) -> FeaturePoints:
    """Sorted by place, so that polygons are the same in any order; of equal places the earliest."""
    order = np.lexsort((points.y, points.x))
    x, y, kinds = points.x[order], points.y[order], points.type[order]
    new = np.ones(len(points), dtype=np.bool_)
    new[1:] = (np.diff(x) != 0) | (np.diff(y) != 0)
    return FeaturePoints(x[new], y[new], kinds[new])


def _unions(points: FeaturePoints, extent: float) -> tuple[Geometry, ...]:
    import shapely

    x, y, kinds = points.x, points.y, points.type
    if x.size and max(np.abs(x).max(), np.abs(y).max()) > FARTHEST:
        raise ValueError(f"feature points: at most {FARTHEST:g} mm from the axis")
    cells = _cells(x, y, extent)
    polygons: list[list[Polygon]] = [[] for _ in range(len(SUPPLIES) + 1)]
    for kind, cell in zip(kinds, cells, strict=True):
        if kind != MATERIAL and len(cell) > 2:
            rounded = np.rint(np.asarray(cell) / LATTICE) * LATTICE
            polygons[kind].append(shapely.Polygon(rounded))
    # with a grid, as cells that are clipped one by one may leave gaps of 1e-15 mm between them
    return tuple(
        shapely.union_all(
            [part for part in polygons[supply] if part.is_valid and part.area > 0],
            grid_size=LATTICE,
        )
        for supply in SUPPLIES
    )


def _cells(x: FloatArray, y: FloatArray, extent: float) -> list[list[tuple[float, float]]]:
    """Every point's cell: a square, cut by the bisectors to the others, the nearest first.

    No two points are in one place. Points that lie farther than twice the cell's farthest corner
    can not cut it any more.
    """
    e = float(extent)
    square = [(-e, -e), (e, -e), (e, e), (-e, e)]
    cells: list[list[tuple[float, float]]] = []
    for k in range(x.size):
        a, b = float(x[k]), float(y[k])
        squared = (x - a) ** 2 + (y - b) ** 2
        cell = square
        reach = _reach(cell, a, b)
        nearest = np.argsort(squared, kind="stable")
        for u, v, far in zip(*(a[nearest].tolist() for a in (x, y, squared)), strict=True):
            if far > 4 * reach:
                break
            if far == 0:
                continue  # the point itself
            # (u − a) X + (v − b) Y ≤ c on this side of the bisector
            c = ((u - a) * (u + a) + (v - b) * (v + b)) / 2
            clipped = _clip(cell, u - a, v - b, c)
            if clipped is not cell:
                cell = clipped
                if len(cell) < 3:
                    break
                reach = _reach(cell, a, b)
        cells.append(cell)
    return cells


def _reach(cell: Sequence[tuple[float, float]], a: float, b: float) -> float:
    return max((p - a) ** 2 + (q - b) ** 2 for p, q in cell)


def _clip(
    cell: list[tuple[float, float]], nx: float, ny: float, c: float
) -> list[tuple[float, float]]:
    """The part of a convex cell with nx X + ny Y ≤ c; the cell itself when nothing is cut."""
    over = [nx * p + ny * q - c for p, q in cell]
    if max(over) <= 0:
        return cell
    kept = []
    for k, (p, q) in enumerate(cell):
        d, before = over[k], over[k - 1]
        if (d > 0) != (before > 0):
            P, Q = cell[k - 1]
            t = before / (before - d)
            kept.append((P + t * (p - P), Q + t * (q - Q)))
        if d <= 0:
            kept.append((p, q))
    return kept
