"""What the rules of a sealed section mean on a grid, measured once for many sections."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray, LabelArray
from beamopt.section.grid import PolarGrid
from beamopt.section.seal import SealRules
from beamopt.section.spans import ROW_SHARE, Spans, circles_of, no_spans, widths_within

__all__ = ["SealArrays", "SealTable", "seal_table", "work"]


class SealTable(NamedTuple):
    """Rules as a grid's kernels need them.

    x, y (radial, angular) : element centroids [mm].
    free (2, circles) : first and last column that the skin leaves free; the last one below the
        first where it leaves nothing.
    apart, half_wall, corner : tables of `widths_within` for what supplies keep from each other,
        for closing and for opening; no column for a rule that is 0.
    inside : circles within the hole, before the one through row 0.
    period : columns of a whole turn.
    smallest : elements below which a chamber is filled.
    periodic, has_hole, fills_islands : whether the grid is a full ring; has an inner surface;
        whether islands become part of their chamber.
    """

    x: FloatArray
    y: FloatArray
    free: FloatArray
    apart: FloatArray
    half_wall: FloatArray
    corner: FloatArray
    inside: int
    period: float
    smallest: float
    periodic: bool
    has_hole: bool
    fills_islands: bool


class SealArrays(NamedTuple):
    """Arrays that sealing works in; made once for many sections."""

    cells: IndexArray
    owners: LabelArray
    borders: FloatArray
    owner_borders: FloatArray
    sealed: LabelArray
    one: Spans
    two: Spans
    free: Spans


@lru_cache(maxsize=16)
def seal_table(grid: PolarGrid, rules: SealRules) -> SealTable:
    """Measure what `rules` mean on `grid`."""
    circles = circles_of(grid, max(rules.wall / 2, rules.rounding))
    no_rule = np.zeros((circles.radii.size, 0))
    x, y = grid.centroids
    return SealTable(
        np.ascontiguousarray(x),
        np.ascontiguousarray(y),
        _columns_without_skin(grid, circles.radii, rules.skin),
        widths_within(circles, rules.wall / 2, ROW_SHARE) if rules.wall else no_rule,
        widths_within(circles, rules.wall / 2) if rules.wall else no_rule,
        widths_within(circles, rules.rounding) if rules.rounding else no_rule,
        circles.inside,
        circles.period,
        # a chamber as large as the rule says stays, whatever rounding does to its size
        rules.smallest_chamber / grid.element_area * (1 - 1e-9),
        grid.is_full_ring,
        grid.inner_radius > 0,
        rules.remove_islands,
    )


def _columns_without_skin(grid: PolarGrid, radii: FloatArray, skin: float) -> FloatArray:
    first = np.zeros(radii.size)
    if not grid.is_full_ring:
        sine = np.clip(skin / radii, 0, 1)
        first = np.arcsin(sine) / np.radians(grid.span) * grid.angular
    last = grid.angular - first
    inner = grid.inner_radius + skin if grid.inner_radius > 0 else 0.0
    if not grid.is_full_ring:
        inner = max(inner, skin)  # near the axis both ends are near
    last[(radii < inner) | (radii > grid.outer_radius - skin)] = -1.0
    return np.stack([first, last])


def work(grid: PolarGrid, table: SealTable) -> SealArrays:
    """Arrays for sealing sections of `grid`."""
    circles = table.free.shape[1]
    one, two, free = (no_spans(circles, grid.angular) for _ in range(3))
    return SealArrays(
        np.zeros(grid.shape, dtype=np.int64),
        np.zeros(grid.shape, dtype=np.uint8),
        np.zeros(grid.shape),
        np.zeros(grid.shape),
        np.zeros(grid.shape, dtype=np.uint8),
        one,
        two,
        free,
    )
