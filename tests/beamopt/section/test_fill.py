"""Filling against connected components found by scipy."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, label

from beamopt.base.arrays import LabelArray
from beamopt.section.fill import fill_islands, fill_small_chambers


def pieces(mask: NDArray[np.bool_], periodic: bool) -> list[NDArray[np.bool_]]:
    """Connected pieces over the four neighbours, found on three turns of the ring."""
    if not periodic:
        marks, count = label(mask)
        return [marks == k + 1 for k in range(count)]
    columns = mask.shape[1]
    marks, _ = label(np.tile(mask, 5))
    found: dict[bytes, NDArray[np.bool_]] = {}
    for mark in np.unique(marks[:, 2 * columns : 3 * columns]):
        if mark:
            piece = (marks == mark).reshape(mask.shape[0], 5, columns).any(axis=1)
            found[piece.tobytes()] = piece
    return list(found.values())


def around(piece: NDArray[np.bool_], labels: LabelArray, periodic: bool) -> set[int]:
    if periodic:
        grown = binary_dilation(np.tile(piece, 3))[:, piece.shape[1] : 2 * piece.shape[1]]
    else:
        grown = binary_dilation(piece)
    return set(labels[grown & ~piece].tolist())


@st.composite
def blocks(draw: st.DrawFn) -> LabelArray:
    rows, columns = draw(st.integers(1, 9)), draw(st.integers(1, 12))
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    share = draw(st.sampled_from([0.2, 0.5, 0.8]))
    kinds = rng.choice(
        4, size=(rows, columns), p=[share, 0.7 * (1 - share), *[0.15 * (1 - share)] * 2]
    )
    return kinds.astype(np.uint8)


@given(blocks(), st.booleans(), st.integers(1, 9))
def test_small_chambers_become_material(labels: LabelArray, periodic: bool, least: int) -> None:
    expected = labels.copy()
    for supply in (1, 2, 3):
        for piece in pieces(labels == supply, periodic):
            if piece.sum() < least:
                expected[piece] = 0
    found = labels.copy()
    fill_small_chambers(found, periodic, float(least))
    np.testing.assert_array_equal(found, expected)


@given(blocks(), st.booleans(), st.booleans())
def test_islands_become_chamber(labels: LabelArray, periodic: bool, has_hole: bool) -> None:
    surface = np.zeros(labels.shape, dtype=np.bool_)
    surface[-1] = True
    surface[0] |= has_hole
    if not periodic:
        surface[:, [0, -1]] = True
    parts = pieces(labels == 0, periodic)
    most = max((part.sum() for part in parts), default=0)
    found = labels.copy()
    fill_islands(found, periodic, has_hole)
    changed = found != labels
    for part in parts:
        beside = around(part, labels, periodic)
        if (part & surface).any() or len(beside) != 1:
            assert not (changed & part).any()
        elif part.sum() < most:
            assert (found[part] == beside.pop()).all()
    largest = [part for part in parts if part.sum() == most]
    assert not parts or any(not (changed & part).any() for part in largest)
    assert (found[labels > 0] == labels[labels > 0]).all()


@pytest.mark.parametrize("shift", [0, 3, 9])
def test_an_island_across_the_start(shift: int) -> None:
    labels = np.zeros((9, 14), dtype=np.uint8)
    labels[2:7, 2:10] = 2
    labels[4, 4:7] = 0
    expected = labels.copy()
    expected[4, 4:7] = 2
    rolled = np.roll(labels, shift, axis=1)
    fill_islands(rolled, True, True)
    np.testing.assert_array_equal(rolled, np.roll(expected, shift, axis=1))


def test_a_wall_around_another_supply_is_no_island() -> None:
    labels = np.zeros((9, 14), dtype=np.uint8)
    labels[1:8, 1:12] = 2
    labels[3:6, 4:9] = 0
    labels[4, 5:8] = 1
    kept = labels.copy()
    fill_islands(labels, True, True)
    np.testing.assert_array_equal(labels, kept)


def test_material_cut_in_two_tubes_stays() -> None:
    labels = np.zeros((9, 14), dtype=np.uint8)
    labels[2:6] = 1
    kept = labels.copy()
    fill_islands(labels, True, True)
    np.testing.assert_array_equal(labels, kept)
    fill_islands(labels, True, False)  # around an axis, the inner one would hang on to nothing
    np.testing.assert_array_equal(labels[:2], 1)
