"""The mixed form's rows and columns: volume change by the nodes, beside the stiffness."""

from __future__ import annotations

from typing import Any

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from beamopt.base.compiled import compiled
from femcheck.assembly.reduction import UpperMatrix

__all__ = ["Saddle", "VolumeColumns", "add_volume_columns"]


@compiled
def add_volume_columns(
    gradients: FloatArray, weights: FloatArray, F: FloatArray, values: FloatArray, out: FloatArray
) -> None:
    """Fill (e, a, 3, c) with ∫ N_c ∂(ln J)/∂x_a: the derivative of ln det F is F⁻ᵀ."""
    elements, points, _, nodes = gradients.shape
    corners = values.shape[1]
    R = np.empty((3, 3))
    for e in range(elements):
        for q in range(points):
            f, g = F[e, q], gradients[e, q]
            for i in range(3):
                j, k = (i + 1) % 3, (i + 2) % 3
                for m in range(3):
                    n, p = (m + 1) % 3, (m + 2) % 3
                    R[i, m] = f[j, n] * f[k, p] - f[j, p] * f[k, n]
            scale = weights[e, q] / (f[0, 0] * R[0, 0] + f[0, 1] * R[0, 1] + f[0, 2] * R[0, 2])
            for a in range(nodes):
                for i in range(3):
                    slope = scale * (R[i, 0] * g[0, a] + R[i, 1] * g[1, a] + R[i, 2] * g[2, a])
                    for c in range(corners):
                        out[e, a, i, c] += slope * values[q, c]


class VolumeColumns:
    """From (e, a, 3, c) of all elements to one sparse matrix, rows by blocks, columns by corners.

    Parameters
    ----------
    blocks : (e, a) block row of each node, −1 where it is held. rows : number of block rows.
    corners : (e, c) column of each corner. columns : number of columns.
    """

    def __init__(self, blocks: IndexArray, rows: int, corners: IndexArray, columns: int) -> None:
        nodes, width = blocks.shape[1], corners.shape[1]
        row = np.repeat(blocks, width, axis=1).ravel()
        column = np.tile(corners, (1, nodes)).ravel()
        keys, place = np.unique(np.where(row < 0, -1, row * columns + column), return_inverse=True)
        held = int(keys[0] == -1)
        keys = keys[held:]
        self._count, self._shape = keys.size, (3 * rows, columns)
        at_block, at_column = keys // columns, keys % columns
        in_row = np.bincount(at_block, minlength=rows)
        self._starts = np.concatenate([[0], np.cumsum(np.repeat(in_row, 3))])
        first = np.concatenate([[0], np.cumsum(in_row)])[at_block]
        offset = 3 * first + np.arange(keys.size) - first
        self._indices = np.empty(3 * keys.size, dtype=np.int64)
        to = np.empty((keys.size, 3), dtype=np.int64)
        for i in range(3):
            to[:, i] = offset + i * in_row[at_block]
            self._indices[to[:, i]] = at_column
        # held entries go to a place behind the last one
        to = np.vstack([to, np.full((1, 3), 3 * keys.size)])
        of_entry = (place.reshape(-1, nodes, width) - held) % (keys.size + 1)
        self._to = to[of_entry].transpose(0, 1, 3, 2).ravel()

    def __call__(self, entries: FloatArray) -> Any:
        """The (3 rows, columns) matrix in compressed rows."""
        from scipy.sparse import csr_array

        size = self._indices.size
        data = np.bincount(self._to, weights=entries.ravel(), minlength=size + 1)[:size]
        return csr_array((data, self._indices, self._starts), shape=self._shape)


class Saddle:
    """Stiffness K, volume columns B and compliance −M as one upper triangle [K B; · −M].

    The patterns of the first call are those of all.
    """

    def __init__(self) -> None:
        self._made: tuple[int, int] | None = None

    def __call__(
        self, stiffness: UpperMatrix, columns: Any, compliance: UpperMatrix
    ) -> UpperMatrix:
        """Put them together; `columns` (unknowns, m) in compressed rows."""
        pattern = (stiffness.data.size, columns.data.size)
        if self._made != pattern:
            self._lay_out(stiffness, columns, compliance)
            self._made = pattern
        data = np.empty(self._indices.size)
        data[self._stiffness_to] = stiffness.data
        data[self._columns_to] = columns.data
        data[data.size - compliance.data.size :] = -compliance.data
        return UpperMatrix(self._starts, self._indices, data)

    def _lay_out(self, stiffness: UpperMatrix, columns: Any, compliance: UpperMatrix) -> None:
        size = stiffness.size
        own, more = np.diff(stiffness.starts), np.diff(columns.indptr)
        before, after = columns.indptr[:-1], stiffness.starts[1:]
        self._stiffness_to = np.arange(stiffness.data.size) + np.repeat(before, own)
        self._columns_to = np.arange(columns.data.size) + np.repeat(after, more)
        upper = np.cumsum(own + more)
        self._starts = np.concatenate([[0], upper, upper[-1] + compliance.starts[1:]])
        self._indices = np.empty(self._starts[-1], dtype=np.int64)
        self._indices[self._stiffness_to] = stiffness.indices
        self._indices[self._columns_to] = columns.indices + size
        self._indices[upper[-1] :] = compliance.indices + size
