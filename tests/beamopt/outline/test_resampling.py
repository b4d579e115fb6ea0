"""Loops resampled to edges that can be meshed."""

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from beamopt.base.arrays import FloatArray
from beamopt.outline.green import loop_integrals as integrals
from beamopt.outline.resampling import resample
from beamopt.outline.ring import arc, circle


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
    out = np.hypot(*points.T) - radius
    assert 0.4 * sagitta < out.min() < out.max() < 0.8 * sagitta  # two thirds of it
    np.testing.assert_allclose(integrals(points)[0], np.pi * radius**2, rtol=1e-10)


@pytest.mark.parametrize("radius", [0.3, 0.5, 1.0])
def test_a_rounded_triangle(radius: float) -> None:
    smooth = lens(radius)
    points = resample(smooth, 0.04)
    found = lengths(points)
    assert off(points, smooth) < 1.06 * 0.04
    assert found.max() <= 4.0
    assert found.min() >= 0.2
    assert len(points) < 60
    beside = shapely.distance(shapely.LinearRing(smooth), shapely.points(points))
    assert beside.max() < 0.04
    np.testing.assert_allclose(integrals(points)[0], integrals(smooth)[0], rtol=1e-12)
    np.testing.assert_allclose(integrals(points)[3:], integrals(smooth)[3:], rtol=3e-4)
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
        assert len(points) >= 12
        assert shapely.Polygon(points).is_valid
        assert integrals(points)[0] == pytest.approx(np.pi * radius**2, rel=1e-9)


def test_a_finer_sagitta_comes_nearer() -> None:
    smooth = lens(0.5)
    away = [off(resample(smooth, s), smooth) for s in (0.04, 0.01, 0.0025)]
    assert away[0] > 2 * away[1] > 4 * away[2]


@given(
    st.lists(st.tuples(st.floats(0.3, 1), st.booleans()), min_size=3, max_size=9),
    st.booleans(),
)
def test_areas_are_exact_and_second_moments_nearly_so(
    spokes: list[tuple[float, bool]], clockwise: bool
) -> None:
    """Corners and bent lines between them, either way round."""
    smooth = blob(spokes)
    points = resample(smooth[::-1] if clockwise else smooth, 0.04)
    wanted, found = integrals(smooth), integrals(points) * (-1 if clockwise else 1)
    assert found[0] == pytest.approx(wanted[0], rel=1e-11)
    np.testing.assert_allclose(found[1:3], wanted[1:3], atol=2e-4 * wanted[0] ** 1.5)
    np.testing.assert_allclose(found[3:], wanted[3:], atol=3e-4 * wanted[0] ** 2)


def blob(spokes: list[tuple[float, bool]]) -> FloatArray:
    """A line [mm] from spoke to spoke about the origin, straight or bent inwards."""
    n = len(spokes)
    share = np.linspace(0, 1, 60, endpoint=False)[:, None]
    loop = []
    for k, (length, bent) in enumerate(spokes):
        ends = [
            9 * r * np.array([np.cos(2 * np.pi * j / n), np.sin(2 * np.pi * j / n)])
            for j, r in ((k, length), (k + 1, spokes[(k + 1) % n][0]))
        ]
        line = ends[0] + share * (ends[1] - ends[0])
        loop.append(line * (1 - 0.4 * bent * share * (1 - share)))
    return np.concatenate(loop)


def test_a_curve_between_two_corners_has_its_area() -> None:
    """However short it is: one straight edge would cut it off."""
    smooth = np.concatenate([arc(10.0, 0.0, 0.08, 1e-6), arc(9.8, 0.08, 0.0, 1e-6)])
    points = resample(smooth, 0.04)
    assert integrals(points)[0] == pytest.approx(0.04 * (10**2 - 9.8**2), rel=1e-9)
    for corner in smooth[[0, -1]]:
        assert np.hypot(*(points - corner).T).min() < 1e-12


@pytest.mark.parametrize("radius", [0.1, 4.5, 250.0])
@pytest.mark.parametrize("sagitta", [1e-5, 1e-3, 0.5])
def test_circles_and_arcs_have_the_area_that_they_stand_for(radius: float, sagitta: float) -> None:
    whole = integrals(circle(radius, sagitta * radius))
    np.testing.assert_allclose(whole[0], np.pi * radius**2, rtol=1e-13)
    np.testing.assert_allclose(whole[3:5], np.pi / 4 * radius**4, rtol=1e-7)
    for angle in (1e-3, 0.3, 3.0, -2.0):
        ends = arc(radius, 0.4, 0.4 + angle, sagitta * radius)
        np.testing.assert_allclose(np.hypot(*ends[[0, -1]].T), radius, rtol=1e-14)
        sector = integrals(np.concatenate([ends, np.zeros((1, 2))]))[0]
        assert sector == pytest.approx(angle / 2 * radius**2, rel=1e-13)
