"""Sections that nobody would draw; random ones are in the validation suite `sections`."""

import numpy as np
import pytest

from beamopt.outline.build import build_outline
from beamopt.outline.faults import FaultKind
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.moments import moments_of
from beamopt.section.raster import raster
from beamopt.section.seal import SealRules
from tests.beamopt.outline.hostile import RING, RULES, Case, hostile_cases
from tests.beamopt.outline.sound import check_sound
from tests.validation.sections import random_section


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
