"""Voronoi regions against nearest points and against the raster."""

import numpy as np
import pytest
import shapely

from beamopt.outline.cells import regions, territories
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.moments import moments_of
from beamopt.section.raster import raster
from tests.beamopt.outline.hostile import POINTS, RING, random_points

EXTENT = 100.0


def types_at(points: FeaturePoints, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """(n,) type of the nearest point, and −1 within 10⁻⁴ mm² of a tie."""
    squared = (x[:, None] - points.x) ** 2 + (y[:, None] - points.y) ** 2
    nearest = points.type[np.argmin(squared, axis=1)].astype(int)
    other = np.where(points.type == nearest[:, None], np.inf, squared).min(axis=1)
    return np.where(other - squared.min(axis=1) < 1e-4, -1, nearest)


@pytest.mark.parametrize(
    "name", [name for name in POINTS if name not in ("none", "two in one place")]
)
def test_every_place_is_its_nearest_points(name: str) -> None:
    points = POINTS[name]
    rng = np.random.default_rng(0)
    x, y = rng.uniform(-30, 30, (2, 3000))
    expected = types_at(points, x, y)
    for supply, region in enumerate(regions(points, EXTENT), 1):
        inside = shapely.contains_xy(region, x, y)
        clear = expected >= 0
        np.testing.assert_array_equal(inside[clear], expected[clear] == supply)


@pytest.mark.parametrize("name", list(POINTS))
def test_regions_share_nothing_and_lie_within_territories(name: str) -> None:
    points = POINTS[name]
    own, ground = regions(points, EXTENT), territories(points, EXTENT)
    for k in range(3):
        assert own[k].is_valid
        assert own[k].difference(ground[k]).area < 1e-3
        for j in range(k):
            assert own[k].intersection(own[j]).area < 1e-3
            assert ground[k].intersection(ground[j]).area < 1e-3
    if (points.type > 0).any():
        assert sum(part.area for part in ground) == pytest.approx((2 * EXTENT) ** 2, rel=1e-6)


def test_no_slits_between_cells_of_one_supply() -> None:
    """Cells are clipped one by one; their union must not keep hairs between them."""
    for count in (30, 100, 300):
        points = random_points(RING, count, count)
        for part in territories(points.with_types(np.ones(count, dtype=np.uint8)), EXTENT)[:1]:
            assert part.geom_type == "Polygon"
            assert not part.interiors
            assert len(part.exterior.coords) < 10 + count


def test_moments_of_a_fine_raster() -> None:
    grid = PolarGrid(radial=1000, angular=3000)
    points = random_points(RING, 60, 4)
    ring = shapely.Point(0, 0).buffer(25, quad_segs=500)
    ring = ring.difference(shapely.Point(0, 0).buffer(10, quad_segs=500))
    expected = moments_of(grid, raster(grid, points)).raw[1:, 0]
    found = [region.intersection(ring).area for region in regions(points, EXTENT)]
    np.testing.assert_allclose(found, expected, atol=0.05)


def test_of_coincident_points_the_first_counts() -> None:
    for first, second in ((1, 2), (2, 1), (0, 3)):
        areas = [r.area for r in regions(FeaturePoints([5, 5], [1, 1], [first, second]), EXTENT)]
        expected = [(2 * EXTENT) ** 2 if k + 1 == first else 0 for k in range(3)]
        np.testing.assert_allclose(areas, expected)


def test_two_points_share_a_plane_by_their_bisector() -> None:
    one, two, _ = regions(FeaturePoints([-10, 30], [0, 0], [1, 2]), EXTENT)
    assert one.bounds == (-100, -100, 10, 100)
    assert two.bounds == (10, -100, 100, 100)


def test_points_beyond_reckoning_are_refused() -> None:
    with pytest.raises(ValueError, match="at most 1e\\+08 mm"):
        regions(FeaturePoints([0, 2e8], [0, 0], [1, 2]), EXTENT)
