"""Walls of material between chambers of different supplies (paper, Voronoi tessellation)."""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import LabelArray
from beamopt.base.compiled import compiled
from beamopt.section.seal import SealRules

__all__ = ["add_walls", "wall_steps"]


def wall_steps(wall_elements: int, rules: SealRules) -> int:
    """Elements of a wall that lie to each side of a boundary: half of them; none if sealed.

    Raises
    ------
    ValueError : not an even number from 0 on.
    """
    if wall_elements < 0 or wall_elements % 2:
        raise ValueError(f"wall_elements = {wall_elements}: must be 0, 2, 4, …")
    return 0 if rules.sealed else wall_elements // 2


@compiled
def add_walls(labels: LabelArray, steps: int, periodic: bool) -> None:
    """Turn chamber elements within `steps` of another supply's into material, in place.

    A step goes to one of the four neighbours, across the ends of the columns only where
    `periodic`; a wall is thus 2·`steps` elements thick. Elements next to material, or to the
    ring's inner and outer surface, are left as they are.
    """
    rows, columns = labels.shape
    supplies = np.zeros((rows, columns + 2 * steps), dtype=np.uint8)
    _as_bits(labels, steps, periodic, supplies)
    reached = supplies.copy()
    spread = np.empty_like(supplies)
    for _ in range(steps):
        _spread(reached, spread)
        reached, spread = spread, reached
    for i in range(rows):
        row = labels[i]
        own, near = supplies[i, steps : steps + columns], reached[i, steps : steps + columns]
        for j in range(columns):
            row[j] = row[j] if near[j] == own[j] else np.uint8(0)


@compiled
def _as_bits(labels: LabelArray, pad: int, periodic: bool, bits: LabelArray) -> None:
    """One bit a supply (0, 1, 2, 4), so that neighbours merge by "or"; columns padded round."""
    columns = labels.shape[1]
    for i in range(labels.shape[0]):
        row, out = labels[i], bits[i, pad : pad + columns]
        for j in range(columns):
            out[j] = row[j] + (row[j] == 3)
        if periodic:
            for j in range(pad):
                bits[i, j] = out[(j - pad) % columns]
                bits[i, pad + columns + j] = out[j % columns]


@compiled
def _spread(bits: LabelArray, out: LabelArray) -> None:
    """Each element gets its own bits and those of its four neighbours."""
    rows, width = bits.shape
    for i in range(rows):
        row, up, down = bits[i], bits[max(i - 1, 0)], bits[min(i + 1, rows - 1)]
        to = out[i]
        for j in range(1, width - 1):
            to[j] = row[j] | up[j] | down[j] | row[j - 1] | row[j + 1]
        to[0] = row[0]
        to[width - 1] = row[width - 1]
