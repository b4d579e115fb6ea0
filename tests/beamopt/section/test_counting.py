"""What is counted in the compiled loops, against counting one section by itself."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beamopt.base.arrays import LabelArray
from beamopt.section.counting import count_chambers
from beamopt.section.cross_section import CrossSection
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.phenotype import phenotypes
from beamopt.section.pieces import count_pieces
from beamopt.section.runs import find_runs, room_for_runs
from beamopt.section.seal import UNSEALED, SealRules
from beamopt.section.symmetry import threefold_symmetry

RING = PolarGrid(radial=24, angular=60)
SECTOR = PolarGrid(radial=12, angular=20, start=30.0, stop=150.0)
SEALED = SealRules(1.0, 0.9, 0.5, 3.0, True)


def counted(grid: PolarGrid, labels: LabelArray) -> tuple[int, ...]:
    runs, counts = room_for_runs(grid), np.zeros(3, dtype=np.int64)
    find_runs(labels, runs)
    count_chambers(labels, runs, grid.is_full_ring, counts)
    return tuple(counts.tolist())


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
    assert counted(grid, labels) == count_pieces(grid, labels).chambers


@given(st.integers(0, 2**32), st.sampled_from([RING, SECTOR]), st.booleans())
def test_random_sections(seed: int, grid: PolarGrid, sealed: bool) -> None:
    rules = SEALED if sealed else UNSEALED
    rng = np.random.default_rng(seed)
    sets = [FeaturePoints.random(grid, n, rng) for n in (40, 1, 0, 9)]
    found = phenotypes(grid, sets, 2, rules, count_chambers=True)
    expected = [CrossSection.from_points(grid, p, 2, rules).pieces.chambers for p in sets]
    assert found.chambers.tolist() == [list(one) for one in expected]


@pytest.mark.parametrize("rules", [UNSEALED, SEALED], ids=["plain", "sealed"])
def test_counting_changes_nothing_else(rules: SealRules) -> None:
    sets = [FeaturePoints.random(RING, n, np.random.default_rng(n)) for n in (40, 9)]
    plain = phenotypes(RING, sets, 2, rules)
    counting = phenotypes(RING, sets, 2, rules, False, True, threefold_symmetry(RING))
    np.testing.assert_array_equal(counting.moments.raw, plain.moments.raw)
    np.testing.assert_array_equal(counting.neighbour_ratio, plain.neighbour_ratio)
    assert plain.chambers.shape == (0, 3)
    assert plain.asymmetry.shape == (0,)
    assert counting.chambers.shape == (2, 3)
    assert counting.asymmetry.shape == (2,)
