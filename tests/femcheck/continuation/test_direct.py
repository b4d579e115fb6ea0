"""Direct solvers against dense algebra, on matrices of one pattern and changing values."""

from collections.abc import Callable

import numpy as np
import pytest

from femcheck.assembly.reduction import UpperMatrix
from femcheck.continuation.direct import (
    DirectSolver,
    Pardiso,
    SingularMatrixError,
    SuperLU,
    direct_solver,
)

SIZE = 60


def solvers() -> list[Callable[[], DirectSolver]]:
    try:
        Pardiso()
    except ImportError:
        return [SuperLU]
    return [Pardiso, SuperLU]


@pytest.fixture(params=solvers(), ids=lambda kind: kind.name)
def solver(request: pytest.FixtureRequest) -> DirectSolver:
    return request.param()


def pattern() -> np.ndarray:
    there = np.random.default_rng(1).uniform(size=(SIZE, SIZE)) < 0.1
    return np.triu(there | np.eye(SIZE, dtype=bool))


def upper(matrix: np.ndarray, there: np.ndarray) -> UpperMatrix:
    starts = np.concatenate([[0], np.cumsum(there.sum(axis=1))])
    return UpperMatrix(starts.astype(np.int64), np.nonzero(there)[1], matrix[there])


def indefinite(seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    half = np.where(pattern(), rng.normal(size=(SIZE, SIZE)), 0.0)
    return np.triu(half) + np.triu(half, 1).T


def solution(solver: DirectSolver, matrix: np.ndarray) -> np.ndarray:
    solver.factor(upper(matrix, pattern()))
    return solver.solve(np.ones(SIZE))


def test_whole_is_symmetric() -> None:
    matrix = indefinite(2)
    np.testing.assert_array_equal(upper(matrix, pattern()).whole().toarray(), matrix)


def test_indefinite_matrices_of_one_pattern(solver: DirectSolver) -> None:
    """New values on the same pattern, as Newton has them; several right sides a factorisation."""
    counts = set()
    for seed in range(6):
        matrix = indefinite(seed)
        solver.factor(upper(matrix, pattern()))
        for k in range(2):
            right = np.random.default_rng([seed, k]).normal(size=SIZE)
            kept = right.copy()
            exact = np.linalg.solve(matrix, right)
            np.testing.assert_allclose(solver.solve(right), exact, atol=1e-8 * np.abs(exact).max())
            np.testing.assert_array_equal(right, kept)
        negative = int((np.linalg.eigvalsh(matrix) < 0).sum())
        counts.add(negative)
        if solver.name == "PARDISO":
            assert solver.negative_eigenvalues == negative
        else:
            assert solver.negative_eigenvalues is None
    assert len(counts) > 1
    assert solver.factor_seconds > 0
    assert solver.solve_seconds > 0


def test_another_pattern_is_analysed_again(solver: DirectSolver) -> None:
    for size in (SIZE, 20, SIZE):
        matrix = indefinite(4)[:size, :size]
        solver.factor(upper(matrix, pattern()[:size, :size]))
        right = np.ones(size)
        np.testing.assert_allclose(matrix @ solver.solve(right), right, atol=1e-8)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_entries_that_are_not_finite(solver: DirectSolver, value: float) -> None:
    matrix = indefinite(2)
    matrix[3, 3] = value
    with pytest.raises(SingularMatrixError):
        solution(solver, matrix)
    # and it goes on with the next one
    matrix = indefinite(3)
    np.testing.assert_allclose(matrix @ solution(solver, matrix), 1, atol=1e-8)


def test_singular(solver: DirectSolver) -> None:
    """Nothing holds unknown 7: an empty row that stands in the pattern."""
    matrix = indefinite(2)
    matrix[7], matrix[:, 7] = 0, 0
    with pytest.raises(SingularMatrixError):
        solution(solver, matrix)


def test_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    assert direct_solver("superlu").name == "SuperLU"
    with pytest.raises(ValueError, match="solver = mumps: one of auto, pardiso, superlu"):
        direct_solver("mumps")

    def missing(self: Pardiso) -> None:
        raise ImportError("pypardiso")

    monkeypatch.setattr(Pardiso, "__init__", missing)
    assert direct_solver("auto").name == "SuperLU"
    with pytest.raises(ImportError):
        direct_solver("pardiso")
