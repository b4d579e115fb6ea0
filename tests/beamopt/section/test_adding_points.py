"""What must not change a section: a twin, a point far away, another order of the points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from beamopt.base.arrays import FloatArray
from beamopt.judge.judge import Verdict
from beamopt.scene.design import Design
from beamopt.section.cell_owners import NEAR
from beamopt.section.feature_points import FeaturePoints
from tests.beamopt.refine.cases import judge_of, scene_of

SCENES = ("random-section", "sealed-section")
SIZE = ("grid.radial=32", "grid.angular=90")

seeds = st.integers(0, 2**32)


@dataclass(frozen=True)
class Seen:
    """A section as every part of the program sees it."""

    design: Design
    verdict: Verdict
    ratio: float

    @property
    def polygons(self) -> list[tuple[int, FloatArray]]:
        outline = self.design.outline
        return [(loop.supply, loop.points) for piece in outline.pieces for loop in piece.loops]


def seen(name: str, points: FeaturePoints) -> Seen:
    judge = judge_of(name, *SIZE)
    ratio = float(judge.measured([points]).neighbour_ratio[0])
    return Seen(scene_of(name, *SIZE).design_of(points), judge([points])[0], ratio)


def assert_same(one: Seen, other: Seen) -> None:
    """To the bit."""
    np.testing.assert_array_equal(one.design.section.labels, other.design.section.labels)
    assert len(one.polygons) == len(other.polygons)
    for (supply, a), (theirs, b) in zip(one.polygons, other.polygons, strict=True):
        assert supply == theirs
        np.testing.assert_array_equal(a, b)
    assert one.design.outline.faults == other.design.outline.faults
    np.testing.assert_array_equal(one.design.moments.raw, other.design.moments.raw)
    np.testing.assert_array_equal(one.design.workspace.tips, other.design.workspace.tips)
    assert one.ratio == other.ratio
    assert one.verdict == other.verdict


def anywhere(seed: int) -> FeaturePoints:
    """Real-valued places in the ring and around it; some cells do not reach into it."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(8, 40))
    x, y = rng.uniform(-28, 28, (2, count))
    return FeaturePoints(x, y, rng.choice(4, count, p=[0.55, 0.15, 0.15, 0.15]))


def with_more(points: FeaturePoints, x: FloatArray, y: FloatArray, types: object) -> FeaturePoints:
    return FeaturePoints(
        np.append(points.x, x), np.append(points.y, y), np.append(points.type, types)
    )


@pytest.mark.parametrize("name", SCENES)
@given(seeds)
@settings(max_examples=15)
def test_a_twin_changes_nothing(name: str, seed: int) -> None:
    points, rng = anywhere(seed), np.random.default_rng([seed, 1])
    at = rng.integers(len(points), size=5)
    off = rng.choice([0.0, 1e-12, 1e-9, 1e-7, 0.6 * NEAR], (2, 5))
    places = points.x[at] + off[0], points.y[at] + off[1]
    doubled = with_more(points, *places, rng.integers(4, size=5))
    assert_same(seen(name, points), seen(name, doubled))


@pytest.mark.parametrize("name", SCENES)
@given(seeds)
@settings(max_examples=15)
def test_a_point_far_away_changes_nothing(name: str, seed: int) -> None:
    """Wherever its cell stays outside the ring; a lattice for all points must not grow with it."""
    points, rng = anywhere(seed), np.random.default_rng([seed, 2])
    away, angle = 10 ** rng.uniform(2.5, 6, 3), rng.uniform(0, 2 * np.pi, 3)
    more = with_more(points, away * np.cos(angle), away * np.sin(angle), rng.integers(4, size=3))
    assert_same(seen(name, points), seen(name, more))


@pytest.mark.parametrize("name", SCENES)
@given(seeds)
@settings(max_examples=15)
def test_the_order_of_points_changes_nothing(name: str, seed: int) -> None:
    """Where no two are equally far from a centroid, or in one place."""
    points = anywhere(seed)
    order = np.random.default_rng([seed, 3]).permutation(len(points))
    permuted = FeaturePoints(points.x[order], points.y[order], points.type[order])
    assert_same(seen(name, points), seen(name, permuted))


@pytest.mark.parametrize("off", [0.0, 1e-12, 1e-9, 1e-8, 1e-6, 0.5 * NEAR, 2 * NEAR, 1e-3])
def test_near_points_are_one_section_in_raster_and_outline(off: float) -> None:
    """Areas of both agree however near two points are: closer than `NEAR` they are one."""
    points = FeaturePoints([17.0, 17.0 + off, -17.0, 0.0], [0.0, 0.0, 2.0, -18.0], [1, 2, 3, 0])
    design = scene_of("sealed-section").design_of(points)
    raster, outline = design.section.moments.raw[:, 0], design.outline.moments.raw[:, 0]
    assert (outline[2] > 100) == (off > NEAR)
    np.testing.assert_allclose(raster, outline, atol=0.006 * design.grid.build().area)
