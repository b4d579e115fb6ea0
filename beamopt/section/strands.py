"""Strands: the connected bits of material within each cell of a coarse grid, and their corners.

A coarse bilinear element for every cell would join what a gap narrower than the cell keeps apart:
an open section would become a closed one. Every strand therefore has four corner values of its own,
and shares them with a strand of a neighbouring cell only where material touches material.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import IndexArray, LabelArray
from beamopt.base.compiled import compiled
from beamopt.section.pieces import join, lowest

__all__ = ["join_corners", "label_strands", "number_corners"]


@compiled
def label_strands(
    labels: LabelArray, row_cell: IndexArray, column_cell: IndexArray, strand: NDArray[np.int32]
) -> IndexArray:
    """Number the strands in `strand` (radial, angular), −1 off material; (n, 2) their cells."""
    rows, columns = labels.shape
    parent = np.empty(labels.size, dtype=np.int64)
    count = 0
    for i in range(rows):
        continues = i > 0 and row_cell[i] == row_cell[i - 1]
        for j in range(columns):
            strand[i, j] = -1
            if labels[i, j] != 0:
                continue
            above = strand[i - 1, j] if continues else -1
            left = strand[i, j - 1] if j > 0 and column_cell[j] == column_cell[j - 1] else -1
            if left >= 0:
                strand[i, j] = left
                if above >= 0 and above != left:
                    join(parent, left, above)
            elif above >= 0:
                strand[i, j] = above
            else:
                strand[i, j] = count
                parent[count] = count
                count += 1
    number = np.empty(count, dtype=np.int64)
    strands = 0
    for k in range(count):
        if parent[k] == k:  # roots are the lowest of their tree
            number[k] = strands
            strands += 1
        else:
            number[k] = number[lowest(parent, k)]
    cells = np.empty((strands, 2), dtype=np.int64)
    for i in range(rows):
        for j in range(columns):
            if strand[i, j] >= 0:
                k = number[strand[i, j]]
                strand[i, j] = k
                cells[k, 0], cells[k, 1] = row_cell[i], column_cell[j]
    return cells


@compiled
def join_corners(
    strand: NDArray[np.int32],
    row_cell: IndexArray,
    column_cell: IndexArray,
    cells: IndexArray,
    periodic: bool,
    has_axis: bool,
) -> tuple[IndexArray, IndexArray]:
    """Which corners are one and the same, and which strands hang together.

    Corner 2a + b of a strand is the cell's at the inner (a = 0) or outer (1) radius and the first
    (b = 0) or last (1) angle. Returns for each corner (4 n,) and strand (n,) the lowest index of
    its class. With `has_axis` the innermost corners of a strand lie on the axis and are one.
    """
    rows, columns = strand.shape
    count = cells.shape[0]
    corner, piece = np.arange(4 * count), np.arange(count)
    for i in range(1, rows):
        if row_cell[i] != row_cell[i - 1]:
            for j in range(columns):
                s, t = int(strand[i - 1, j]), int(strand[i, j])
                if s >= 0 and t >= 0:
                    join(corner, 4 * s + 2, 4 * t)
                    join(corner, 4 * s + 3, 4 * t + 1)
                    join(piece, s, t)
    for j in range(columns):
        before = j - 1 if j > 0 else columns - 1
        if (j > 0 and column_cell[j] != column_cell[before]) or (j == 0 and periodic):
            for i in range(rows):
                s, t = int(strand[i, before]), int(strand[i, j])
                if s >= 0 and t >= 0:
                    join(corner, 4 * s + 1, 4 * t)
                    join(corner, 4 * s + 3, 4 * t + 2)
                    join(piece, s, t)
    if has_axis:
        for j in range(columns):
            s = int(strand[0, j])
            if s >= 0:
                join(corner, 4 * s, 4 * s + 1)
    for k in range(4 * count):
        corner[k] = lowest(corner, k)
    for s in range(count):
        piece[s] = lowest(piece, s)
    return corner, piece


@compiled
def number_corners(
    corner: IndexArray, cells: IndexArray, shape: tuple[int, int], periodic: bool
) -> tuple[IndexArray, int]:
    """Number the classes of corners so that neighbours lie close: (n, 4) numbers, and how many.

    Column by column; a full ring is folded (columns 0, 1, −1, 2, −2, …), so that the two ends of
    the band, which are neighbours, come together.
    """
    down, across = shape[0] + 1, shape[1] + 1
    place = np.empty(corner.size, dtype=np.int64)
    starts = np.zeros(2 * down * across + 2, dtype=np.int64)
    for k in range(corner.size):
        row, column = cells[k // 4, 0] + k % 4 // 2, cells[k // 4, 1] + k % 2
        if periodic:
            column %= shape[1]
            column = 2 * column - 1 if 2 * column <= shape[1] else 2 * (shape[1] - column)
            column = max(column, 0)
        place[k] = column * down + row
        if corner[k] == k:
            starts[place[k] + 1] += 1
    starts = np.cumsum(starts)
    number = np.empty((cells.shape[0], 4), dtype=np.int64)
    for k in range(corner.size):
        if corner[k] == k:
            number[k // 4, k % 4] = starts[place[k]]
            starts[place[k]] += 1
        else:
            number[k // 4, k % 4] = number[corner[k] // 4, corner[k] % 4]
    return number, starts[-1]
