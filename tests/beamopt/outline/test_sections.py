"""Random sealed sections, and sections that nobody would draw."""

from collections import Counter

import numpy as np
import pytest

from beamopt.outline.build import SLACK, build_outline
from beamopt.outline.faults import FaultKind, Severity
from beamopt.outline.outline import Outline
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.moments import moments_of
from beamopt.section.raster import raster
from beamopt.section.seal import SealRules
from tests.beamopt.outline.hostile import RING, RULES, Case, hostile_cases
from tests.beamopt.outline.necks import thinnest
from tests.beamopt.outline.sound import check_sound

SAGITTA = 0.04
TOLERANCE = 2 * SAGITTA + SLACK


def random_section(seed: int) -> FeaturePoints:
    rng = np.random.default_rng(seed)
    return FeaturePoints.random(RING, int(rng.integers(60, 101)), rng)


def skin_of(outline: Outline) -> float:
    """Least skin [mm]: outer chords against chambers' vertices and chords, by radii alone."""
    outer = [chamber.exterior for chamber in outline.chambers]
    return min(
        25 - SAGITTA - max(np.hypot(*points.T).max() for points in outer),
        min(np.hypot(*((points + np.roll(points, -1, axis=0)) / 2).T).min() for points in outer)
        - 10,
    )


def test_two_hundred_random_sections() -> None:
    """Half a minute, which buys the one claim that the rest stands on: what is made by the rules
    keeps them. Every one is sound, its skins are measured without shapely, and a quarter of them
    is searched for thin material by another method; what is thinner than asked must be named.
    """
    violations: Counter[FaultKind] = Counter()
    violated = 0
    for seed in range(200):
        outline = build_outline(RING, random_section(seed), RULES, SAGITTA)
        check_sound(outline, RING)
        assert outline.buildable
        found = [fault for fault in outline.faults if fault.severity is Severity.VIOLATION]
        violations.update(fault.status for fault in found)
        violated += bool(found)
        if not found:
            assert skin_of(outline) > RULES.skin - TOLERANCE
        if seed % 4 == 0:
            # two tenths less than asked: straight ways that are not square to the walls count too
            width, where = thinnest(outline, RULES.wall - TOLERANCE - 0.01)
            named = [fault for fault in found if fault.status is not FaultKind.SKIN]
            assert named or width == RULES.wall - TOLERANCE - 0.01, (seed, width, where)
        assert min(chamber.area for chamber in outline.chambers) > 0.9 * RULES.smallest_chamber
    assert violated <= 10, violations


@pytest.mark.parametrize("case", list(hostile_cases()), ids=lambda case: case[0])
def test_hostile_sections(case: Case) -> None:
    """Always an outline that is sound or says why it is not."""
    _, grid, source, rules = case
    outline = build_outline(grid, source, rules)
    check_sound(outline, grid)
    for supply in (1, 2, 3):
        missing = [
            fault
            for fault in outline.faults
            if fault.status is FaultKind.NO_CHAMBER and fault.supplies == (supply,)
        ]
        assert bool(missing) == (not outline.chambers_of(supply))
    if rules.sealed and min(rules.skin, rules.wall) > 0.01:
        assert not any(fault.status is FaultKind.UNSEALED for fault in outline.faults)


def test_the_same_bytes_again() -> None:
    points = random_section(3)
    one, two = (build_outline(RING, points, RULES) for _ in range(2))
    for a, b in zip(one.pieces, two.pieces, strict=True):
        for p, q in zip(a.loops, b.loops, strict=True):
            assert p.points.tobytes() == q.points.tobytes()
    assert one.faults == two.faults
    assert one.moments.raw.tobytes() == two.moments.raw.tobytes()


def test_without_a_skin_the_section_is_the_fine_raster() -> None:
    """Cells as they are: moments as those of a raster of three million elements."""
    # not a multiple of the columns that points lie on: those elements would all be ties
    fine = PolarGrid(10.0, 25.0, 1009, 3001)
    for seed in range(3):
        points = random_section(seed)
        outline = build_outline(RING, points, SealRules())
        assert not outline.buildable
        expected = moments_of(fine, raster(fine, points)).raw
        scale = np.array([1, 25, 25, 625, 625, 625])
        for found in (outline.smooth_moments.raw, outline.moments.raw):
            np.testing.assert_allclose(found / scale, expected / scale, atol=0.12)


def test_a_finer_sagitta_comes_nearer_to_the_smooth_section() -> None:
    points = random_section(1)
    off = []
    for sagitta in (0.04, 0.01, 0.0025):
        outline = build_outline(RING, points, RULES, sagitta)
        away = np.abs(outline.moments.raw - outline.smooth_moments.raw)
        assert away[:, 0].max() < 1e-8
        off.append(away[:, 3:].max())
    assert off[0] > 2 * off[1] > 4 * off[2]
    assert off[0] < 2e-5 * outline.moments.raw[0, 3]
    assert off[2] < 0.5


def test_turned_with_its_points() -> None:
    """A section has no preferred direction but the ring's first vertex."""
    points = random_section(2)
    c, s = np.cos(1.0), np.sin(1.0)
    turned = FeaturePoints(c * points.x - s * points.y, s * points.x + c * points.y, points.type)
    one, two = (build_outline(RING, each, RULES).smooth_moments for each in (points, turned))
    np.testing.assert_allclose(one.chamber_areas, two.chamber_areas, atol=0.05)
    np.testing.assert_allclose(one.principal[0], two.principal[0], rtol=1e-4)


@pytest.mark.parametrize("rules", [SealRules(2.0), SealRules(1.0, 0.0, 0.5)])
def test_chambers_that_touch_are_no_material(rules: SealRules) -> None:
    """Without walls supplies meet along lines; material is still what all of them leave."""
    grid = PolarGrid(2, 25, 48, 90)
    cut = FeaturePoints(
        np.array([7.747826804396209, -6.802243137532561, -6.889806707316043, 2.293781447616993,
                  -7.93795209573468, -8.112868529001911, -9.667957993347756, 5.855326069605605,
                  -3.0210931414541866]),
        np.array([-18.29236285548707, 19.12130276601693, 12.285884699316192, -18.098022856714437,
                  8.658495991673211, 8.561515271061648, 3.908852252363644, 24.059477260851843,
                  1.6093424721961438]),
        np.array([2, 0, 0, 0, 0, 3, 1, 3, 2]),
    )  # fmt: skip
    rng = np.random.default_rng(0)
    for points in (cut, *(FeaturePoints.random(grid, 12, rng) for _ in range(60))):
        outline = build_outline(grid, points, rules)
        raw, smooth = outline.moments.raw, outline.smooth_moments.raw
        assert raw[:, 0].sum() == pytest.approx(grid.area, rel=1e-3)
        assert raw[0, 0] == pytest.approx(smooth[0, 0], rel=2e-3)
