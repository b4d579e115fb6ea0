"""The tiled search for the nearest point against all distances."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beamopt.base.arrays import LabelArray
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.raster import TIE, raster

GRIDS = {
    "paper": PolarGrid(),
    "one-tile": PolarGrid(radial=16, angular=8),
    "part-of-a-tile": PolarGrid(radial=5, angular=9),
    "odd": PolarGrid(radial=37, angular=101),
    "one-row": PolarGrid(radial=1, angular=50),
    "one-column": PolarGrid(radial=50, angular=1, stop=30.0),
    "sector": PolarGrid(radial=33, angular=25, start=-20.0, stop=100.0),
    "disc": PolarGrid(0.0, 25.0, 19, 40),
    "sector-of-a-disc": PolarGrid(0.0, 5.0, 33, 17, 90.0, 270.0),
}
SMALL = [grid for name, grid in GRIDS.items() if name != "paper"]


def by_all_distances(grid: PolarGrid, points: FeaturePoints) -> LabelArray:
    """Go through the points in order; one takes over where it is nearer by more than TIE."""
    x, y = grid.centroids
    best = np.full(grid.shape, np.inf)
    labels = np.zeros(grid.shape, dtype=np.uint8)
    for u, v, kind in zip(points.x, points.y, points.type, strict=True):
        squared = (x - u) ** 2 + (y - v) ** 2
        nearer = squared < best - TIE
        best[nearer] = squared[nearer]
        labels[nearer] = kind
    return labels


def scattered(
    rng: np.random.Generator, count: int, spread: float, at: tuple[float, float] = (0, 0)
) -> FeaturePoints:
    x, y = rng.normal(size=(2, count)) * spread + np.array(at)[:, None]
    return FeaturePoints(x, y, rng.integers(4, size=count))


@pytest.mark.parametrize("grid", GRIDS.values(), ids=GRIDS)
@pytest.mark.parametrize("count", [1, 2, 3, 20, 150])
def test_random_points(grid: PolarGrid, count: int) -> None:
    rng = np.random.default_rng([1, grid.radial, grid.angular, count])
    for _ in range(4):
        points = FeaturePoints.random(grid, count, rng)
        np.testing.assert_array_equal(raster(grid, points), by_all_distances(grid, points))


@pytest.mark.parametrize("grid", GRIDS.values(), ids=GRIDS)
@pytest.mark.parametrize(
    ("spread", "at"),
    [(15.0, (0, 0)), (1e4, (0, 0)), (1.0, (5e3, -2e3)), (0.1, (12, 10)), (1e-5, (3, -14))],
    ids=["around", "far-and-wide", "far-on-one-side", "clustered", "within-the-tie"],
)
def test_points_anywhere(grid: PolarGrid, spread: float, at: tuple[float, float]) -> None:
    rng = np.random.default_rng([2, grid.radial, grid.angular])
    for count in (2, 5, 60):
        points = scattered(rng, count, spread, at)
        np.testing.assert_array_equal(raster(grid, points), by_all_distances(grid, points))


def test_one_cluster_and_far_points() -> None:
    grid = GRIDS["odd"]
    rng = np.random.default_rng(3)
    near, far = scattered(rng, 40, 0.5, (0, 15)), scattered(rng, 40, 300.0)
    everything = np.ones(40, dtype=np.bool_)
    points = near.taking(everything, far, everything)
    np.testing.assert_array_equal(raster(grid, points), by_all_distances(grid, points))


@given(st.sampled_from(SMALL), st.integers(0, 2**32), st.integers(1, 40), st.booleans())
def test_any_points_on_centroids(grid: PolarGrid, seed: int, count: int, mirrored: bool) -> None:
    """Centroids, and their mirror images: elements equally far from two points are common."""
    points = FeaturePoints.random(grid, count, np.random.default_rng(seed))
    if mirrored:
        kinds = (points.type + 1) % 4
        points = FeaturePoints(
            np.append(points.x, points.x), np.append(points.y, -points.y), np.append(kinds, kinds)
        )
    np.testing.assert_array_equal(raster(grid, points), by_all_distances(grid, points))


@pytest.mark.parametrize("first", [0, 1])
def test_a_tie_goes_to_the_lowest_index(first: int) -> None:
    """Two points in one row, an odd number of columns apart: the columns between are as far."""
    grid = PolarGrid(radial=40, angular=90)
    x, y = grid.centroids[:, 20, [10, 14]]
    order = [first, 1 - first]
    labels = raster(grid, FeaturePoints(x[order], y[order], np.array([1, 2])[order]))
    assert (labels[:, 12] == 1 + first).all()  # all of the column, not a scatter
    assert (labels[:, 57] == 1 + first).all()  # and the one opposite
    assert (labels[:, 11] == 1).all()
    assert (labels[:, 13] == 2).all()


def test_the_earlier_of_two_coincident_points_counts() -> None:
    grid = PolarGrid(radial=12, angular=20)
    x, y = grid.centroids[:, 3, 5]
    labels = raster(grid, FeaturePoints([x, x], [y, y], [2, 3]))
    assert (labels == 2).all()
    # the difference of positions is below the tolerance: still the same place
    labels = raster(grid, FeaturePoints([x + 1e-12, x], [y, y], [3, 2]))
    assert (labels == 3).all()


@pytest.mark.parametrize("grid", GRIDS.values(), ids=GRIDS)
def test_without_points_all_is_material(grid: PolarGrid) -> None:
    labels = raster(grid, FeaturePoints([], [], []))
    assert labels.shape == grid.shape
    assert labels.dtype == np.uint8
    assert not labels.any()


@pytest.mark.parametrize("kind", [0, 1, 2, 3])
def test_points_of_one_type_fill_the_section(kind: int) -> None:
    grid = GRIDS["odd"]
    x, y = FeaturePoints.random(grid, 30, np.random.default_rng(5)).x, np.zeros(30)
    assert (raster(grid, FeaturePoints(x, y, np.full(30, kind))) == kind).all()


def test_a_point_on_each_centroid_is_found_again() -> None:
    grid = PolarGrid(radial=21, angular=43)
    kinds = np.random.default_rng(6).integers(4, size=grid.shape)
    x, y = grid.centroids
    np.testing.assert_array_equal(raster(grid, FeaturePoints(x, y, kinds)), kinds)


def test_a_tie_in_a_tile_of_one_element() -> None:
    grid = PolarGrid(radial=1, angular=1, stop=90)
    x, y = grid.centroids[:, 0, 0]
    points = FeaturePoints([x + 3e-5, x], [y, y], [1, 2])  # 9e-10 mm² apart: a tie
    assert raster(grid, points)[0, 0] == 1
