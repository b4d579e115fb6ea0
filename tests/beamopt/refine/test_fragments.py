"""What fragments know of a section, against its raster with walls."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from beamopt.base.arrays import FloatArray, LabelArray
from beamopt.refine.fragments import Fragments, fragments_of, kinds_of, moments_of_kinds, retype
from beamopt.section.cross_section import CrossSection
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.seal import SealRules
from beamopt.section.symmetry import mirror_symmetry, threefold_symmetry
from tests.beamopt.refine.cases import judge_of, points_of, random_points, scattered

GRIDS = {
    "ring": PolarGrid(radial=32, angular=90),
    "disc": PolarGrid(0.0, 25.0, 24, 60),
    "sector": PolarGrid(10.0, 25.0, 32, 60, 20.0, 160.0),
    "few elements": PolarGrid(10.0, 25.0, 4, 8),
}


def rounding(grid: PolarGrid) -> FloatArray:
    """(6,) 10⁻¹² of what the ring's integrals could be."""
    return 1e-12 * grid.area * grid.outer_radius ** np.array([0, 1, 1, 2, 2, 2])


def assert_same(grid: PolarGrid, raw: FloatArray, points: FeaturePoints, walls: int) -> None:
    expected = CrossSection.from_points(grid, points, walls).moments.raw
    assert (np.abs(raw - expected) <= rounding(grid)).all()


def flipped(
    fragments: Fragments, points: FeaturePoints, count: int, seed: int
) -> tuple[LabelArray, LabelArray, FloatArray]:
    """Types, kinds and moments after `count` random flips, brought up to date at each."""
    rng = np.random.default_rng(seed)
    types = points.type.copy()
    kinds = kinds_of(fragments, types)
    raw = moments_of_kinds(fragments, kinds)
    which, news = rng.integers(0, len(points), count), rng.integers(0, 4, count)
    for point, new in zip(which.tolist(), news.tolist(), strict=True):
        types[point] = new
        retype(fragments, types, kinds, raw, point)
    return types, kinds, raw


@settings(max_examples=4)
@pytest.mark.parametrize("walls", [0, 2, 4, 8])
@pytest.mark.parametrize("name", list(GRIDS))
@given(seed=st.integers(0, 10_000))
def test_flips_come_to_the_full_raster(name: str, walls: int, seed: int) -> None:
    grid = GRIDS[name]
    points = scattered(grid, 1 + seed % 40, seed)
    fragments = fragments_of(grid, points, walls)
    kinds = kinds_of(fragments, points.type)
    assert_same(grid, moments_of_kinds(fragments, kinds), points, walls)
    types, kinds, raw = flipped(fragments, points, 300, seed)
    np.testing.assert_array_equal(kinds, kinds_of(fragments, types))
    assert_same(grid, raw, points.with_types(types), walls)


@pytest.mark.parametrize("make", [mirror_symmetry, lambda: threefold_symmetry(GRIDS["ring"])])
def test_symmetric_sections(make) -> None:  # type: ignore[no-untyped-def]
    grid = GRIDS["ring"]
    points = make().symmetrised(FeaturePoints.random(grid, 40, np.random.default_rng(3)))
    fragments = fragments_of(grid, points, 4)
    types, _, raw = flipped(fragments, points, 300, 3)
    assert_same(grid, raw, points.with_types(types), 4)


def test_twins() -> None:
    """Of two points in one place the earlier has the cell; the other's type says nothing."""
    points = points_of((15, 0, 1), (15, 0, 2), (-15, 2, 3), (-15, 2, 1), (0, 17, 2))
    fragments = fragments_of(GRIDS["ring"], points, 4)
    for seed in range(20):
        types, _, raw = flipped(fragments, points, 50, seed)
        assert_same(GRIDS["ring"], raw, points.with_types(types), 4)


def test_walls_that_reach_everywhere() -> None:
    """More neighbours in reach than there is room for at first."""
    points = scattered(GRIDS["ring"], 120, 1)
    fragments = fragments_of(GRIDS["ring"], points, 64)
    assert fragments.others.shape[1] > 12
    types, _, raw = flipped(fragments, points, 300, 1)
    assert_same(GRIDS["ring"], raw, points.with_types(types), 64)


def test_without_points_there_are_no_fragments() -> None:
    fragments = fragments_of(GRIDS["ring"], FeaturePoints([], [], []), 4)
    assert fragments.owner.size == 0
    np.testing.assert_array_equal(fragments.begin, [0])


def test_as_the_judge_measures() -> None:
    judge = judge_of()
    for seed in range(5):
        points = random_points(seed)
        fragments = fragments_of(judge.grid, points, judge.wall_elements, judge.rules)
        raw = moments_of_kinds(fragments, kinds_of(fragments, points.type))
        measured = judge.measured([points]).moments.raw[0]
        assert (np.abs(raw - measured) <= rounding(judge.grid)).all()


def test_rounding_does_not_gather_over_many_flips() -> None:
    """10⁵ flips, each adding to the last: still 10⁻¹² of the ring's integrals."""
    grid = GRIDS["ring"]
    points = scattered(grid, 40, 9)
    fragments = fragments_of(grid, points, 4)
    types, _, raw = flipped(fragments, points, 100_000, 9)
    assert_same(grid, raw, points.with_types(types), 4)


def test_a_flip_looks_at_nothing_but_its_own_fragments() -> None:
    """Every fragment that a point owns, or stands near, is listed once."""
    fragments = fragments_of(GRIDS["ring"], scattered(GRIDS["ring"], 30, 2), 4)
    for point in range(30):
        own = fragments.touched[fragments.begin[point] : fragments.begin[point + 1]]
        near = (fragments.owner == point) | (fragments.others == point).any(axis=1)
        np.testing.assert_array_equal(np.sort(own), np.flatnonzero(near))


def test_a_seals_skins_are_left_out() -> None:
    """Rows whose middle is within the skin are in no fragment; walls are half a wall wide."""
    grid, rules = PolarGrid(radial=64, angular=180), SealRules(1.0, 1.2, 0.5)
    points = points_of((15, 0, 1), (-15, 0, 2))
    fragments = fragments_of(grid, points, 0, rules)
    raw = moments_of_kinds(fragments, kinds_of(fragments, points.type))
    inside = np.pi * (24.0**2 - 11.0**2)
    assert raw[:, 0].sum() == pytest.approx(inside, rel=0.03)
    # the wall along x = 0: two pieces of 13 mm, 1.2 mm wide
    assert raw[0, 0] == pytest.approx(2 * 13 * 1.2, rel=0.1)


def test_a_seals_fragments_are_near_to_the_sealed_section() -> None:
    """Of the large chambers; what is left out is a few per cent of the ring."""
    judge = judge_of("sealed-section", "grid.radial=64", "grid.angular=180")
    for seed in range(3):
        points = random_points(seed, "sealed-section", "section.feature_points=25")
        fragments = fragments_of(judge.grid, points, judge.wall_elements, judge.rules)
        raw = moments_of_kinds(fragments, kinds_of(fragments, points.type))
        measured = judge.measured([points]).moments.raw[0]
        assert np.abs(raw - measured)[1:, 0].max() < 0.06 * judge.grid.area
