"""Feature points with a cell: against exact cells, and against the rule for one place."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from beamopt.outline.cells import _cells
from beamopt.outline.ring import ring_polygon
from beamopt.section.cell_owners import NEAR, cell_owners, distinct, points_with_cells
from beamopt.section.cross_section import CrossSection
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.raster import TIE, raster
from beamopt.section.seal import SealRules

GRIDS = {
    "ring": PolarGrid(),
    "disc": PolarGrid(0.0, 25.0),
    "sector": PolarGrid(start=20.0, stop=200.0),
    "reflex": PolarGrid(start=-10.0, stop=320.0),
    "wedge": PolarGrid(0.0, 25.0, start=0.0, stop=130.0),
    "narrow": PolarGrid(start=10.0, stop=40.0),
}
RULES = SealRules(1.0, 0.9, 0.5, 3.0, True)


def owners(points: FeaturePoints, grid: PolarGrid = GRIDS["ring"]) -> list[int]:
    return [int(k) for k in cell_owners(points.x, points.y, grid.domain)]


@pytest.mark.parametrize("which", list(GRIDS))
def test_owners_are_the_points_whose_cells_meet_the_section(which: str) -> None:
    """Cells as polygons, cut by the ring or sector; those of next to no area may go either way."""
    grid, told_apart = GRIDS[which], 0
    ring = ring_polygon(grid)
    for seed in range(60):
        rng = np.random.default_rng(seed)
        count, scale = int(rng.integers(1, 40)), rng.choice([10, 25, 60, 1000])
        x, y = rng.uniform(-scale, scale, (2, count))
        found = set(owners(FeaturePoints(x, y, np.zeros(count)), grid))
        for k, cell in enumerate(_cells(x, y, 4000.0)):
            area = shapely.Polygon(cell).intersection(ring).area if len(cell) > 2 else 0.0
            if area == 0 or area > 1e-3:
                assert (k in found) == (area > 0)
                told_apart += 1
    assert told_apart > 1000


@given(st.integers(0, 2**32), st.integers(1, 200), st.integers(0, 3))
def test_points_in_one_place_by_comparing_all(seed: int, count: int, digits: int) -> None:
    """In random clusters, and where all are within a few times the nearness that counts."""
    rng = np.random.default_rng(seed)
    spread = 10.0 ** -rng.integers(0, 6, size=count) * (digits < 3)
    x, y = rng.choice([0.0, 12.0, 17.5], (2, count)) + spread * rng.uniform(-1, 1, (2, count))
    x, y = x + rng.uniform(-5, 5, (2, count)) * NEAR * (digits > 1)
    kept: list[int] = []
    for k in range(count):
        if all((x[q] - x[k]) ** 2 + (y[q] - y[k]) ** 2 > TIE for q in kept):
            kept.append(k)
    points = FeaturePoints(x, y, np.zeros(count))
    found = distinct(points)
    np.testing.assert_array_equal(found.x, x[kept])
    np.testing.assert_array_equal(found.y, y[kept])


def test_the_earlier_of_two_points_in_one_place_counts() -> None:
    for off in (0.0, 1e-12, 1e-8, 0.9 * NEAR):
        assert owners(FeaturePoints([15, -15, 15 + off], [1, 0, 1], [0, 1, 2])) == [0, 1]
        assert owners(FeaturePoints([15 + off, -15, 15], [1, 0, 1], [0, 1, 2])) == [0, 1]
    assert owners(FeaturePoints([15, -15, 15 + 1.1 * NEAR], [1, 0, 1], [0, 1, 2])) == [0, 1, 2]


def test_a_row_of_near_points_is_thinned_out() -> None:
    """A point that is in the place of one without a place of its own may have one."""
    x = 15 + 0.7 * NEAR * np.arange(5)
    assert owners(FeaturePoints(x, np.zeros(5), np.zeros(5))) == [0, 2, 4]


@pytest.mark.parametrize("which", list(GRIDS))
def test_some_point_has_a_cell(which: str) -> None:
    for points in (
        FeaturePoints([1e6], [1e6], [1]),
        FeaturePoints([1e6, 1e6], [0.0, 0.0], [1, 2]),
        FeaturePoints([-1e6, 1e6, 0.0], [1e6, 0.0, -1e6], [0, 1, 2]),
        FeaturePoints([0.0], [0.0], [3]),
    ):
        assert owners(points, GRIDS[which])
    assert owners(FeaturePoints([], [], []), GRIDS[which]) == []


def test_a_chamber_behind_material_has_no_wall() -> None:
    """Its point lies outside the ring, and so does its cell; with a thin skin it took 0.3 mm."""
    angle = np.radians(np.arange(0, 360, 3))
    around = np.stack([np.cos(angle), np.sin(angle)])
    inside, beyond = 24.6 * around, 25.15 * around
    types = np.r_[np.ones(120), np.zeros(120)]
    points = FeaturePoints(*np.concatenate([inside, beyond], axis=1), types)
    hidden = FeaturePoints(
        *np.concatenate([inside, beyond, 25.4 * around], axis=1), np.append(types, 120 * [2])
    )
    assert owners(hidden) == list(range(240))
    grid, rules = GRIDS["ring"], SealRules(0.05, 0.9, 0.0)
    expected = CrossSection.from_points(grid, points, 0, rules)
    assert expected.moments.chamber_areas[0] > 1000
    found = CrossSection.from_points(grid, hidden, 0, rules)
    np.testing.assert_array_equal(found.labels, expected.labels)


@given(st.integers(0, 2**32), st.sampled_from(list(GRIDS)))
def test_leaving_out_what_does_not_count_keeps_the_formats_raster(seed: int, which: str) -> None:
    """Types by the nearest of all points, as the format has it, where no two are in one place."""
    rng, grid = np.random.default_rng(seed), GRIDS[which]
    count = int(rng.integers(1, 40))
    x, y = rng.uniform(-60, 60, (2, count))
    points = FeaturePoints(x, y, rng.integers(0, 4, count))
    np.testing.assert_array_equal(
        raster(grid, points_with_cells(grid, points)), raster(grid, points)
    )


def test_a_doubled_material_point_takes_nothing_off_a_chamber() -> None:
    """Eight points: of a twin of supply 2 in a material point's place 4.5 % of a chamber went."""
    grid = GRIDS["ring"]
    angle = np.radians([0, 45, 90, 135, 180, 225, 270, 315])
    x, y = 17.5 * np.stack([np.cos(angle), np.sin(angle)])
    points = FeaturePoints(x, y, [1, 0, 2, 0, 3, 0, 1, 0])
    for at in (1, 3, 5, 7):
        for supply in (1, 2, 3):
            twin = FeaturePoints(
                np.append(x, x[at]), np.append(y, y[at]), np.append(points.type, supply)
            )
            sections = [CrossSection.from_points(grid, each, 0, RULES) for each in (points, twin)]
            np.testing.assert_array_equal(sections[0].labels, sections[1].labels)
