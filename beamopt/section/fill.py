"""Filling what can not be built: chambers too small, islands of material."""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import LabelArray
from beamopt.base.compiled import compiled
from beamopt.section.pieces import connected_runs

__all__ = ["fill_islands", "fill_small_chambers"]


@compiled
def fill_small_chambers(labels: LabelArray, periodic: bool, smallest: float) -> None:
    """Make chambers of fewer than `smallest` elements material, in place.

    A chamber is what hangs together over the four neighbours, round the ring where `periodic`.
    """
    row, first, last, root = connected_runs(labels, periodic)
    size = np.zeros(row.size, dtype=np.int64)
    for k in range(row.size):
        size[root[k]] += last[k] - first[k]
    for k in range(row.size):
        if size[root[k]] < smallest:
            for j in range(first[k], last[k]):
                labels[row[k], j] = 0


@compiled
def fill_islands(labels: LabelArray, periodic: bool, has_hole: bool) -> None:
    """Make material inside a chamber part of that chamber, in place.

    That is a piece of material that touches no surface (the inner one only where the ring
    `has_hole`, a sector's ends unless `periodic`) and no chambers but one supply's; a wall around
    another supply's chamber stays. So does the largest piece, whatever it touches.
    """
    row, first, last, root = connected_runs(labels, periodic)
    rows, columns = labels.shape
    size = np.zeros(row.size, dtype=np.int64)
    stays = np.zeros(row.size, dtype=np.bool_)
    around = np.zeros(row.size, dtype=np.int64)  # one bit a supply
    largest = 0
    for k in range(row.size):
        i, r = row[k], root[k]
        if labels[i, first[k]] != 0:
            continue
        size[r] += last[k] - first[k]
        largest = r if size[r] > size[largest] else largest
        stays[r] |= i == rows - 1 or (has_hole and i == 0)
        stays[r] |= not periodic and (first[k] == 0 or last[k] == columns)
        if first[k] > 0 or periodic:
            around[r] |= 1 << labels[i, (first[k] - 1) % columns]
        if last[k] < columns or periodic:
            around[r] |= 1 << labels[i, last[k] % columns]
        for beside in (i - 1, i + 1):
            if 0 <= beside < rows:
                for j in range(first[k], last[k]):
                    around[r] |= 1 << labels[beside, j]
    stays[largest] = True
    for k in range(row.size):
        if labels[row[k], first[k]] != 0 or stays[root[k]]:
            continue
        bits = around[root[k]] & ~1
        for supply in range(1, 4):
            if bits == 1 << supply:
                for j in range(first[k], last[k]):
                    labels[row[k], j] = supply
