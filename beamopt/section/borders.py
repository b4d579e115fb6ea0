"""Where the borders between elements of different types really lie, to a part of a column.

A border after column j is given in columns from the grid's start: j + 1 where only the elements are
known, and anywhere between the centroids of columns j and j + 1 where what they were made from is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray, LabelArray
from beamopt.base.compiled import compiled
from beamopt.section.drawing import Shape, rasterise
from beamopt.section.feature_points import SUPPLIES
from beamopt.section.grid import PolarGrid

__all__ = [
    "between_cells",
    "between_elements",
    "between_supplies",
    "between_types",
    "keep_agreeing",
]

CLEAR = 1e-3
"""Borders keep this far from centroids [columns], so that elements stay on their side of them."""

FINER = 8  # columns of the grid that a drawing's borders are found on, for one of the section's


@compiled
def between_cells(
    cells: IndexArray, px: FloatArray, py: FloatArray, x: FloatArray, y: FloatArray, out: FloatArray
) -> None:
    """Borders between Voronoi cells: where a row's circle crosses the bisector of two points.

    Along a column the difference of the squared distances is as good as linear.
    """
    rows, columns = cells.shape
    for i in range(rows):
        for j in range(columns):
            after = j + 1 if j + 1 < columns else 0
            p, q = cells[i, j], cells[i, after]
            out[i, j] = j + 1
            if p != q:
                ux, uy, vx, vy = px[p], py[p], px[q], py[q]
                before = _nearer(x[i, j], y[i, j], ux, uy, vx, vy)
                behind = _nearer(x[i, after], y[i, after], ux, uy, vx, vy)
                out[i, j] = _between(j, before, behind)


@compiled
def _nearer(x: float, y: float, ux: float, uy: float, vx: float, vy: float) -> float:
    """By how much the square of the distance to u is below that to v."""
    return (ux - vx) * (2 * x - ux - vx) + (uy - vy) * (2 * y - uy - vy)


@compiled
def _between(j: int, before: float, behind: float) -> float:
    """Where between the centroids of columns j and j + 1 a falling difference is zero."""
    share = before / (before - behind) if before - behind > 0 else 0.5
    return j + 0.5 + min(max(share, CLEAR), 1 - CLEAR)


@compiled
def keep_agreeing(labels: LabelArray, made_from: LabelArray, out: FloatArray) -> None:
    """Go back to the elements' edges where walls have changed an element beside a border."""
    rows, columns = labels.shape
    for i in range(rows):
        for j in range(columns):
            after = j + 1 if j + 1 < columns else 0
            if labels[i, j] != made_from[i, j] or labels[i, after] != made_from[i, after]:
                out[i, j] = j + 1


def between_elements(grid: PolarGrid) -> FloatArray:
    """(radial, angular) borders where nothing but the elements is known."""
    return np.tile(np.arange(1.0, grid.angular + 1), (grid.radial, 1))


def between_types(grid: PolarGrid, shapes: Sequence[Shape]) -> FloatArray:
    """(radial, angular) borders of a drawing, from a raster with finer columns."""
    fine = rasterise(replace(grid, angular=FINER * grid.angular), shapes)
    fine = fine.reshape(grid.radial, grid.angular, FINER)
    # from a column's middle to the next one's: how far what was there at first goes on
    halves = fine[:, :, FINER // 2 :], np.roll(fine, -1, axis=1)[:, :, : FINER // 2]
    way = np.concatenate(halves, axis=2)
    stays = np.cumprod(way == way[:, :, :1], axis=2).sum(axis=2)
    share = np.where(stays == FINER, 0.5, stays / FINER)
    columns = np.arange(grid.angular)
    return np.asarray(columns + 0.5 + np.clip(share, CLEAR, 1 - CLEAR))


def between_supplies(grid: PolarGrid, labels: LabelArray) -> tuple[LabelArray, FloatArray]:
    """Which supply's chambers are nearest, for every element, and where that changes.

    Returns the supplies (radial, angular), 0 where there are no chambers at all, and the borders.
    """
    from scipy.spatial import KDTree

    x, y = grid.centroids
    distances = np.full((len(SUPPLIES), *grid.shape), np.inf)
    for supply, distance in zip(SUPPLIES, distances, strict=True):
        own = labels == supply
        if own.any():
            tree = KDTree(np.stack([x[own], y[own]], axis=1))
            distance[own] = 0
            rest = np.stack([x[~own], y[~own]], axis=1)
            distance[~own] = tree.query(rest)[0] if len(rest) else 0
    nearest = np.asarray(distances.argmin(axis=0) + 1, dtype=np.uint8)
    nearest[np.isinf(distances.min(axis=0))] = 0
    borders = between_elements(grid)
    after = np.roll(nearest, -1, axis=1)
    for i, j in np.argwhere((nearest != after) & (nearest > 0) & (after > 0)):
        a, b, k = nearest[i, j] - 1, after[i, j] - 1, (j + 1) % grid.angular
        before = distances[b, i, j] - distances[a, i, j]
        behind = distances[b, i, k] - distances[a, i, k]
        borders[i, j] = _between(int(j), float(before), float(behind))
    return nearest, borders
