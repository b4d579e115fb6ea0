"""What skins leave of a sector, against an integral over the radius."""

import numpy as np
import pytest
import shapely

from beamopt.outline.build import build_outline
from beamopt.outline.ring import shrunk_ring
from beamopt.section.cross_section import CrossSection
from beamopt.section.drawing import Circle, RingPiece, Shape
from beamopt.section.grid import PolarGrid
from beamopt.section.moments import Moments
from beamopt.section.seal import SealRules

OUTER = 25.0
SPANS = [30.0, 90.0, 117.9, 180.0, 244.4, 270.0, 355.0]


def chamber_area(inner: float, skin: float, span: float) -> float:
    """∫ r (φ − 2 asin(s/r)) dr [mm²] over the radii where a skin is left between both ends."""
    half = np.radians(span) / 2
    low = inner + skin if inner > 0 else skin
    if half < np.pi / 2:
        low = max(low, skin / np.sin(half))
    high = OUTER - skin
    if low >= high:
        return 0.0
    t, weight = np.polynomial.legendre.leggauss(200)
    t, weight = (t + 1) / 2, weight / 2
    r = low + (high - low) * t**2  # smooth also where asin begins like a square root
    angle = 2 * half - 2 * np.arcsin(np.minimum(skin / r, 1))
    return float((weight * r * angle * 2 * (high - low) * t).sum())


@pytest.mark.parametrize("span", SPANS)
@pytest.mark.parametrize("skin", [0.1, 1.0, 1.5, 3.0, 8.0])
@pytest.mark.parametrize("inner", [0.0, 0.01, 0.2, 1.0, 2.0, 5.0, 10.0])
def test_a_skin_all_around_a_sector(inner: float, skin: float, span: float) -> None:
    grid = PolarGrid(inner, OUTER, start=-20.0, stop=span - 20.0)
    wanted = chamber_area(inner, skin, span)
    inside = shrunk_ring(grid, skin)
    assert inside.area == pytest.approx(wanted, rel=2e-5, abs=1e-3)
    if wanted:
        x, y = shapely.get_coordinates(inside.centroid)[0]
        axis = np.radians(span / 2 - 20)
        assert y * np.cos(axis) - x * np.sin(axis) == pytest.approx(0, abs=1e-5)


@pytest.mark.parametrize(
    ("inner", "skin", "span"),
    [(1.0, 1.5, 180.0), (1.0, 3.0, 180.0), (2.0, 3.0, 180.0), (5.0, 8.0, 180.0),
     (5.0, 8.0, 120.0), (0.5, 0.8, 60.0), (0.2, 0.3, 270.0), (0.0, 2.0, 250.0)],
)  # fmt: skip
def test_a_chamber_that_fills_a_sector(inner: float, skin: float, span: float) -> None:
    """Smooth, resampled and rasterised."""
    wanted = chamber_area(inner, skin, span)
    grid, shapes, rules = sector_filled(inner, skin, span, 0.0)
    outline = build_outline(grid, shapes, rules)
    for moments in (outline.smooth_moments, outline.moments):
        assert moments.raw[1, 0] == pytest.approx(wanted, rel=2e-5)
        assert abs(lopsided(moments, span)) < 1e-6
    raster = CrossSection.from_drawing(grid, shapes, 0, rules).moments
    assert raster.raw[1, 0] == pytest.approx(wanted, rel=3e-2 if wanted < 200 else 2e-3)
    assert abs(lopsided(raster, span)) < 1e-9


@pytest.mark.parametrize(
    ("inner", "skin", "span"),
    [(1.0, 1.5, 180.0), (2.0, 3.0, 180.0), (0.2, 0.3, 270.0), (0.0, 2.0, 250.0), (0.2, 0.2, 100.0)],
)
def test_a_rounding_wider_than_the_inner_arc(inner: float, skin: float, span: float) -> None:
    """Rounding takes (4 − π)/4 of its square from each of four right angles; two are sharper."""
    wanted = chamber_area(inner, skin, span)
    rounding = inner + skin + 0.5
    moments = build_outline(*sector_filled(inner, skin, span, rounding)).moments
    assert wanted - (4 - np.pi) * rounding**2 * 1.5 < moments.raw[1, 0] < wanted
    assert abs(lopsided(moments, span)) < 1e-5


def sector_filled(
    inner: float, skin: float, span: float, rounding: float
) -> tuple[PolarGrid, list[Shape], SealRules]:
    grid = PolarGrid(inner, OUTER, radial=256, angular=360, start=0.0, stop=span)
    return grid, [RingPiece(1, (inner, OUTER), (0.0, span))], SealRules(skin, 0.9, rounding)


def lopsided(moments: Moments, span: float) -> float:
    """The chamber's centroid beside the sector's axis of symmetry [outer radii]."""
    area, x, y = moments.raw[1, :3]
    half = np.radians(span) / 2
    return float((x * np.sin(half) - y * np.cos(half)) / area / OUTER)


@pytest.mark.parametrize("rounding", [0.5, 0.6, 1.0, 2.0, 4.0, 4.4])
@pytest.mark.parametrize("wall", [0.0, 0.9, 3.0])
def test_rounding_leaves_round_chambers_alone(wall: float, rounding: float) -> None:
    """A circle is its own opening by any smaller disc."""
    angles = 0.3 + 2 * np.pi / 3 * np.arange(3)
    shapes = [
        Circle(supply, (float(17.5 * np.cos(a)), float(17.5 * np.sin(a))), 4.5)
        for supply, a in enumerate(angles, 1)
    ]
    outline = build_outline(PolarGrid(), shapes, SealRules(1.0, wall, rounding))
    assert outline.faults == ()
    np.testing.assert_allclose(outline.moments.chamber_areas, np.pi * 4.5**2, rtol=6e-5)


@pytest.mark.parametrize("rounding", [0.5, 0.6, 1.0, 2.0, 4.0])
def test_rounded_corners_of_a_ring_piece(rounding: float) -> None:
    """As if the piece had been drawn with round corners."""
    sharp, drawn = (
        build_outline(PolarGrid(), [RingPiece(1, (12.3, 22), (0, 95), corner)], rules)
        for corner, rules in ((0.0, SealRules(1.0, 0.0, rounding)), (rounding, SealRules(1.0)))
    )
    assert sharp.moments.raw[1, 0] == pytest.approx(drawn.moments.raw[1, 0], rel=2e-5)
