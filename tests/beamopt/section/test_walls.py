"""Walls against the distance of every element from every other."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beamopt.base.arrays import LabelArray
from beamopt.section.seal import UNSEALED, SealRules
from beamopt.section.walls import add_walls, wall_steps


def by_all_distances(labels: LabelArray, steps: int, periodic: bool) -> LabelArray:
    """Chambers keep the elements farther than `steps` (rows plus columns) from other supplies."""
    rows, columns = labels.shape
    down = np.abs(np.subtract.outer(np.arange(rows), np.arange(rows)))
    across = np.abs(np.subtract.outer(np.arange(columns), np.arange(columns)))
    if periodic:
        across = np.minimum(across, columns - across)
    near = down[:, None, :, None] + across[None, :, None, :] <= steps
    walled = labels.copy()
    for supply in (1, 2, 3):
        others = (labels != 0) & (labels != supply)
        reached = (near & others).any(axis=(2, 3))
        walled[(labels == supply) & reached] = 0
    return walled


def walled(labels: LabelArray, steps: int, periodic: bool) -> LabelArray:
    result = labels.copy()
    add_walls(result, steps, periodic)
    return result


def halves(rows: int, columns: int) -> LabelArray:
    """Supply 1 in the first half of the columns, 2 in the second."""
    labels = np.ones((rows, columns), dtype=np.uint8)
    labels[:, columns // 2 :] = 2
    return labels


@pytest.mark.parametrize("periodic", [True, False], ids=["ring", "sector"])
@pytest.mark.parametrize("steps", [0, 1, 2, 3])
@pytest.mark.parametrize("shape", [(1, 1), (1, 2), (2, 1), (1, 9), (9, 1), (3, 4), (14, 19)])
def test_random_labels(shape: tuple[int, int], steps: int, periodic: bool) -> None:
    rng = np.random.default_rng([*shape, steps, periodic])
    for material in (0.0, 0.5, 0.9):
        kinds = rng.choice(4, size=shape, p=[material] + [(1 - material) / 3] * 3)
        labels = kinds.astype(np.uint8)
        expected = by_all_distances(labels, steps, periodic)
        np.testing.assert_array_equal(walled(labels, steps, periodic), expected)


@given(
    st.integers(0, 2**32), st.integers(1, 6), st.integers(1, 6), st.integers(0, 4), st.booleans()
)
def test_any_blocks(seed: int, rows: int, columns: int, steps: int, periodic: bool) -> None:
    """Blocks of 3 × 3 elements, so that chambers survive; steps may exceed the grid."""
    blocks = np.random.default_rng(seed).integers(4, size=(rows, columns)).astype(np.uint8)
    labels = np.kron(blocks, np.ones((3, 3), dtype=np.uint8))
    expected = by_all_distances(labels, steps, periodic)
    np.testing.assert_array_equal(walled(labels, steps, periodic), expected)


def test_walls_between_half_rings_are_four_elements_thick() -> None:
    material = (walled(halves(6, 40), 2, True) == 0).all(axis=0)
    np.testing.assert_array_equal(np.flatnonzero(material), [0, 1, 18, 19, 20, 21, 38, 39])


def test_the_ends_of_a_sector_are_no_neighbours() -> None:
    material = (walled(halves(6, 40), 2, False) == 0).all(axis=0)
    np.testing.assert_array_equal(np.flatnonzero(material), [18, 19, 20, 21])


def test_no_steps_no_walls() -> None:
    np.testing.assert_array_equal(walled(halves(4, 10), 0, True), halves(4, 10))


@pytest.mark.parametrize("supply", [1, 2, 3])
def test_a_chamber_alone_is_left_as_it_is(supply: int) -> None:
    """Neither material nor the ring's surfaces ask for a wall."""
    labels = np.zeros((8, 20), dtype=np.uint8)
    labels[:, 3:9] = supply  # from the inner to the outer surface
    labels[2:4, 12:15] = supply  # another one of the same supply
    np.testing.assert_array_equal(walled(labels, 3, True), labels)


def test_chambers_that_thick_material_parts_are_left_as_they_are() -> None:
    labels = np.zeros((5, 20), dtype=np.uint8)
    labels[:, 2:6], labels[:, 9:13] = 1, 2  # three columns of material between them
    np.testing.assert_array_equal(walled(labels, 3, True), labels)
    labels[:, 6] = 1  # now two
    assert (walled(labels, 3, True)[:, [6, 9]] == 0).all()


def test_a_wall_round_a_corner_has_diamond_ends() -> None:
    """One element of supply 2 takes from supply 1 what is two 4-neighbour steps away."""
    labels = np.ones((9, 9), dtype=np.uint8)
    labels[4, 4] = 2
    i, j = np.indices(labels.shape)
    expected = np.abs(i - 4) + np.abs(j - 4) > 2
    np.testing.assert_array_equal(walled(labels, 2, False), expected.astype(np.uint8))


def test_half_of_a_wall_lies_to_each_side_unless_the_section_is_sealed() -> None:
    assert [wall_steps(elements, UNSEALED) for elements in (0, 2, 4, 64)] == [0, 1, 2, 32]
    assert wall_steps(4, SealRules(skin=1.0, wall=1.0)) == 0
    for odd in (-2, 1, 3):
        with pytest.raises(ValueError, match="wall_elements"):
            wall_steps(odd, UNSEALED)
