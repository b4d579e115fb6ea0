"""Rays find thin material, and only that."""

import numpy as np
import pytest
import shapely

from beamopt.base.arrays import FloatArray
from beamopt.outline.rays import thin_places
from beamopt.outline.smoothing import loops_of


def thinnest(*chambers: shapely.Polygon, below: float = 0.9) -> tuple[float, FloatArray]:
    loops = [loop for chamber in chambers for loop in loops_of(chamber)]
    thin = thin_places(loops, below, 0.1, 0.7)
    if not thin.thickness.size:
        return np.inf, np.zeros(2)
    k = np.argmin(thin.thickness)
    return float(thin.thickness[k]), thin.middle[k]


@pytest.mark.parametrize("gap", [0.003, 0.1, 0.45, 0.7, 0.88])
def test_two_circles(gap: float) -> None:
    """The rays nearest to the neck miss it by a spacing at most: a few thousandths of a mm."""
    circle = shapely.Point(0, 0).buffer(2, quad_segs=16)
    other = shapely.Point(4 + gap, 0).buffer(2, quad_segs=16)
    found, where = thinnest(circle, other)
    assert found == pytest.approx(gap, abs=2e-3)
    np.testing.assert_allclose(where, [2 + gap / 2, 0], atol=0.06)


def test_two_sharp_corners() -> None:
    """No edge's normal meets the other corner: a fan of rays does."""
    one = shapely.Polygon([(0, 0), (-3, 2), (-3, -2)])
    two = shapely.Polygon([(0.5, 0), (3.5, -2), (3.5, 2)])
    assert thinnest(one, two)[0] == pytest.approx(0.5, abs=0.02)


def test_two_sharp_corners_of_one_chamber() -> None:
    """Their sides do not face each other, but are far apart along the loop."""
    one = shapely.Polygon([(0, 0), (-3, 2), (-3, -2)])
    two = shapely.Polygon([(0.5, 0), (3.5, -2), (3.5, 2)])
    frame = [shapely.box(-3.5, -6, -3, 2), shapely.box(3.5, -6, 4, 2), shapely.box(-3.5, -6, 4, -5)]
    chamber = shapely.union_all([one, two, *frame])
    found, where = thinnest(chamber)
    assert found == pytest.approx(0.5, abs=0.02)
    np.testing.assert_allclose(where, [0.25, 0], atol=0.02)


def test_a_neck_within_one_chamber() -> None:
    """A ring that does not quite close, at its ends and nowhere else."""
    ring = shapely.Point(0, 0).buffer(6, quad_segs=64) - shapely.Point(0, 0).buffer(3, quad_segs=64)
    for gap in (0.3, 0.8):
        found, where = thinnest(ring - shapely.box(0, -gap / 2, 9, gap / 2))
        assert found == pytest.approx(gap, abs=1e-6)
        assert 3 < where[0] < 6
        assert where[1] == pytest.approx(0, abs=1e-6)
    assert thinnest(ring - shapely.box(0, -0.46, 9, 0.46))[0] == np.inf


def test_a_peninsula() -> None:
    """Material that reaches 3 mm into a chamber, 0.6 mm wide."""
    chamber = shapely.box(0, 0, 10, 8) - shapely.box(4, 5, 4.6, 8)
    assert thinnest(chamber)[0] == pytest.approx(0.6)


def test_an_island_in_a_chamber() -> None:
    island = shapely.box(4, 3, 4.6, 6)
    assert thinnest(shapely.box(0, 0, 10, 8) - island)[0] == pytest.approx(0.6)


def test_narrow_chambers_and_corners_of_material_are_no_thin_material() -> None:
    assert thinnest(shapely.box(0, 0, 10, 0.2))[0] == np.inf
    wedge = shapely.box(0, 0, 10, 8) - shapely.Polygon([(4, 8), (5, 4), (8, 8)])
    assert thinnest(wedge)[0] == np.inf


def test_nothing_to_look_at() -> None:
    assert thinnest()[0] == np.inf
