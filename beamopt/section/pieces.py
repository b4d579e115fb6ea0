"""Connected pieces of a section: islands of material, separate chambers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import LabelArray
from beamopt.section.feature_points import MATERIAL, SUPPLIES
from beamopt.section.grid import PolarGrid

__all__ = ["Pieces", "count_pieces"]


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
    counts = [_connected(labels == kind, grid.is_full_ring) for kind in (MATERIAL, *SUPPLIES)]
    return Pieces(counts[0], (counts[1], counts[2], counts[3]))


def _connected(mask: NDArray[np.bool_], periodic: bool) -> int:
    from scipy.ndimage import label
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    pieces, count = label(mask)
    if not periodic or count == 0:
        return int(count)
    first, last = pieces[:, 0], pieces[:, -1]
    joined = (first > 0) & (last > 0)
    pairs = (np.ones(joined.sum()), (first[joined] - 1, last[joined] - 1))
    graph = coo_array(pairs, shape=(count, count))
    joined_count, _ = connected_components(graph, directed=False)
    return int(joined_count)
