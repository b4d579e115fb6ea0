"""A batch of sections measured in one go: the very numbers of one by one."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beamopt.section.cross_section import CrossSection
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.neighbours import neighbour_edges
from beamopt.section.phenotype import phenotypes

GRIDS = {
    "paper": PolarGrid(),
    "odd": PolarGrid(radial=17, angular=31),
    "sector": PolarGrid(radial=12, angular=20, start=30.0, stop=150.0),
}


def candidates(grid: PolarGrid, seed: int) -> list[FeaturePoints]:
    """Sets of many sizes, an empty one and coincident points among them."""
    rng = np.random.default_rng(seed)
    sets = [FeaturePoints.random(grid, n, rng) for n in (30, 1, 0, 2, 3, 100, 7)]
    twice = np.ones(30, dtype=np.bool_)
    return [*sets, sets[0].taking(twice, sets[0], twice)]


def ratio(points: FeaturePoints) -> float:
    """Edges between different types over edges between equal ones; at least one of the latter."""
    edges = neighbour_edges(points)
    different = int((points.type[edges[:, 0]] != points.type[edges[:, 1]]).sum())
    return different / max(len(edges) - different, 1)


@pytest.mark.parametrize("grid", GRIDS.values(), ids=GRIDS)
@pytest.mark.parametrize("wall_elements", [0, 4])
def test_a_batch_equals_one_by_one(grid: PolarGrid, wall_elements: int) -> None:
    sets = candidates(grid, 1)
    found = phenotypes(grid, sets, wall_elements)
    one_by_one = [CrossSection.from_points(grid, p, wall_elements).moments.raw for p in sets]
    np.testing.assert_array_equal(found.moments.raw, one_by_one)  # bit for bit
    np.testing.assert_array_equal(found.neighbour_ratio, [ratio(p) for p in sets])


@given(st.integers(0, 2**32))
def test_a_candidate_does_not_depend_on_the_others(seed: int) -> None:
    grid = GRIDS["odd"]
    sets = candidates(grid, seed)
    order = np.random.default_rng(seed).permutation(len(sets))[:5]
    everyone = phenotypes(grid, sets, 2)
    some = phenotypes(grid, [sets[k] for k in order], 2)
    np.testing.assert_array_equal(some.moments.raw, everyone.moments.raw[order])
    np.testing.assert_array_equal(some.neighbour_ratio, everyone.neighbour_ratio[order])


def test_the_order_of_generic_points_does_not_matter() -> None:
    """No two points equally far from a centroid, no four on a circle: nothing to choose."""
    grid = GRIDS["odd"]
    rng = np.random.default_rng(2)
    x, y = rng.uniform(-25, 25, size=(2, 40))
    kind, order = rng.integers(4, size=40), rng.permutation(40)
    sets = [FeaturePoints(x, y, kind), FeaturePoints(x[order], y[order], kind[order])]
    found = phenotypes(grid, sets, 4)
    np.testing.assert_array_equal(found.moments.raw[0], found.moments.raw[1])
    assert found.neighbour_ratio[0] == found.neighbour_ratio[1]


def test_no_candidates() -> None:
    found = phenotypes(GRIDS["odd"], [], 4)
    assert found.moments.raw.shape == (0, 4, 6)
    assert found.neighbour_ratio.shape == (0,)


def test_points_of_one_type_have_ratio_zero() -> None:
    grid = GRIDS["odd"]
    points = FeaturePoints.random(grid, 20, np.random.default_rng(3))
    equal = points.with_types(np.zeros(20, dtype=np.uint8))
    assert phenotypes(grid, [equal], 4).neighbour_ratio[0] == 0


@pytest.mark.parametrize("wall_elements", [3, -2])
def test_walls_that_can_not_be_halved(wall_elements: int) -> None:
    grid = PolarGrid(radial=4, angular=8)
    with pytest.raises(ValueError, match="must be 0, 2, 4"):
        phenotypes(grid, [FeaturePoints([15.0], [0.0], [0])], wall_elements)
