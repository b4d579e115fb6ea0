"""Connected pieces against a flood fill."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beamopt.base.arrays import LabelArray
from beamopt.section.grid import PolarGrid
from beamopt.section.pieces import Pieces, count_pieces

RING = PolarGrid(radial=6, angular=12)
SECTOR = PolarGrid(radial=6, angular=12, stop=120.0)


def by_flood_fill(grid: PolarGrid, labels: LabelArray) -> Pieces:
    counts = [0, 0, 0, 0]
    left = set(np.ndindex(labels.shape))
    while left:
        start = left.pop()
        counts[labels[start]] += 1
        todo = [start]
        while todo:
            i, j = todo.pop()
            for k, m in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)):
                there = (k, m % grid.angular) if grid.is_full_ring else (k, m)
                if there in left and labels[there] == labels[start]:
                    left.remove(there)
                    todo.append(there)
    return Pieces(counts[0], (counts[1], counts[2], counts[3]))


@pytest.fixture
def labels() -> LabelArray:
    return np.zeros(RING.shape, dtype=np.uint8)


@given(
    st.integers(0, 2**32),
    st.integers(1, 8),
    st.integers(1, 13),
    st.sampled_from([90.0, 360.0]),
    st.integers(1, 3),
)
def test_any_labels(seed: int, rows: int, columns: int, stop: float, kinds: int) -> None:
    grid = PolarGrid(radial=rows, angular=columns, stop=stop)
    labels = np.random.default_rng(seed).integers(kinds + 1, size=grid.shape).astype(np.uint8)
    assert count_pieces(grid, labels) == by_flood_fill(grid, labels)


@pytest.mark.parametrize("grid", [RING, SECTOR], ids=["ring", "sector"])
def test_material_alone_is_one_piece(grid: PolarGrid, labels: LabelArray) -> None:
    pieces = count_pieces(grid, labels)
    assert pieces == Pieces(1, (0, 0, 0))
    assert pieces.islands == 0


def test_without_material_there_are_no_islands(labels: LabelArray) -> None:
    labels[:] = 2
    pieces = count_pieces(RING, labels)
    assert pieces == Pieces(0, (0, 1, 0))
    assert pieces.islands == 0


def test_material_inside_a_chamber_is_an_island(labels: LabelArray) -> None:
    labels[1:5, 2:8] = 1
    labels[2:4, 4:6] = 0
    assert count_pieces(RING, labels).islands == 1
    labels[2:4, 4:6] = 3  # a chamber inside a chamber is none
    assert count_pieces(RING, labels) == Pieces(1, (1, 0, 1))


def test_a_chamber_through_the_ring_cuts_a_sector_in_two(labels: LabelArray) -> None:
    labels[:, 4:6] = 1
    assert count_pieces(RING, labels).islands == 0
    assert count_pieces(SECTOR, labels).islands == 1


def test_a_chamber_all_round_leaves_two_tubes(labels: LabelArray) -> None:
    labels[2:4, :] = 1
    assert count_pieces(RING, labels).islands == 1


def test_pieces_go_on_across_the_seam(labels: LabelArray) -> None:
    labels[1:3, :2] = labels[1:3, -2:] = 3
    assert count_pieces(RING, labels).chambers == (0, 0, 1)
    assert count_pieces(SECTOR, labels).chambers == (0, 0, 2)


def test_a_fork_across_the_seam_is_one_piece(labels: LabelArray) -> None:
    """Three prongs meet one handle: they are joined by the other side only."""
    labels[[0, 2, 4], :3] = 1
    labels[:5, -1] = 1
    assert count_pieces(RING, labels).chambers == (1, 0, 0)
    assert count_pieces(SECTOR, labels).chambers == (4, 0, 0)


def test_corners_do_not_join(labels: LabelArray) -> None:
    labels[1, 3] = labels[2, 4] = 2
    labels[4, 0] = labels[5, -1] = 1
    assert count_pieces(RING, labels).chambers == (2, 2, 0)
