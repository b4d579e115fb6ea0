"""Connected pieces: islands of material and separate chambers, found by union-find."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from beamopt.base.arrays import IndexArray, LabelArray
from beamopt.base.compiled import compiled
from beamopt.section.grid import PolarGrid

__all__ = ["Pieces", "connected_runs", "count_pieces", "join", "lowest"]


@dataclass(frozen=True, slots=True)
class Pieces:
    """How many connected pieces a section has.

    material : pieces of material.
    chambers : separate chambers of supplies 1, 2, 3.
    """

    material: int
    chambers: tuple[int, int, int]

    @property
    def islands(self) -> int:
        """Pieces of material that hang on to nothing: all but one."""
        return max(self.material - 1, 0)


def count_pieces(grid: PolarGrid, labels: LabelArray) -> Pieces:
    """Count pieces joined over the four neighbours, round the ring where it is full."""
    labels = np.array(labels, dtype=np.uint8)  # one kind of array, one kernel: not read-only
    row, first, _, lowest_run = connected_runs(labels, grid.is_full_ring)
    own = lowest_run == np.arange(row.size)
    counts = np.bincount(labels[row[own], first[own]], minlength=4).tolist()
    return Pieces(counts[0], (counts[1], counts[2], counts[3]))


@compiled
def connected_runs(
    labels: LabelArray, periodic: bool
) -> tuple[IndexArray, IndexArray, IndexArray, IndexArray]:
    """Runs of equal elements: row, first column, column after the last, lowest run of the piece.

    Joined over the four neighbours, round the ring where `periodic`.
    """
    rows, columns = labels.shape
    total = rows
    for i in range(rows):
        here, after = labels[i], labels[i, 1:]
        for j in range(columns - 1):
            total += here[j] != after[j]
    row = np.empty(total, dtype=np.int64)
    first = np.empty(total, dtype=np.int64)
    last = np.empty(total, dtype=np.int64)
    root = np.arange(total)
    above = k = 0
    for i in range(rows):
        begin = k
        row[k], first[k] = i, 0
        for j in range(1, columns):
            if labels[i, j] != labels[i, j - 1]:
                last[k] = j
                k += 1
                row[k], first[k] = i, j
        last[k] = columns
        k += 1
        if periodic and labels[i, 0] == labels[i, columns - 1]:
            join(root, begin, k - 1)
        over, under = above, begin
        while i > 0 and over < begin and under < k:
            if labels[i - 1, first[over]] == labels[i, first[under]]:
                join(root, over, under)
            end = min(last[over], last[under])
            over += last[over] == end
            under += last[under] == end
        above = begin
    for m in range(total):
        root[m] = lowest(root, m)
    return row, first, last, root


@compiled
def lowest(parent: IndexArray, k: int) -> int:
    """The lowest member of what `k` is joined to; `parent` is 0, 1, 2, … at first."""
    while parent[k] != k:
        parent[k] = parent[parent[k]]
        k = parent[k]
    return k


@compiled
def join(parent: IndexArray, k: int, m: int) -> bool:
    """Make two pieces one; whether they were two."""
    one, other = lowest(parent, k), lowest(parent, m)
    parent[max(one, other)] = min(one, other)
    return one != other
