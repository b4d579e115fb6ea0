"""Direct solvers for symmetric indefinite matrices: PARDISO if it installs, else SuperLU."""

from __future__ import annotations

import sys
import time
from typing import Any, Protocol

import numpy as np

from beamopt.base.arrays import FloatArray
from femcheck.assembly.reduction import UpperMatrix

__all__ = ["DirectSolver", "Pardiso", "SingularMatrixError", "SuperLU", "direct_solver"]


class SingularMatrixError(ArithmeticError):
    """The matrix could not be factored, or its solution is not finite."""


class DirectSolver(Protocol):
    """Factor once, solve often; all matrices of a solver have one pattern."""

    name: str
    factor_seconds: float
    solve_seconds: float

    def factor(self, matrix: UpperMatrix) -> None:
        """Factor, or raise `SingularMatrixError`."""
        ...

    def solve(self, right: FloatArray) -> FloatArray:
        """Solution of the last factored system; raises `SingularMatrixError`."""
        ...

    @property
    def negative_eigenvalues(self) -> int | None:
        """Negative eigenvalues of the last factored matrix; None where the solver can not tell."""
        ...


def direct_solver(name: str = "auto") -> DirectSolver:
    """PARDISO if it is installed and `name` allows it, else SuperLU.

    Raises
    ------
    ValueError : `name` is not "auto", "pardiso" or "superlu".
    ImportError : PARDISO was asked for by name and is not installed.
    """
    if name not in ("auto", "pardiso", "superlu"):
        raise ValueError(f"solver = {name}: one of auto, pardiso, superlu")
    if name == "superlu":
        return SuperLU()
    try:
        return Pardiso()
    except ImportError:
        if name == "pardiso":
            raise
        return SuperLU()


class Pardiso:
    """MKL's PARDISO on the upper triangle, symmetric indefinite, one symbolic analysis."""

    name = "PARDISO"

    def __init__(self) -> None:
        from pypardiso.pardiso_wrapper import PyPardisoError, PyPardisoSolver

        self._failure = PyPardisoError
        self._solver: Any = PyPardisoSolver(mtype=-2)
        for place, value in ((1, 1), (2, 2), (8, 0), (10, 8), (11, 0), (13, 0), (21, 1)):
            # own settings; nested dissection; refinement; pivots of 1e-8; no scaling or matching by
            # values, so that the analysis does not depend on which case comes first
            self._solver.set_iparm(place, value)
        self._analysed: tuple[int, int] | None = None
        self._matrix: Any = None
        self.factor_seconds = self.solve_seconds = 0.0

    def factor(self, matrix: UpperMatrix) -> None:
        """Factor, or raise `SingularMatrixError`."""
        from scipy.sparse import csr_matrix

        began = time.process_time()
        _check_finite(matrix)
        pattern = (matrix.size, matrix.indices.size)
        shape = (matrix.size, matrix.size)
        self._matrix = csr_matrix((matrix.data, matrix.indices, matrix.starts), shape=shape)
        self._call(22 if self._analysed == pattern else 12, np.zeros((matrix.size, 1)))
        self._analysed = pattern
        if self._solver.get_iparm(14) > 0:  # it goes on with a small number in the pivot's place
            raise SingularMatrixError("a pivot vanished")
        self.factor_seconds += time.process_time() - began

    def solve(self, right: FloatArray) -> FloatArray:
        """Solution of the last factored system; raises `SingularMatrixError`."""
        began = time.process_time()
        result = self._call(33, np.asfortranarray(right))
        self.solve_seconds += time.process_time() - began
        if not np.isfinite(result).all():
            raise SingularMatrixError("the solution is not finite")
        return result

    def _call(self, phase: int, right: FloatArray) -> FloatArray:
        self._solver.set_phase(phase)
        try:
            return np.asarray(self._solver._call_pardiso(self._matrix, right))
        except self._failure as error:
            raise SingularMatrixError(str(error)) from None

    @property
    def negative_eigenvalues(self) -> int | None:
        """Negative eigenvalues of the last factored matrix."""
        return int(self._solver.get_iparm(23))

    def __del__(self) -> None:
        if getattr(self, "_matrix", None) is not None and not sys.is_finalizing():
            self._solver.free_memory(everything=True)


class SuperLU:
    """scipy's SuperLU on the whole matrix; slower, and it can not count eigenvalues."""

    name = "SuperLU"

    def __init__(self) -> None:
        self._factors: Any = None
        self.factor_seconds = self.solve_seconds = 0.0

    def factor(self, matrix: UpperMatrix) -> None:
        """Factor, or raise `SingularMatrixError`."""
        from scipy.sparse.linalg import splu

        began = time.process_time()
        _check_finite(matrix)
        try:
            self._factors = splu(
                matrix.whole().tocsc(),
                permc_spec="MMD_AT_PLUS_A",
                diag_pivot_thresh=0.01,
                options={"SymmetricMode": True},
            )
        except (RuntimeError, MemoryError) as error:
            raise SingularMatrixError(str(error) or "not enough memory") from None
        self.factor_seconds += time.process_time() - began

    def solve(self, right: FloatArray) -> FloatArray:
        """Solution of the last factored system; raises `SingularMatrixError`."""
        began = time.process_time()
        result = np.asarray(self._factors.solve(np.ascontiguousarray(right)))
        self.solve_seconds += time.process_time() - began
        if not np.isfinite(result).all():
            raise SingularMatrixError("the solution is not finite")
        return result

    @property
    def negative_eigenvalues(self) -> int | None:
        """Not known."""
        return None


def _check_finite(matrix: UpperMatrix) -> None:
    if not np.isfinite(matrix.data).all():
        raise SingularMatrixError("the matrix has entries that are not finite")
