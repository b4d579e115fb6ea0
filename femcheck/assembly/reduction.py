"""From the matrix of all nodes to that of the unknowns: a rigid plate's nodes become six."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from femcheck.assembly.pattern import Pattern

__all__ = ["Reduction", "UpperMatrix"]

PLATE = 6


@dataclass(frozen=True, eq=False)
class UpperMatrix:
    """The upper triangle of a symmetric matrix in compressed rows, columns ascending."""

    starts: IndexArray
    indices: IndexArray
    data: FloatArray

    @property
    def size(self) -> int:
        """Rows of the matrix."""
        return self.starts.size - 1

    def whole(self) -> Any:
        """The full symmetric matrix as scipy's CSR."""
        from scipy.sparse import csr_array, triu

        shape = (self.size, self.size)
        upper = csr_array((self.data, self.indices, self.starts), shape=shape)
        return (upper + triu(upper, k=1).T).tocsr()


class Reduction:
    """TᵀKT for nodes of which the last ones move as a plate; the pattern is made once.

    Parameters
    ----------
    pattern : of the matrix of all nodes that are not held, the plate's after the free ones.
    free : number of free nodes.
    """

    def __init__(self, pattern: Pattern, free: int) -> None:
        rows = np.repeat(np.arange(pattern.size), np.diff(pattern.starts))
        columns, n = pattern.indices, 3 * free
        self._n, self._plate = n, pattern.size - n
        self._in_free = np.flatnonzero((rows < n) & (columns < n))
        self._across = np.flatnonzero((rows < n) & (columns >= n))
        self._in_plate = np.flatnonzero(rows >= n)
        self._across_at = rows[self._across], columns[self._across] - n
        self._plate_at = rows[self._in_plate] - n, columns[self._in_plate] - n
        coupled = np.unique(self._across_at[0])
        self._coupled = coupled
        lengths = np.bincount(rows[self._in_free], minlength=n)
        lengths[coupled] += PLATE
        corner = np.arange(PLATE, 0, -1)
        self.starts = np.concatenate([[0], np.cumsum(np.concatenate([lengths, corner]))])
        self.indices = np.empty(self.starts[-1], dtype=np.int64)
        before = np.concatenate([[0], np.cumsum(np.bincount(rows[self._in_free], minlength=n))])
        within = np.arange(self._in_free.size) - before[rows[self._in_free]]
        self._free_to = self.starts[rows[self._in_free]] + within
        self.indices[self._free_to] = columns[self._in_free]
        ends = self.starts[coupled + 1][:, None]
        self._plate_to = ends - PLATE + np.arange(PLATE)
        self.indices[self._plate_to] = n + np.arange(PLATE)
        self._corner = np.triu_indices(PLATE)
        self.indices[self.starts[n] :] = n + self._corner[1]

    def __call__(self, data: FloatArray, modes: FloatArray, plate: FloatArray) -> UpperMatrix:
        """Reduce.

        Parameters
        ----------
        data : of the pattern.
        modes : (3 m, 6) motion of the plate's nodes by its six unknowns.
        plate : (6, 6) to be added to the plate's own block.
        """
        from scipy.sparse import csr_array

        shape = (self._n, self._plate)
        across = csr_array((data[self._across], self._across_at), shape=shape)
        upper = csr_array((data[self._in_plate], self._plate_at), shape=(self._plate, self._plate))
        half = modes.T @ (upper @ modes)
        diagonal = modes.T @ (upper.diagonal()[:, None] * modes)
        out = np.empty(self.indices.size)
        out[self._free_to] = data[self._in_free]
        out[self._plate_to] = np.asarray(across @ modes)[self._coupled]
        out[self.starts[self._n] :] = (half + half.T - diagonal + plate)[self._corner]
        return UpperMatrix(self.starts, self.indices, out)
