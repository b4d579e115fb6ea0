"""Drawn chambers as polygons against the rule by which they are rasterised."""

import numpy as np
import pytest
import shapely
from hypothesis import assume, given
from hypothesis import strategies as st

from beamopt.outline.drawn import drawn_regions
from beamopt.section.drawing import Circle, RingPiece, Shape

SAGITTA = 1e-5


def region(shapes: list[Shape], supply: int = 1) -> shapely.Geometry:
    return drawn_regions(shapes, SAGITTA)[supply - 1]


@given(
    st.floats(0, 20),
    st.floats(0.5, 20),
    st.floats(-400, 400),
    st.floats(1, 359.9),
    st.floats(0, 1),
    st.integers(0, 10_000),
)
def test_a_ring_piece_covers_what_its_raster_covers(
    inner: float, wide: float, first: float, span: float, share: float, seed: int
) -> None:
    r, phi = (inner, inner + wide), (first, first + span)
    half = np.radians(span) / 2
    most = wide / 2
    if half < np.pi / 2:
        most = min(most, inner * np.sin(half) / (1 - np.sin(half)) * 0.999)
    assume(most >= 0)
    piece = RingPiece(1, r, phi, share * most)
    polygon = region([piece])
    assert polygon.is_valid
    x, y = np.random.default_rng(seed).uniform(-r[1], r[1], (2, 500))
    clear = shapely.distance(polygon.boundary, shapely.points(x, y)) > 2 * SAGITTA
    inside = shapely.contains_xy(polygon, x, y)
    np.testing.assert_array_equal(inside[clear], piece.covers(x, y)[clear])


def test_areas_in_closed_form() -> None:
    assert region([RingPiece(1, (13, 22), (0, 80))]).area == pytest.approx(
        np.radians(80) / 2 * (22**2 - 13**2), abs=1e-3
    )
    assert region([RingPiece(1, (13, 22), (0, 360))]).area == pytest.approx(
        np.pi * (22**2 - 13**2), abs=1e-3
    )
    assert region([Circle(1, (3, 4), 5)]).area == pytest.approx(25 * np.pi, abs=1e-3)


def test_a_later_shape_covers_an_earlier_one() -> None:
    shapes: list[Shape] = [Circle(1, (0, 0), 5), Circle(2, (0, 0), 3), Circle(1, (0, 0), 1)]
    assert region(shapes).area == pytest.approx(np.pi * (25 - 9 + 1), abs=1e-3)
    assert region(shapes, 2).area == pytest.approx(np.pi * (9 - 1), abs=1e-3)
    assert region(shapes, 3).is_empty
