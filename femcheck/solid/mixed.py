"""The hydrostatic pressure of the mixed form: linear on each element, continuous."""

from __future__ import annotations

from typing import Any

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from femcheck.assembly.reduction import UpperMatrix
from femcheck.assembly.saddle import VolumeColumns, add_volume_columns
from femcheck.solid.continuum import Continuum

__all__ = ["Mixed"]


class Mixed:
    """∫ p ln J − p²/(2Λ) dV with p given at the corners of a body.

    Parameters
    ----------
    body : of an element with a stable pair.
    blocks : (n,) block row of each node; −1 for a node that is held.
    compliance : 1/Λ [1/kPa], 0 for an incompressible material.

    Raises
    ------
    ValueError : an element without a stable pair.
    """

    def __init__(self, body: Continuum, blocks: IndexArray, compliance: float) -> None:
        if not body.has_pair:
            raise ValueError("element: has no stable pair for a law in mixed form")
        self._body = body
        self._values = body.corner_values
        self._size = body.corner_nodes.size
        rows = int(blocks.max()) + 1
        self._columns = VolumeColumns(blocks[body.connectivity], rows, body.corners, self._size)
        self._mass = self._masses()
        self._scale = compliance

    def at_points(self, hydrostatic: FloatArray) -> FloatArray:
        """(e, q) [kPa]."""
        return np.asarray(hydrostatic[self._body.corners] @ self._values.T)

    def density(self, hydrostatic: FloatArray, log_J: FloatArray) -> FloatArray:
        """(e, q) p ln J − p²/(2Λ) [kPa]."""
        p = self.at_points(hydrostatic)
        return np.asarray(p * log_J - self._scale / 2 * p**2)

    def forces(self, hydrostatic: FloatArray, log_J: FloatArray) -> FloatArray:
        """(m,) ∫ N (ln J − p/Λ) dV [mm³]."""
        gap = self._body.weights * (log_J - self._scale * self.at_points(hydrostatic))
        at, by_corner = self._body.corners.ravel(), (gap @ self._values).ravel()
        return np.asarray(np.bincount(at, by_corner, self._size), dtype=np.float64)

    def columns(self, F: FloatArray) -> Any:
        """(3 moving nodes, m) derivative of the nodal forces by the pressures [mm²]."""
        body = self._body
        nodes, corners = body.connectivity.shape[1], self._values.shape[1]
        entries = np.zeros((len(body.connectivity), nodes, 3, corners))
        add_volume_columns(body.gradients, body.weights, F, self._values, entries)
        return self._columns(entries)

    @property
    def compliance(self) -> UpperMatrix:
        """The upper triangle of ∫ N Nᵀ/Λ dV [mm³/kPa]."""
        mass = self._mass
        return UpperMatrix(mass.starts, mass.indices, self._scale * mass.data)

    def _masses(self) -> UpperMatrix:
        """The upper triangle of ∫ N Nᵀ dV [mm³]; its diagonal stands even where it is multiplied
        by nothing, as direct solvers want it."""
        from scipy.sparse import coo_array, triu

        corners, values = self._body.corners, self._values
        entries = np.einsum("eq,qc,qd->ecd", self._body.weights, values, values, optimize=True)
        width = corners.shape[1]
        at = (np.repeat(corners, width, axis=1).ravel(), np.tile(corners, (1, width)).ravel())
        whole = coo_array((entries.ravel(), at), shape=(self._size, self._size))
        upper = triu(whole.tocsr(), format="csr")
        upper.sort_indices()
        indices = (upper.indptr.astype(np.int64), upper.indices.astype(np.int64))
        return UpperMatrix(*indices, upper.data)
