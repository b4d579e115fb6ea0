"""Sealing a section: skins, walls, closed gaps, rounded corners (the rules of `SealRules`).

The raster is the search's fast approximation of the sealed outline. To be near it, the rules work
on spans along the rows' circles, whose ends lie where the borders are and not at the elements'
edges; only what comes out is put back on elements, by centroid.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray, LabelArray
from beamopt.base.compiled import compiled
from beamopt.section.borders import (
    between_cells,
    between_supplies,
    between_types,
    keep_agreeing,
)
from beamopt.section.drawing import Shape, rasterise
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.fill import fill_islands, fill_small_chambers
from beamopt.section.grid import PolarGrid
from beamopt.section.raster import Tiling, nearest_types, tiling
from beamopt.section.seal import SealRules
from beamopt.section.seal_table import SealArrays, SealTable, seal_table, work
from beamopt.section.spans import Spans, add_span, close, complement, dilate, intersect, open_
from beamopt.section.walls import add_walls

__all__ = ["seal_drawing", "seal_points", "sealed_cells"]


def seal_points(
    grid: PolarGrid, points: FeaturePoints, wall_steps: int, rules: SealRules
) -> LabelArray:
    """(radial, angular) types of the sealed Voronoi section of feature points."""
    labels = np.zeros(grid.shape, dtype=np.uint8)
    table = seal_table(grid, rules)
    sealed_cells(
        points.x, points.y, points.type, tiling(grid), wall_steps, table, work(grid, table), labels
    )
    return labels


def seal_drawing(
    grid: PolarGrid, shapes: Sequence[Shape], wall_steps: int, rules: SealRules
) -> LabelArray:
    """(radial, angular) types of the sealed section of drawn chambers."""
    drawn = rasterise(grid, shapes)
    labels = drawn.copy()
    add_walls(labels, wall_steps, grid.is_full_ring)
    table = seal_table(grid, rules)
    space = work(grid, table)
    space.borders[:] = between_types(grid, shapes)
    keep_agreeing(labels, drawn, space.borders)
    if rules.wall:
        space.owners[:], space.owner_borders[:] = between_supplies(grid, drawn)
    _seal(labels, table, space)
    return labels


@compiled
def sealed_cells(
    px: FloatArray,
    py: FloatArray,
    types: LabelArray,
    tiles: Tiling,
    wall_steps: int,
    table: SealTable,
    space: SealArrays,
    labels: LabelArray,
) -> None:
    """Write the types of a sealed Voronoi section to `labels`."""
    labels[:] = 0
    chambers = np.flatnonzero(types)
    if chambers.size == 0:
        return
    cells, drawn = space.cells, space.sealed
    nearest_types(px, py, np.arange(px.size), tiles, cells)
    between_cells(cells, px, py, table.x, table.y, space.borders)
    _types_of(cells, types, labels)
    if wall_steps > 0:
        drawn[:] = labels
        add_walls(labels, wall_steps, table.periodic)
        keep_agreeing(labels, drawn, space.borders)
    if table.half_wall.shape[1] > 0:
        # what is nearer to a supply than to the others, were the material's points not there
        x, y, supplies = px[chambers], py[chambers], types[chambers]
        nearest_types(x, y, np.arange(x.size), tiles, cells)
        between_cells(cells, x, y, table.x, table.y, space.owner_borders)
        _types_of(cells, supplies, space.owners)
    _seal(labels, table, space)


@compiled
def _types_of(cells: IndexArray, types: LabelArray, labels: LabelArray) -> None:
    for i in range(cells.shape[0]):
        for j in range(cells.shape[1]):
            labels[i, j] = types[cells[i, j]]


@compiled
def _seal(labels: LabelArray, table: SealTable, space: SealArrays) -> None:
    """Apply the rules to `labels`, with borders and owners as they stand in `space`."""
    sealed, period = space.sealed, table.period
    one, two, free = space.one, space.two, space.free
    has_walls, has_corners = table.half_wall.shape[1] > 0, table.corner.shape[1] > 0
    sealed[:] = 0
    for supply in range(1, 4):
        if not _has(labels, supply):
            continue
        _free_of_skin(table, free)
        if has_walls:
            _spans_of(space.owners, space.owner_borders, supply, False, table, one)
            dilate(one, table.apart, period, two)
            complement(two, period)
            intersect(free, two, one)
            free, one = one, free
        _spans_of(labels, space.borders, supply, True, table, one)
        intersect(one, free, two)
        if has_walls:
            close(two, table.half_wall, period, one)
            intersect(two, free, one)
            one, two = two, one
        if has_corners:
            open_(two, table.corner, period, one)
        _write(two, supply, table.inside, sealed)
    labels[:] = sealed
    if table.smallest > 0:
        fill_small_chambers(labels, table.periodic, table.smallest)
    if table.fills_islands:
        fill_islands(labels, table.periodic, table.has_hole)


@compiled
def _has(labels: LabelArray, supply: int) -> bool:
    for i in range(labels.shape[0]):
        found = False
        for kind in labels[i]:
            found |= kind == supply
        if found:
            return True
    return False


@compiled
def _free_of_skin(table: SealTable, out: Spans) -> None:
    for i in range(out.number.size):
        out.number[i] = 0
        if table.free[1, i] > table.free[0, i]:
            add_span(out, i, table.free[0, i], table.free[1, i], table.period)


@compiled
def _spans_of(
    labels: LabelArray,
    borders: FloatArray,
    supply: int,
    own: bool,
    table: SealTable,
    out: Spans,
) -> None:
    """Spans of the elements that are of `supply`, or with `own` false of those that are not."""
    rows, columns = labels.shape
    out.number[:] = 0
    for i in range(rows):
        row, border = labels[i], borders[i]
        wraps = table.periodic and (row[0] == supply) != (row[columns - 1] == supply)
        end = border[columns - 1] if wraps else float(columns)
        begin = end - columns
        inside = (row[0] == supply) == own
        for j in range(columns - 1):
            if ((row[j + 1] == supply) == own) != inside:
                if inside:
                    add_span(out, table.inside + i, begin, border[j], table.period)
                begin = border[j]
                inside = not inside
        if inside:
            add_span(out, table.inside + i, begin, end, table.period)


@compiled
def _write(spans: Spans, supply: int, inside: int, labels: LabelArray) -> None:
    """Give `supply` to the elements whose centroids lie in the spans."""
    rows, columns = labels.shape
    for i in range(rows):
        for m in range(spans.number[inside + i]):
            first = max(int(np.ceil(spans.first[inside + i, m] - 0.5)), 0)
            last = min(int(np.floor(spans.last[inside + i, m] - 0.5)), columns - 1)
            for j in range(first, last + 1):
                labels[i, j] = supply
