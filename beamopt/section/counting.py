"""Counting separate chambers and what is not symmetric, in compiled loops over many sections."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray, LabelArray
from beamopt.base.compiled import compiled
from beamopt.section.grid import PolarGrid
from beamopt.section.pieces import join
from beamopt.section.runs import Runs
from beamopt.section.symmetry import Symmetry

__all__ = ["Counts", "asymmetric_share", "count_chambers", "counts_for", "take_counts"]


class Counts(NamedTuple):
    """What is counted on each of n sections, and what is needed for it.

    chambers (n, 3) : separate chambers of each supply; (0, 3) where they are not asked for.
    asymmetry (n,) : share of the area whose type is not that of its image; (0,) if not asked for.
    columns (images, angular), types (images, 4) : the column and the type that each becomes under
        an image that is not the identity.
    """

    chambers: IndexArray
    asymmetry: FloatArray
    columns: IndexArray
    types: LabelArray


def counts_for(grid: PolarGrid, n: int, chambers: bool, symmetry: Symmetry | None) -> Counts:
    """Room for what is to be counted on `n` sections."""
    others = () if symmetry is None else symmetry.images[1:]
    columns = np.zeros((len(others), grid.angular), dtype=np.int64)
    types = np.zeros((len(others), 4), dtype=np.uint8)
    for k, (matrix, permutation) in enumerate(others):
        x, y = matrix @ grid.centroid_directions * grid.outer_radius * (1 - 1e-6)
        columns[k] = grid.elements_at(x, y)[1]
        types[k] = permutation
    return Counts(
        np.zeros((n if chambers else 0, 3), dtype=np.int64),
        np.zeros(n if others else 0),
        columns,
        types,
    )


@compiled
def take_counts(labels: LabelArray, runs: Runs, periodic: bool, k: int, counts: Counts) -> None:
    """Count on section `k`, of these element types and their runs, what is asked for."""
    if counts.chambers.shape[0] > 0:
        count_chambers(labels, runs, periodic, counts.chambers[k])
    if counts.asymmetry.size > 0:
        counts.asymmetry[k] = asymmetric_share(labels, counts.columns, counts.types)


@compiled
def count_chambers(labels: LabelArray, runs: Runs, periodic: bool, counts: IndexArray) -> None:
    """Write how many separate chambers each supply has to `counts` (3,).

    Joined over the four neighbours, round the ring where `periodic`: as `count_pieces` has it.
    Every run is a chamber at first; each touch of two chambers takes one away.
    """
    columns, ends = labels.shape[1], runs.ends
    root = np.arange(runs.begin[-1])
    counts[:] = 0
    for i in range(labels.shape[0]):
        row, begin, after = labels[i], runs.begin[i], runs.begin[i + 1]
        over = runs.begin[i - 1] if i > 0 else begin
        first = 0
        for k in range(begin, after):
            kind = row[first]
            if kind > 0:
                counts[kind - 1] += 1
                while over < begin and ends[over] <= first:
                    over += 1
                beside, column = over, first
                while beside < begin and column < ends[k]:
                    if labels[i - 1, column] == kind:
                        counts[kind - 1] -= join(root, beside, k)
                    column = ends[beside]
                    beside += 1
            first = ends[k]
        if periodic and row[0] > 0 and row[0] == row[columns - 1]:
            counts[row[0] - 1] -= join(root, begin, after - 1)


@compiled
def asymmetric_share(labels: LabelArray, columns: IndexArray, types: LabelArray) -> float:
    """Share of elements whose image is of another type than theirs becomes, over all images."""
    rows, across = labels.shape
    different = 0
    for k in range(columns.shape[0]):
        for i in range(rows):
            for j in range(across):
                different += labels[i, columns[k, j]] != types[k, labels[i, j]]
    share: float = different / (columns.shape[0] * rows * across)
    return share
