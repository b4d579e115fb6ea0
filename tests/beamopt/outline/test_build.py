"""Sections whose outlines are known, and each fault where it belongs."""

import numpy as np
import pytest

from beamopt.outline.build import build_outline
from beamopt.outline.faults import Fault, FaultKind, Severity
from beamopt.outline.inspection import thicknesses
from beamopt.outline.outline import Outline
from beamopt.outline.ring import ring_polygon
from beamopt.section.drawing import Circle, RingPiece, Shape
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.moments import Moments
from beamopt.section.seal import SealRules
from tests.beamopt.outline.hostile import DRAWINGS, POINTS, RING, RULES
from tests.beamopt.outline.necks import thinnest

WALLED = SealRules(0.0, 0.9)


def statuses(outline: Outline) -> list[FaultKind]:
    return [fault.status for fault in outline.faults]


def found(outline: Outline, status: FaultKind) -> Fault:
    return next(fault for fault in outline.faults if fault.status is status)


def test_three_drawn_pieces_are_as_drawn() -> None:
    outline = build_outline(RING, DRAWINGS["three pieces"], SealRules(), 0.01)
    assert outline.faults == ()
    assert outline.keeps_rules
    assert len(outline.pieces) == 1
    area = np.radians(80) / 2 * (22**2 - 13**2)
    np.testing.assert_allclose(outline.smooth_moments.chamber_areas, area, rtol=1e-4)
    np.testing.assert_allclose(outline.moments.chamber_areas, area, rtol=2e-3)
    assert [loop.supply for loop in outline.pieces[0].loops].count(0) == 2


def test_chambers_of_one_supply_add() -> None:
    """Two circles of one supply: area and first moments of both, up to places of 1e-5 mm."""
    circles = [Circle(2, (17, 0), 3.0), Circle(2, (0, 17), 2.0)]
    outline = build_outline(RING, circles, SealRules(), 0.01)
    areas = np.pi * np.array([3.0, 2.0]) ** 2
    raw = outline.moments.raw[2]
    np.testing.assert_allclose(raw[:3], [areas.sum(), *(17 * areas)], rtol=1e-6)


def test_a_sector_is_one_loop_with_straight_ends() -> None:
    grid = PolarGrid(10, 25, start=0, stop=90)
    outline = build_outline(grid, [Circle(1, (12, 12), 3.0)], RULES)
    (piece,) = outline.pieces
    assert [loop.supply for loop in piece.loops] == [0, 1]
    for corner in ((10, 0), (25, 0), (0, 25), (0, 10)):
        assert np.hypot(*(piece.exterior.points - corner).T).min() < 1e-9


def test_sealing_a_drawing_parts_supplies_in_the_middle() -> None:
    shapes = DRAWINGS["side by side"]
    outline = build_outline(RING, shapes, RULES, 0.01)
    assert outline.faults == ()
    # between pieces that met on a radius, half a wall from either side of it
    chamber = outline.chambers_of(1)[0].exterior
    x = chamber[np.abs(chamber[:, 1]) < 2]
    turn = np.radians(100)
    other = chamber @ np.array([-np.sin(turn), np.cos(turn)])
    along = chamber @ np.array([np.cos(turn), np.sin(turn)])
    assert other[along > 12].max() == pytest.approx(-RULES.wall / 2, abs=0.02)
    assert x[:, 1].min() == pytest.approx(0, abs=0.01)  # nothing lies across: left as drawn


def test_drawn_parts_of_one_supply_become_one_chamber() -> None:
    outline = build_outline(RING, DRAWINGS["one supply side by side"], RULES)
    assert len(outline.chambers_of(1)) == 1


@pytest.mark.parametrize("gap", [0.05, 0.3, 0.6, 0.85])
def test_lobes_that_nearly_touch_are_cut_apart_or_joined(gap: float) -> None:
    shapes: list[Shape] = [Circle(1, (17, 0), 3.0), Circle(1, (17, 6 + gap), 3.0)]
    outline = build_outline(RING, shapes, RULES)
    assert outline.keeps_rules
    assert thinnest(outline, 0.79)[0] == 0.79
    thin = build_outline(RING, shapes, WALLED, 0.005)
    assert found(thin, FaultKind.NECK).value == pytest.approx(gap, abs=0.011)


def test_an_annular_chamber_cuts_the_material_in_two() -> None:
    for points in (POINTS["all of one supply"], POINTS["an annular chamber"]):
        outline = build_outline(RING, points, RULES)
        assert found(outline, FaultKind.PIECES).value == 2
        assert not outline.buildable
        assert outline.islands == ()  # both hang on to a surface
        x, y = found(outline, FaultKind.PIECES).place or (0, 0)
        assert 10 < np.hypot(x, y) < 13


def test_without_an_inner_surface_the_middle_is_an_island() -> None:
    disc = PolarGrid(0, 25)
    kept = SealRules(1.0, 0.9, 0.5, 3.0, False)
    drawing: list[Shape] = [RingPiece(2, (8, 20), (0, 360))]
    outline = build_outline(disc, drawing, kept)
    fault = found(outline, FaultKind.ISLAND)
    assert fault.value == pytest.approx(np.pi * 64, rel=0.01)
    assert fault.severity is Severity.NOTICE
    assert fault.supplies == (2,)
    assert outline.buildable
    (island,) = outline.islands
    assert island.area == fault.value
    filled = build_outline(disc, drawing, RULES)
    assert filled.islands == ()
    assert filled.chambers[0].area == pytest.approx(np.pi * 400, rel=0.01)


def test_a_wall_around_another_supply_is_no_island_to_fill() -> None:
    outline = build_outline(RING, DRAWINGS["a circle in a circle"], RULES)
    assert len(outline.chambers_of(2)) == 1
    assert statuses(outline).count(FaultKind.ISLAND) == 1


def test_small_chambers_are_filled() -> None:
    shapes: list[Shape] = [Circle(1, (17, 0), 1.2), Circle(2, (-17, 0), 0.9)]
    outline = build_outline(RING, shapes, RULES)
    assert [chamber.supply for chamber in outline.chambers] == [1]
    assert statuses(outline) == [*[FaultKind.NO_CHAMBER] * 2, FaultKind.LOST]
    assert found(outline, FaultKind.LOST).drawn == 1


def test_chambers_open_to_a_surface_or_to_each_other() -> None:
    outline = build_outline(RING, DRAWINGS["to the surface"], SealRules())
    assert statuses(outline)[:2] == [FaultKind.UNSEALED] * 2
    assert outline.worst is Severity.FATAL
    assert "supply 1 opens to a surface at (" in str(outline.faults[0])
    outline = build_outline(RING, DRAWINGS["side by side"], SealRules())
    assert outline.faults[0].supplies == (1, 2)
    assert "supplies 1 and 2 open into each other" in str(outline.faults[0])


def test_no_material_at_all() -> None:
    outline = build_outline(RING, [RingPiece(1, (0, 40), (0, 360))], SealRules())
    assert FaultKind.NO_MATERIAL in statuses(outline)
    assert outline.pieces == ()


def test_touching_lobes_of_one_supply_are_no_polygons() -> None:
    outline = build_outline(RING, DRAWINGS["circles that touch"], SealRules())
    assert outline.faults[0].status is FaultKind.INVALID


@pytest.mark.parametrize("rules", [SealRules(), SealRules(1.0), SealRules(1.0, 0.0, 0.5), WALLED])
@pytest.mark.parametrize("gap", [0.02, 0.01, 1e-3])
def test_a_chamber_that_nearly_meets_itself(rules: SealRules, gap: float) -> None:
    """Both ends of a ring piece, `gap` [degrees] from each other: 0.002 mm at 14 mm is no wall."""
    outline = build_outline(RING, [RingPiece(1, (14, 18), (0, 360 - gap))], rules)
    touching = found(outline, FaultKind.INVALID)
    assert touching.supplies == (1,)
    x, y = touching.place or (0, 0)
    assert 14 < x < 18
    assert y == pytest.approx(0, abs=0.01)
    assert touching.value == pytest.approx(x * np.radians(gap), rel=0.05)
    assert not outline.buildable


@pytest.mark.parametrize("far", [1.0, 5.0, 8.9, 8.98])
def test_a_sharp_corner_of_material_is_no_contact(far: float) -> None:
    """Two circles that overlap leave a wedge of material on either side."""
    shapes: list[Shape] = [Circle(1, (-far / 2, 17.5), 4.5), Circle(1, (far / 2, 17.5), 4.5)]
    assert statuses(build_outline(RING, shapes, SealRules())) == [FaultKind.NO_CHAMBER] * 2


def test_walls_and_skins_are_measured_and_named() -> None:
    shapes: list[Shape] = [
        Circle(1, (17, 0), 3.0),
        Circle(2, (17, 6.412), 3.0),
        Circle(3, (-21.5, 0), 3.0),
    ]
    outline = build_outline(RING, shapes, WALLED, 0.001)
    wall = found(outline, FaultKind.WALL)
    assert wall.value == pytest.approx(0.412, abs=2e-3)
    assert wall.supplies == (1, 2)
    assert str(wall) == (
        f"wall between supplies 1 and 2 is {wall.value:.3f} mm at (17.0, 3.2) mm, asked 0.9"
    )
    assert outline.worst is Severity.VIOLATION
    assert outline.buildable
    assert not outline.keeps_rules
    regions = [
        tuple(_polygon(chamber) for chamber in outline.chambers_of(supply)) for supply in (1, 2, 3)
    ]
    (skin,) = thicknesses(regions, ring_polygon(RING), SealRules(1.0), 0.1)
    assert skin.value == pytest.approx(0.5, abs=2e-3)
    assert skin.place == pytest.approx((-24.75, 0.0), abs=0.02)
    assert str(skin) == f"skin over supply 3 is {skin.value:.3f} mm at (−24.8, 0.0) mm, asked 1"


def _polygon(chamber):  # type: ignore[no-untyped-def]
    import shapely

    return shapely.Polygon(chamber.exterior, chamber.holes)


def test_a_self_neck_is_named() -> None:
    """A chamber nearly all round another place: its two ends 0.5 mm apart."""
    gap = np.degrees(0.5 / 17.5)
    outline = build_outline(RING, [RingPiece(1, (13, 22), (gap / 2, 360 - gap / 2))], WALLED, 0.005)
    neck = found(outline, FaultKind.NECK)
    assert neck.value == pytest.approx(0.5 * 13 / 17.5, abs=0.02)
    assert neck.place is not None
    assert abs(neck.place[1]) < 0.1
    assert outline.buildable


def test_three_moments() -> None:
    outline = build_outline(RING, FeaturePoints([15, -15], [2, 0], [1, 2]), RULES)
    raster = Moments(np.zeros((4, 6)))
    views = outline.views(raster)
    assert views.raster is raster
    assert views.smooth is outline.smooth_moments
    assert views.outline is outline.moments


@pytest.mark.parametrize("sagitta", [0.0, -1.0, float("nan"), float("inf")])
def test_an_impossible_sagitta_is_refused(sagitta: float) -> None:
    with pytest.raises(ValueError, match="sagitta = "):
        build_outline(RING, [], RULES, sagitta)


def test_severities() -> None:
    fatal = {kind for kind in FaultKind if kind.severity is Severity.FATAL}
    notices = {kind for kind in FaultKind if kind.severity is Severity.NOTICE}
    assert fatal == {
        FaultKind.PIECES,
        FaultKind.NO_MATERIAL,
        FaultKind.UNSEALED,
        FaultKind.INVALID,
    }
    assert notices == {
        FaultKind.ISLAND,
        FaultKind.NO_CHAMBER,
        FaultKind.CUT,
        FaultKind.HIDDEN,
        FaultKind.LOST,
        FaultKind.WALL_ELEMENTS,
    }


@pytest.mark.parametrize("status", FaultKind)
@pytest.mark.parametrize("supplies", [(1,), (1, 2)])
def test_every_fault_is_a_sentence(status: FaultKind, supplies: tuple[int, ...]) -> None:
    said = str(Fault(status, 0.25, (1.0, -2.0), supplies))
    assert "at (1.0, −2.0) mm" in said
    assert "None" not in said
