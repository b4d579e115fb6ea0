"""A chamber cut into ring pieces that abut is the whole chamber."""

from itertools import pairwise

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.errors import GEOSException

from beamopt.outline import build
from beamopt.outline.build import build_outline
from beamopt.outline.faults import FaultKind
from beamopt.outline.outline import Outline
from beamopt.outline.ring import usual_sagitta
from beamopt.rod.arc import arc_tips
from beamopt.rod.response import linear_response
from beamopt.scene.design import Design
from beamopt.section.drawing import Circle, RingPiece, Shape
from beamopt.section.grid import PolarGrid
from beamopt.section.seal import UNSEALED, SealRules
from tests.beamopt.outline.sound import chamber_polygon, check_sound

GRID = PolarGrid()
ROUNDED, WALLED = SealRules(1.0, 0.0, 0.5), SealRules(1.0, 0.9, 0.5, 3.0)
OTHERS: list[Shape] = [Circle(2, (-17.5, 1.0), 3.0), Circle(3, (1.0, -17.5), 3.0)]
Pair = tuple[float, float]
PRESSURES = np.array([[20.0, 0, 0], [0, 10, 30]])


@st.composite
def a_chamber_and_its_pieces(draw: st.DrawFn) -> tuple[list[Shape], list[Shape]]:
    """Whole, and cut at radii and each of its rings at angles; whole millimetres, 5°, or any."""
    radii = st.integers(13, 22) if draw(st.booleans()) else st.floats(13, 22)
    steps = st.integers(0, 28).map(lambda k: 5.0 * k)
    angles = steps if draw(st.booleans()) else st.floats(0, 140)
    inner, *cuts = sorted({float(r) for r in draw(st.lists(radii, min_size=2, max_size=4))})
    r = [a for a in (12.0, inner, *cuts, 22.5) if a in (12.0, 22.5) or 12.3 < a < 22.2]
    phi = (0.0, draw(st.sampled_from([140.0, 95.0, 80.0])))
    pieces: list[Shape] = []
    for low, high in pairwise(apart(r, 0.3)):
        inside = [a for a in draw(st.lists(angles, max_size=3)) if phi[0] + 2 < a < phi[1] - 2]
        for first, last in pairwise(apart(sorted({*phi, *inside}), 2.0)):
            pieces.append(RingPiece(1, (low, high), (first, last)))
    order = draw(st.permutations(pieces))
    return [RingPiece(1, (12.0, 22.5), phi)], list(order)


def apart(values: list[float], least: float) -> list[float]:
    """Those that are so far from the one before and from the last."""
    kept = values[:1]
    for value in values[1:-1]:
        if value - kept[-1] >= least and values[-1] - value >= least:
            kept.append(value)
    return [*kept, values[-1]]


@settings(max_examples=60)
@given(a_chamber_and_its_pieces(), st.sampled_from([UNSEALED, ROUNDED, WALLED]))
def test_a_chamber_in_pieces(drawings: tuple[list[Shape], list[Shape]], rules: SealRules) -> None:
    whole, pieces = (build_outline(GRID, [*shapes, *OTHERS], rules) for shapes in drawings)
    same(pieces, whole)


@pytest.mark.parametrize("rules", [UNSEALED, ROUNDED, WALLED])
@pytest.mark.parametrize(
    "pieces",
    [
        [((13, 17), (0, 80)), ((17, 22), (0, 80))],
        [((13, 17), (0, 80)), ((17.00001, 22), (0, 80))],
        [((13, 22), (0, 30)), ((13, 22), (30, 60)), ((13, 22), (60, 80))],
        [((13, 17.3), (0, 20)), ((17.3, 22), (0, 20)), ((13, 22), (20, 80))],
        [((13, 17.3), (0, 33)), ((13, 17.3), (33, 80)), ((17.3, 22), (0, 51)),
         ((17.3, 22), (51, 80))],
    ],
)  # fmt: skip
def test_pieces_of_one_chamber(
    pieces: list[tuple[tuple[float, float], tuple[float, float]]], rules: SealRules
) -> None:
    cut: list[Shape] = [RingPiece(1, r, phi) for r, phi in pieces]
    whole = build_outline(GRID, [RingPiece(1, (13, 22), (0, 80)), *OTHERS], rules)
    same(build_outline(GRID, [*cut, *OTHERS], rules), whole)


@pytest.mark.parametrize("rules", [UNSEALED, ROUNDED])
def test_a_ring_in_pieces(rules: SealRules) -> None:
    """Rings have vertices at other angles than pieces of them."""
    whole = build_outline(GRID, [RingPiece(1, (13, 22), (0, 360))], rules)
    for pieces in (
        [RingPiece(1, (13, 17), (0, 360)), RingPiece(1, (17, 22), (0, 360))],
        [RingPiece(1, (13, 22), (0, 60)), RingPiece(1, (13, 22), (60, 360))],
        [RingPiece(1, (13, 17), (0, 360)),
         *(RingPiece(1, (17, 22), (first, first + 180)) for first in (0, 180))],
    ):  # fmt: skip
        same(build_outline(GRID, pieces, rules), whole)


def test_a_step_leaves_no_islands() -> None:
    """Arcs of 17.3 mm with vertices at other angles."""
    shapes: list[Shape] = [RingPiece(1, (13, 17.3), (7, 81)), RingPiece(1, (17.3, 22), (20, 81))]
    for rules in (UNSEALED, ROUNDED):
        outline = build_outline(GRID, [*shapes, *OTHERS], rules)
        assert outline.faults == ()
        assert len(outline.chambers_of(1)) == 1
    area = np.radians(74) / 2 * (17.3**2 - 13**2) + np.radians(61) / 2 * (22**2 - 17.3**2)
    raw = build_outline(GRID, shapes, UNSEALED).moments.raw
    assert raw[1, 0] == pytest.approx(area, rel=2e-6)


def test_pieces_on_pieces_of_another_supply() -> None:
    """Abutting pieces cut out of a larger chamber; the second is no thinner than the first."""
    shapes: list[Shape] = [
        RingPiece(1, (13.75, 25), (60, 360)),
        RingPiece(2, (13.75, 21.25), (240, 300)),
        RingPiece(2, (21.25, 25), (240, 300)),
    ]
    rules = SealRules(0.5, 0.0, 2.0)
    one = [shapes[0], RingPiece(2, (13.75, 25), (240, 300))]
    same(build_outline(GRID, shapes, rules), build_outline(GRID, one, rules))


def same(pieces: Outline, whole: Outline) -> None:
    """Faults, areas, places of the walls, and tips."""
    assert [(f.status, f.supplies) for f in pieces.faults] == [
        (f.status, f.supplies) for f in whole.faults
    ]
    assert len(pieces.chambers) == len(whole.chambers)
    assert len(pieces.pieces) == len(whole.pieces)
    check_sound(pieces, GRID)
    for one, other in zip(pieces.chambers, whole.chambers, strict=True):
        lines = [chamber_polygon(chamber).boundary for chamber in (one, other)]
        assert shapely.hausdorff_distance(*lines, densify=0.1) < 3 * usual_sagitta(GRID)
    raw, wanted = pieces.moments.raw, whole.moments.raw
    np.testing.assert_allclose(raw[:, 0], wanted[:, 0], rtol=1e-5)
    if whole.buildable:
        one, two = (
            arc_tips(linear_response(outline.moments, 300.0).strains(PRESSURES), 100.0)
            for outline in (pieces, whole)
        )
        assert np.abs(one - two).max() < 1e-4 * np.abs(two - [0, 0, 100]).max()


def test_what_geos_can_not_do_is_a_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise GEOSException("TopologyException")

    monkeypatch.setattr(build, "ring_polygon", fail)
    design = Design.model_validate(
        {
            "schema": "beamopt-design/1",
            "grid": {"inner_radius": 10.0, "outer_radius": 25.0},
            "drawing": [{"supply": 1, "r": [13.0, 22.0], "phi": [0.0, 80.0]}],
            "wall_elements": 0,
            "seal": {},
            "actuator": {"length": 100.0, "youngs_modulus": 300.0},
            "pressures": [0.0, 25.0, 50.0],
        }
    )
    assert [fault.status for fault in design.outline.faults] == [FaultKind.INVALID]
    assert not design.outline.buildable
    assert FaultKind.INVALID in {fault.status for fault in design.findings}
