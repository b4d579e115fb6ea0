"""Drawn chambers as polygons against the rule by which they are rasterised."""

from dataclasses import replace
from itertools import zip_longest

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from beamopt.outline.build import build_outline
from beamopt.outline.drawn import drawn_regions
from beamopt.outline.faults import Fault, FaultKind
from beamopt.outline.outline import Outline
from beamopt.rod.arc import arc_tips
from beamopt.rod.response import linear_response
from beamopt.section.cross_section import CrossSection
from beamopt.section.drawing import Circle, RingPiece, Shape
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.phenotype import phenotypes
from beamopt.section.seal import UNSEALED, SealRules

SAGITTA = 1e-5
SEALED = SealRules(1.0, 0.9, 0.5, 3.0)
PRESSURES = np.array([[20.0, 0, 0], [0, 10, 30]])


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


@st.composite
def shapes_in_a_ring(draw: st.DrawFn) -> Shape:
    """A ring piece or a circle, most of them within 10…25 mm; radii and angles often alike."""
    supply = draw(st.integers(1, 3))
    if draw(st.booleans()):
        r = draw(st.sampled_from([(13.0, 22.0), (13.0, 18.0), (10.0, 25.0), (12.3, 20.1)]))
        first = draw(st.sampled_from([0.0, 40.0, 80.0, 200.0, -33.3]))
        span = draw(st.sampled_from([40.0, 80.0, 117.9, 360.0]))
        corner = draw(st.sampled_from([0.0, 1.0]))
        return RingPiece(supply, r, (first, first + span), corner)
    angle = np.radians(draw(st.integers(0, 359)))
    place = (float(17.5 * np.cos(angle)), float(17.5 * np.sin(angle)))
    return Circle(supply, place, draw(st.sampled_from([2.0, 4.5, 9.0])))


@st.composite
def drawings_with_a_hidden_piece(draw: st.DrawFn) -> tuple[list[Shape], list[Shape]]:
    """A drawing, and the same with one more piece under a later one, or under two of them."""
    shapes = draw(st.lists(shapes_in_a_ring(), min_size=1, max_size=5))
    over = draw(st.integers(0, len(shapes) - 1))
    host, supply = shapes[over], draw(st.integers(1, 3))
    cover: list[Shape] = [host]
    if isinstance(host, Circle):
        share = draw(st.sampled_from([1.0, 0.999, 0.5]))
        r, turn = host.radius, np.radians(draw(st.integers(0, 359)))
        x, y = host.center  # inside it, and touching its rim
        inner = (1 - share) * r
        place = (float(x + inner * np.cos(turn)), float(y + inner * np.sin(turn)))
        piece: Shape = Circle(supply, place, share * r)
    else:
        (inner, outer), (first, last) = host.r, host.phi
        if host.corner == 0 and draw(st.booleans()):
            inner = draw(st.sampled_from([inner, (inner + outer) / 2]))
            last = draw(st.sampled_from([last, first + (last - first) / 3]))
            middle = (host.phi[0] + host.phi[1]) / 2
            if draw(st.booleans()):  # two pieces side by side hide it
                cover = [
                    RingPiece(host.supply, host.r, (host.phi[0], middle)),
                    RingPiece(draw(st.integers(1, 3)), host.r, (middle, host.phi[1])),
                ]
        piece = RingPiece(supply, (inner, outer), (first, last), host.corner)
    without = [*shapes[:over], *cover, *shapes[over + 1 :]]
    under = draw(st.integers(0, over))
    return without, [*without[:under], piece, *without[under:]]


@settings(max_examples=60)
@given(drawings_with_a_hidden_piece(), st.sampled_from([UNSEALED, SEALED]))
def test_a_hidden_piece_changes_nothing(
    drawings: tuple[list[Shape], list[Shape]], rules: SealRules
) -> None:
    """Raster, outline, faults and tips are those of the drawing without it, to the last bit."""
    grid = PolarGrid(radial=48, angular=180)
    (raster, outline), (other_raster, other) = (
        (CrossSection.from_drawing(grid, shapes, 0, rules), build_outline(grid, shapes, rules))
        for shapes in drawings
    )
    np.testing.assert_array_equal(other_raster.labels, raster.labels)
    np.testing.assert_array_equal(other.moments.raw, outline.moments.raw)
    np.testing.assert_array_equal(other.smooth_moments.raw, outline.smooth_moments.raw)
    assert told(other) == told(outline)
    number = next(k for k, (a, b) in enumerate(zip_longest(*drawings)) if a is not b)
    assert number in {f.drawn for f in other.faults if f.status is FaultKind.HIDDEN}
    assert len(other.chambers) == len(outline.chambers)
    assert all(chamber.area > 1e-3 for chamber in other.chambers)
    if outline.moments.is_stiff:
        one, two = (
            arc_tips(linear_response(moments, 300.0).strains(PRESSURES), 100.0)
            for moments in (outline.moments, other.moments)
        )
        np.testing.assert_array_equal(two, one)


def told(outline: Outline) -> list[Fault]:
    """Faults but for hidden chambers, whatever the others' numbers are."""
    shown = [fault for fault in outline.faults if fault.status is not FaultKind.HIDDEN]
    return [replace(fault, drawn=None) for fault in shown]


def test_a_piece_half_hidden_leaves_no_sliver() -> None:
    """Of the same radii: their polygons have other vertices, but one arc."""
    shapes: list[Shape] = [RingPiece(1, (13, 22), (0, 80)), RingPiece(2, (13, 22), (31.7, 133.1))]
    one, two, _ = drawn_regions(shapes, 5e-4)
    assert one.area == pytest.approx(np.radians(31.7) / 2 * (22**2 - 13**2), rel=1e-6)
    assert two.area == pytest.approx(np.radians(101.4) / 2 * (22**2 - 13**2), rel=1e-12)
    sealed = build_outline(PolarGrid(), shapes, SEALED)
    alone = build_outline(PolarGrid(), shapes[1:], SEALED)
    (left,), (whole,) = sealed.chambers_of(2), alone.chambers_of(2)
    wall = SEALED.wall / 2 * 9  # half of it along one side
    assert whole.area - left.area == pytest.approx(wall, abs=0.3)


def test_walls_of_elements_are_of_unsealed_sections() -> None:
    """Half of a wall of 16 elements is 1.4 mm here; what is sealed has its walls in mm alone."""
    grid = PolarGrid()
    shapes: list[Shape] = [RingPiece(1, (13, 22), (0, 80)), RingPiece(2, (13, 22), (80, 160))]
    points = FeaturePoints.random(grid, 60, np.random.default_rng(0))
    for rules in (SEALED, replace(SEALED, wall=0.0)):
        for build, source in (
            (CrossSection.from_drawing, shapes),
            (CrossSection.from_points, points),
        ):
            none, some = (build(grid, source, walls, rules) for walls in (0, 16))  # type: ignore[operator]
            np.testing.assert_array_equal(some.labels, none.labels)
        none, some = (phenotypes(grid, [points], walls, rules) for walls in (0, 16))
        np.testing.assert_array_equal(some.moments.raw, none.moments.raw)
    none, some = (CrossSection.from_drawing(grid, shapes, walls) for walls in (0, 16))
    assert some.moments.area > none.moments.area + 10
