"""Walls of material between chambers of different supplies (paper, Voronoi tessellation)."""

from __future__ import annotations

import numpy as np

from beamopt.compiled import compiled
from beamopt.section.raster import LabelArray

__all__ = ["add_walls"]


@compiled
def add_walls(labels: LabelArray, steps: int, periodic: bool) -> None:
    """Turn chamber elements within `steps` of another supply's into material, in place.

    A step goes to one of the four neighbours, across the ends of the columns only where
    `periodic`; a wall is thus 2·`steps` elements thick. Elements next to material, or to the
    ring's inner and outer surface, are left as they are.
    """
    rows, columns = labels.shape
    width = columns + 2 * steps
    here = np.zeros((rows, width), dtype=np.uint8)
    there = np.zeros((rows, width), dtype=np.uint8)
    bit = np.array([0, 1, 2, 4], dtype=np.uint8)  # one bit a supply: neighbours merge by "or"
    for i in range(rows):
        for j in range(columns):
            here[i, steps + j] = bit[labels[i, j]]
        if periodic:
            for j in range(steps):
                here[i, j] = bit[labels[i, (j - steps) % columns]]
                here[i, steps + columns + j] = bit[labels[i, j % columns]]
    for _ in range(steps):
        for i in range(rows):
            row, up, down = here[i], here[max(i - 1, 0)], here[min(i + 1, rows - 1)]
            reached = there[i]
            for j in range(1, width - 1):
                reached[j] = row[j] | up[j] | down[j] | row[j - 1] | row[j + 1]
            reached[0] = row[0]
            reached[width - 1] = row[width - 1]
        here, there = there, here
    for i in range(rows):
        for j in range(columns):
            own = labels[i, j]
            others = here[i, steps + j] & ~bit[own]
            labels[i, j] = np.uint8(0) if others != 0 else own
