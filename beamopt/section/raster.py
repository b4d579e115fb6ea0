"""From feature points to the type of every element: the nearest point's (paper, Algorithm 1)."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray, LabelArray
from beamopt.base.compiled import compiled
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid

__all__ = ["TIE", "Tiling", "nearest_types", "raster", "tiling"]


TIE = 1e-9
"""Squared distances [mm²] closer than this are a tie, and a tie goes to the lowest index.

Feature points lie on element centroids, so that whole columns of elements are equally far from two
points; without a tolerance, rounding would scatter such a column over both.
"""

SLACK = 1e-4  # mm; more than √TIE, so that no point of a tie is left out

ROWS, COLUMNS = 16, 8  # elements of a tile
SIZE = ROWS * COLUMNS
BLOCK_ROWS, BLOCK_COLUMNS = 2, 3  # tiles of a block


class Tiling(NamedTuple):
    """The grid cut into tiles of elements and blocks of tiles, so that far points drop out early.

    x, y (tile rows, tile columns, SIZE) : element centroids, the last ones repeated [mm].
    centres (2, …), reach (…) : middle of each tile, distance to its farthest centroid [mm].
    block_centres, block_reach : the same for blocks.
    """

    x: FloatArray
    y: FloatArray
    centres: FloatArray
    reach: FloatArray
    block_centres: FloatArray
    block_reach: FloatArray


@lru_cache(maxsize=16)
def tiling(grid: PolarGrid) -> Tiling:
    """Measure the grid's tiles and blocks."""
    down, across = -(-grid.radial // ROWS), -(-grid.angular // COLUMNS)
    rows = np.minimum(np.arange(down * ROWS), grid.radial - 1)
    columns = np.minimum(np.arange(across * COLUMNS), grid.angular - 1)
    x, y = (
        np.ascontiguousarray(
            part[np.ix_(rows, columns)]
            .reshape(down, ROWS, across, COLUMNS)
            .swapaxes(1, 2)
            .reshape(down, across, SIZE)
        )
        for part in grid.centroids
    )
    blocks = -(-down // BLOCK_ROWS), -(-across // BLOCK_COLUMNS)
    tiles = [np.s_[a : a + 1, b : b + 1] for a in range(down) for b in range(across)]
    grouped = [
        np.s_[a : a + BLOCK_ROWS, b : b + BLOCK_COLUMNS]
        for a in range(0, down, BLOCK_ROWS)
        for b in range(0, across, BLOCK_COLUMNS)
    ]
    return Tiling(x, y, *_circles(x, y, tiles, (down, across)), *_circles(x, y, grouped, blocks))


def _circles(
    x: FloatArray, y: FloatArray, parts: list[tuple[slice, slice]], shape: tuple[int, int]
) -> tuple[FloatArray, FloatArray]:
    """Centre and radius of a circle around the centroids of each part."""
    middles = np.array([(x[part].mean(), y[part].mean()) for part in parts])
    reach = [
        np.hypot(x[part] - cx, y[part] - cy).max()
        for part, (cx, cy) in zip(parts, middles, strict=True)
    ]
    return middles.T.reshape(2, *shape).copy(), np.reshape(reach, shape)


def raster(grid: PolarGrid, points: FeaturePoints) -> LabelArray:
    """(radial, angular) type of the feature point nearest to each element's centroid.

    0 is material, 1…3 a chamber of that supply; without any point everything is material.
    """
    labels = np.zeros(grid.shape, dtype=np.uint8)
    nearest_types(points.x, points.y, points.type, tiling(grid), labels)
    return labels


@compiled
def nearest_types(
    px: FloatArray,
    py: FloatArray,
    types: LabelArray | IndexArray,
    tiles: Tiling,
    labels: LabelArray | IndexArray,
) -> None:
    """Write each element's type to `labels`, which stays as it is when there is no point.

    With the points' indices for types, it is the nearest point's index.
    """
    n = px.size
    if n == 0:
        return
    everyone = np.arange(n)
    in_block = np.empty(n, dtype=np.int64)
    in_tile = np.empty(n, dtype=np.int64)
    squared = np.empty(n)
    best = np.empty(SIZE)
    kind = np.empty(SIZE, dtype=np.int64)
    down, across = tiles.reach.shape
    for A in range(tiles.block_reach.shape[0]):
        for B in range(tiles.block_reach.shape[1]):
            cx, cy = tiles.block_centres[0, A, B], tiles.block_centres[1, A, B]
            m = _possible(px, py, everyone, cx, cy, tiles.block_reach[A, B], in_block, squared)
            for a in range(A * BLOCK_ROWS, min((A + 1) * BLOCK_ROWS, down)):
                for b in range(B * BLOCK_COLUMNS, min((B + 1) * BLOCK_COLUMNS, across)):
                    cx, cy = tiles.centres[0, a, b], tiles.centres[1, a, b]
                    reach = tiles.reach[a, b]
                    near = in_block[:m]
                    count = _possible(px, py, near, cx, cy, reach, in_tile, squared)
                    near = in_tile[:count]
                    _nearest_in_tile(px, py, types, near, tiles.x[a, b], tiles.y[a, b], best, kind)
                    i0, j0 = a * ROWS, b * COLUMNS
                    for i in range(i0, min(i0 + ROWS, labels.shape[0])):
                        for j in range(j0, min(j0 + COLUMNS, labels.shape[1])):
                            labels[i, j] = kind[(i - i0) * COLUMNS + j - j0]


@compiled
def _possible(
    px: FloatArray,
    py: FloatArray,
    among: IndexArray,
    cx: float,
    cy: float,
    reach: float,
    kept: IndexArray,
    squared: FloatArray,
) -> int:
    """Keep the points that can be nearest somewhere within `reach` of (cx, cy); return how many.

    By the triangle inequality those are at most 2·reach farther from the middle than the nearest.
    """
    closest = np.inf
    for q in range(among.size):
        dx, dy = px[among[q]] - cx, py[among[q]] - cy
        squared[q] = dx * dx + dy * dy
        closest = squared[q] if squared[q] < closest else closest
    limit = (np.sqrt(closest) + 2 * reach + SLACK) ** 2
    count = 0
    for q in range(among.size):
        kept[count] = among[q]
        count += squared[q] <= limit
    return count


@compiled
def _nearest_in_tile(
    px: FloatArray,
    py: FloatArray,
    types: LabelArray | IndexArray,
    near: IndexArray,
    x: FloatArray,
    y: FloatArray,
    best: FloatArray,
    kind: IndexArray,
) -> None:
    """Type of the nearest of a few points for every element of one tile."""
    first = np.int64(types[near[0]])
    uniform = True
    for q in range(1, near.size):
        uniform = uniform and types[near[q]] == first
    for e in range(SIZE):
        best[e] = np.inf
        kind[e] = first
    if uniform:
        return
    for q in range(near.size):
        u, v, t = px[near[q]], py[near[q]], np.int64(types[near[q]])
        for e in range(SIZE):
            dx, dy = x[e] - u, y[e] - v
            d = dx * dx + dy * dy
            nearer = d < best[e] - TIE
            best[e] = d if nearer else best[e]
            kind[e] = t if nearer else kind[e]
