"""Runs of equal elements along a grid's rows, found once for all that goes through a section."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from beamopt.base.arrays import IndexArray, LabelArray
from beamopt.base.compiled import compiled
from beamopt.section.grid import PolarGrid

__all__ = ["Runs", "find_runs", "room_for_runs", "runs_of_row"]


class Runs(NamedTuple):
    """The runs of a section, row by row; its arrays are used for one section after the other.

    ends : the column after each run's last one; as many of them as `begin[-1]` count.
    begin (rows + 1,) : the first run of each row, and after the last row how many there are.
    """

    ends: IndexArray
    begin: IndexArray


def room_for_runs(grid: PolarGrid) -> Runs:
    """Room for the runs of any section on `grid`."""
    elements = np.empty(grid.radial * grid.angular, dtype=np.int64)
    return Runs(elements, np.zeros(grid.radial + 1, dtype=np.int64))


@compiled
def find_runs(labels: LabelArray, runs: Runs) -> None:
    """Write the runs of a section with element types `labels` (rows, columns) to `runs`."""
    n = 0
    for i in range(labels.shape[0]):
        runs.begin[i] = n
        n = runs_of_row(labels[i], runs.ends, n)
    runs.begin[labels.shape[0]] = n


@compiled
def runs_of_row(row: LabelArray, ends: IndexArray, n: int) -> int:
    """Write where the runs of a row end to `ends`, from place `n` on; returns the next place."""
    after = row[1:]
    for j in range(after.size):  # without branches: a run's end stays where one was found
        ends[n] = j + 1
        n += row[j] != after[j]
    ends[n] = row.size
    return n + 1
