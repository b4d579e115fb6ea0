"""Reaching points on every rung."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from beamopt.reach.reach import ReachStatus, reach
from beamopt.rod.ladder import Rung
from beamopt.rod.response import Response, linear_response
from beamopt.scene.bundled import bundled_scenes
from beamopt.scene.design import load_design
from beamopt.scene.scene import load_scene
from beamopt.section.moments import Moments

DESIGN = load_design(bundled_scenes()["hand-drawn-section"].with_name("hand_drawn_section.json"))
MODEL = DESIGN.climb.model
WITHIN = np.array([[20.0, 60.0, 30.0], [0.0, 100.0, 100.0], [45.0, 45.0, 45.0]])


@pytest.mark.parametrize("rung", [Rung.ARC, Rung.CHAIN])
def test_rungs_without_loads(rung: Rung) -> None:
    points = np.vstack([DESIGN.tips(WITHIN), [[0.0, 0.0, 170.0]]])
    found = reach(MODEL.on(rung), DESIGN.values, points, 0.0, 100.0)
    assert found.distances[:3].max() < 1e-4
    assert found.statuses(0.1) == (*[ReachStatus.REACHED] * 3, ReachStatus.OUTSIDE)
    own = MODEL.on(rung).tips(DESIGN.values, found.pressures).positions
    np.testing.assert_allclose(own, found.tips, rtol=0, atol=1e-9)


def test_a_pre_curved_arc() -> None:
    """Its curvature at rest is part of what it reaches."""
    model = load_scene("random-section", ["rod.rest_curvature=[0.006, -0.003, 0.0]"]).climb.model
    assert model.rung is Rung.ARC
    points = model.tips(DESIGN.values, WITHIN).positions
    assert reach(model, DESIGN.values, points, 0.0, 100.0).distances.max() < 1e-6


def test_segments_reach_what_they_reach() -> None:
    """A chain of two pieces, one turned: another workspace than the arc's."""
    model = load_scene("two-segments").climb.model
    assert model.rung is Rung.CHAIN
    points = model.tips(DESIGN.values, WITHIN).positions
    found = reach(model, DESIGN.values, points, 0.0, 100.0)
    assert found.distances.max() < 1e-3


def test_under_loads() -> None:
    """To about the tips' own tolerance of 0.1 mm, a hundredth of how far gravity moves them."""
    scene = load_scene("gravity")
    model = scene.climb.model
    assert model.rung is Rung.LOADED
    design = load_design(str(scene.target.file))
    points = model.tips(design.values, WITHIN[:2]).positions
    found = reach(model, design.values, points, 0.0, 100.0)
    assert found.distances.max() < 0.05


def test_a_response_that_is_not_linear() -> None:
    """Another response than the matrix: by differences of its own strains."""

    class Quadratic:
        def __init__(self, moments: Moments) -> None:
            self.linear = linear_response(moments, 300.0)

        def strains(self, pressures: np.ndarray) -> np.ndarray:
            return self.linear.strains(pressures + pressures**2 / 200)

    def respond(moments: Moments, _: float) -> Response:
        return Quadratic(moments)

    model = replace(MODEL, response_of=partial(respond, _=0.0))
    points = model.tips(DESIGN.values, WITHIN).positions
    found = reach(model, DESIGN.values, points, 0.0, 100.0)
    assert found.distances.max() < 1e-3
    np.testing.assert_allclose(found.pressures, WITHIN, atol=0.05)
