"""Where the tip of an arc points."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beamopt.base.arrays import FloatArray
from beamopt.rod.arc import arc_centreline, arc_tip_direction_jacobian, arc_tip_directions
from beamopt.rod.ladder import Rung
from beamopt.scene.scene import load_scene

LENGTH = 100.0


def strains_of(angle: float, about: float) -> FloatArray:
    return np.array([0.1, angle / LENGTH * np.cos(about), angle / LENGTH * np.sin(about)])


angles = st.one_of(st.sampled_from([0.0, 1e-12, 1e-6, np.pi, 2 * np.pi]), st.floats(1e-9, 9.0))


@given(angles, st.floats(-4, 4))
def test_it_is_the_unit_tangent_of_the_centreline(angle: float, about: float) -> None:
    strains = strains_of(angle, about)
    direction = arc_tip_directions(strains, LENGTH)
    assert np.linalg.norm(direction) == pytest.approx(1, abs=1e-14)
    line = arc_centreline(strains, np.array([LENGTH - 1e-3, LENGTH + 1e-3]))
    chord = (line[1] - line[0]) / 2e-3 / 1.1  # off by κ² 1e-6/6, and by rounding
    np.testing.assert_allclose(direction, chord, rtol=0, atol=1e-8)


@given(angles, st.floats(-4, 4))
def test_derivatives_are_those_of_differences(angle: float, about: float) -> None:
    """Fourth-order central differences; steps of 1e-3 rad, error below 1e-10 of H."""
    strains = strains_of(angle, about)
    found = arc_tip_direction_jacobian(strains, LENGTH)
    for k, step in enumerate((1e-3, 1e-5, 1e-5)):
        moved = strains + np.outer([-2, -1, 1, 2], np.eye(3)[k] * step)
        values = arc_tip_directions(moved, LENGTH)
        slope = np.array([1, -8, 8, -1]) @ values / (12 * step)
        np.testing.assert_allclose(found[:, k], slope, rtol=0, atol=1e-7)


def test_all_rungs_point_the_same_way() -> None:
    """The arc in closed form, the chain's exponentials, the loaded rod's rotations."""
    scene = load_scene("hand-drawn-section", ["rod.rest_curvature=[0.004, -0.002, 0.0]"])
    model = scene.climb.model
    design = scene.design_of(scene.random_points(np.random.default_rng([1])))
    pressures = np.random.default_rng(2).uniform(0, 100, (5, 3))
    ways = [model.on(rung).tips(design.values, pressures).directions for rung in Rung]
    assert all(way is not None for way in ways)
    # the loaded rod's modes are as fine as 0.1 mm of 100 mm asks for
    np.testing.assert_allclose(ways[1], ways[0], rtol=0, atol=1e-12)
    np.testing.assert_allclose(ways[2], ways[0], rtol=0, atol=1e-6)
