"""The upper triangle of the tangent as one sparse pattern, made once for a body."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import IndexArray

__all__ = ["Pattern", "make_pattern", "places_in"]


@dataclass(frozen=True, eq=False)
class Pattern:
    """Compressed rows of a symmetric matrix of 3 × 3 blocks, of which the upper triangle is kept.

    Entry (3A + i, 3B + j), A ≤ B, stands at `starts[3A + i] + 3 k − i + j` where k is the place of
    block B among row A's blocks.

    Parameters
    ----------
    blocks : (n,) block row of each node; −1 for a node that is held.
    first : (rows + 1,) first block of each block row. columns : block columns, ascending.
    starts : (3 rows + 1,) and indices : the scalar pattern.
    """

    blocks: IndexArray
    first: IndexArray
    columns: IndexArray
    starts: IndexArray
    indices: IndexArray

    @property
    def size(self) -> int:
        """Rows of the matrix."""
        return self.starts.size - 1


def make_pattern(connectivity: IndexArray, blocks: IndexArray) -> Pattern:
    """The pattern of elements with nodes `connectivity` (e, a), rows ordered by `blocks` (n,).

    Raises
    ------
    ValueError : a row that belongs to no element.
    """
    from scipy.sparse import coo_array

    rows = int(blocks.max()) + 1
    at = blocks[connectivity]
    nodes = at.shape[1]
    A, B = np.repeat(at, nodes, axis=1).ravel(), np.tile(at, (1, nodes)).ravel()
    kept = (A >= 0) & (A <= B)
    graph = coo_array((np.ones(kept.sum()), (A[kept], B[kept])), shape=(rows, rows)).tocsr()
    graph.sort_indices()
    first, columns = graph.indptr.astype(np.int64), graph.indices.astype(np.int64)
    in_row = np.diff(first)
    if not in_row.all():
        raise ValueError("blocks: a row that belongs to no element")
    lengths = (3 * in_row)[:, None] - np.arange(3)
    starts = np.concatenate([[0], np.cumsum(lengths.ravel())])
    indices = np.empty(starts[-1], dtype=np.int64)
    row_of = np.repeat(np.arange(rows), in_row)
    place = np.arange(columns.size) - first[row_of]
    for i in range(3):
        for j in range(3):
            there = (place > 0) | (j >= i)
            at_ = starts[3 * row_of + i] + 3 * place - i + j
            indices[at_[there]] = 3 * columns[there] + j
    return Pattern(blocks, first, columns, starts, indices)


def places_in(pattern: Pattern, connectivity: IndexArray) -> NDArray[np.int32]:
    """(e, a, a) place k of block (a, b) in a's row, where a ≤ b and both are free; else 0.

    Raises
    ------
    ValueError : a pair of nodes that the pattern has no block for.
    """
    at = pattern.blocks[connectivity]
    rows = pattern.first.size - 1
    keys = np.repeat(np.arange(rows), np.diff(pattern.first)) * rows + pattern.columns
    A, B = at[:, :, None], at[:, None, :]
    kept = (A >= 0) & (A <= B)
    wanted = np.where(kept, A * rows + B, keys[0])
    found = np.minimum(np.searchsorted(keys, wanted), keys.size - 1)
    if not (keys[found] == wanted).all():
        raise ValueError("connectivity: a pair of nodes outside the pattern")
    place = found - pattern.first[np.maximum(A, 0)]
    return np.where(kept, place, 0).astype(np.int32)
