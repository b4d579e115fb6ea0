"""Loops resampled to edges that can be meshed."""

import numpy as np
import pytest
import shapely

from beamopt.arrays import FloatArray
from beamopt.outline.resampling import resample
from beamopt.outline.ring import circle


def lengths(points: FloatArray) -> FloatArray:
    return np.asarray(np.hypot(*(np.roll(points, -1, axis=0) - points).T))


def off(points: FloatArray, smooth: FloatArray) -> float:
    """Farthest that the smooth loop is from the resampled one [mm]."""
    ring = shapely.LinearRing(points)
    dense = shapely.segmentize(shapely.LinearRing(smooth), 0.01)
    return float(shapely.distance(ring, shapely.points(shapely.get_coordinates(dense))).max())


def lens(radius: float) -> FloatArray:
    """A rounded triangle of sides of some 9 mm."""
    shape = shapely.Polygon([(0, 0), (10, 0), (4, 8)]).buffer(-radius).buffer(radius, quad_segs=16)
    return shapely.get_coordinates(shapely.orient_polygons(shape))[:-1]


@pytest.mark.parametrize("radius", [10.0, 25.0])
@pytest.mark.parametrize("sagitta", [0.02, 0.04])
def test_a_circle_gets_equal_edges(radius: float, sagitta: float) -> None:
    """Edges are √(8 R s) long, within what the measured curvature is off."""
    smooth = circle(radius, 5e-4)
    points = resample(smooth, sagitta)
    found = lengths(points)
    assert np.ptp(found) < 0.15 * found.mean()
    assert found.mean() == pytest.approx(np.sqrt(8 * radius * sagitta), rel=0.15)
    assert off(points, smooth) < 1.06 * sagitta
    np.testing.assert_allclose(np.hypot(*points.T), radius, atol=6e-4)


@pytest.mark.parametrize("radius", [0.3, 0.5, 1.0])
def test_a_rounded_triangle(radius: float) -> None:
    smooth = lens(radius)
    points = resample(smooth, 0.04)
    found = lengths(points)
    assert off(points, smooth) < 1.06 * 0.04
    assert found.max() <= 4.0
    assert found.min() >= 0.2
    assert len(points) < 60
    on_curve = shapely.distance(shapely.LinearRing(smooth), shapely.points(points))
    assert on_curve.max() < 1e-9
    assert shapely.Polygon(points).is_valid
    ratio = found / np.roll(found, 1)
    assert max(ratio.max(), 1 / ratio.min()) < 6.0  # an edge grows by twice the way to the next


def test_corners_stay() -> None:
    square = np.array([[0.0, 0.0], [9.0, 0.0], [9.0, 9.0], [0.0, 9.0]])
    points = resample(square, 0.04)
    for corner in square:
        assert np.hypot(*(points - corner).T).min() == pytest.approx(0, abs=1e-12)
    assert lengths(points).max() <= 4.0
    assert len(points) == 12


def test_crumbs_are_no_corners() -> None:
    square = np.array(
        [[0.0, 0.0], [9.0, 0.0], [9.0, 9.0], [4.0, 9.0], [4.0, 9.0 + 1e-4], [0.0, 9.0]]
    )
    assert lengths(resample(square, 0.04)).min() > 0.12


def test_small_loops_stay_loops() -> None:
    for radius in (1e-3, 0.02, 0.1):
        points = resample(circle(radius, 1e-6), 0.04)
        assert len(points) >= 6
        assert shapely.Polygon(points).is_valid


def test_a_finer_sagitta_comes_nearer() -> None:
    smooth = lens(0.5)
    areas = [shapely.Polygon(resample(smooth, s)).area for s in (0.04, 0.01, 0.0025)]
    missing = shapely.Polygon(smooth).area - np.array(areas)
    assert (missing > 0).all()
    assert missing[0] > 2 * missing[1] > 4 * missing[2]
