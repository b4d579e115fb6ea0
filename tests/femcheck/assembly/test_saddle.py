"""The mixed form's rows and columns against dense sums."""

import numpy as np
import pytest
from scipy.sparse import csr_array, triu

from femcheck.assembly.reduction import UpperMatrix
from femcheck.assembly.saddle import Saddle, VolumeColumns, add_volume_columns

RNG = np.random.default_rng(8)


def test_columns_are_the_derivative_of_the_logarithm_of_the_volume_ratio() -> None:
    """∫ N_c ∂ ln det F/∂x_a by differences of the positions, on made-up gradients."""
    gradients, weights = RNG.normal(size=(2, 3, 3, 5)), RNG.uniform(1, 2, (2, 3))
    values, x, h = RNG.uniform(size=(3, 4)), RNG.normal(size=(2, 5, 3)), 1e-6

    def deformed(x: np.ndarray) -> np.ndarray:
        return np.einsum("eai,eqja->eqij", x, gradients)

    F = deformed(x)
    out = np.zeros((2, 5, 3, 4))
    add_volume_columns(gradients, weights, F, values, out)
    for a in range(5):
        for i in range(3):
            step = np.zeros_like(x)
            step[:, a, i] = h
            up, down = (np.log(np.abs(np.linalg.det(deformed(x + s * step)))) for s in (1, -1))
            slope = np.einsum("eq,eq,qc->ec", weights, (up - down) / (2 * h), values)
            np.testing.assert_allclose(out[:, a, i], slope, rtol=1e-5, atol=1e-7)


@pytest.mark.parametrize("held", [0, 2])
def test_entries_of_all_elements_come_together(held: int) -> None:
    """Rows by blocks, columns by corners; what belongs to held nodes is left out."""
    nodes, corners, rows, columns = 3, 2, 6 - held, 5
    blocks = np.array([RNG.permutation(6)[:nodes] for _ in range(4)]) - held
    blocks[blocks < 0] = -1
    at = np.array([RNG.permutation(columns)[:corners] for _ in range(4)])
    entries = RNG.normal(size=(4, nodes, 3, corners))
    dense = np.zeros((3 * rows, columns))
    for e in range(4):
        for a in range(nodes):
            for c in range(corners):
                if blocks[e, a] >= 0:
                    dense[3 * blocks[e, a] : 3 * blocks[e, a] + 3, at[e, c]] += entries[e, a, :, c]
    collect = VolumeColumns(blocks, rows, at, columns)
    for scale in (1.0, -2.0):
        found = collect(scale * entries)
        assert found.has_sorted_indices
        np.testing.assert_allclose(found.toarray(), scale * dense, atol=1e-14)


def upper(matrix: np.ndarray) -> UpperMatrix:
    kept = triu(csr_array(matrix), format="csr")
    return UpperMatrix(kept.indptr.astype(np.int64), kept.indices.astype(np.int64), kept.data)


def sparse(rows: int, columns: int, rng: np.random.Generator, pattern: np.ndarray) -> np.ndarray:
    return np.where(pattern, rng.normal(size=(rows, columns)), 0.0)


def test_one_upper_triangle() -> None:
    """[K B; · −M], on one pattern with other values, then on another one."""
    saddle = Saddle()
    for size, width in ((7, 4), (5, 3)):
        there = RNG.uniform(size=(size, size)) < 0.4
        there |= there.T | np.eye(size, dtype=bool)
        beside = RNG.uniform(size=(size, width)) < 0.5
        beside[0] = False  # a row of nothing
        for seed in (1, 2):
            rng = np.random.default_rng(seed)
            K, B = sparse(size, size, rng, there), sparse(size, width, rng, beside)
            K, M = K + K.T, np.diag(rng.uniform(1, 2, width)) + 0.1
            found = saddle(upper(K), csr_array(B), upper(M))
            whole = np.block([[K, B], [B.T, -M]])
            np.testing.assert_allclose(found.whole().toarray(), whole, atol=1e-15)
            for row in np.split(found.indices, found.starts[1:-1]):
                assert (np.diff(row) > 0).all()
