"""Paths through limit points."""

from __future__ import annotations

import numpy as np
import pytest

from beamopt.rod.law import SectionLaw
from beamopt.rod.modes import StrainModes
from beamopt.rod.path import PathStatus, follow_path
from beamopt.rod.rod import STRAIGHT, PointLoad, Rod, Segment, Tip
from tests.beamopt.rod.samples import PLANE, SPACE, plain_law, solved
from tests.beamopt.rod.test_following import arch


def bent(free: tuple[int, ...] = SPACE) -> Rod:
    end = PointLoad(force=np.array([3.0, 1.0, -2.0]))
    rest = STRAIGHT + np.array([0.3, 0.5, 0.0, 0.0, 0.0, 0.0])
    return Rod((Segment(1.0, plain_law(1.0, 0.6, free), rest, end=end),))


@pytest.mark.parametrize("free", [PLANE, SPACE])
def test_its_points_are_the_equilibria(free: tuple[int, ...]) -> None:
    rod = bent(free)
    path = follow_path(rod, modes=8, step=0.05)
    assert path.status is PathStatus.FULL_LOAD
    assert path.stable.all()
    for k in (1, len(path.factors) // 2, len(path.factors) - 1):
        found = solved(rod.scaled(float(path.factors[k])), 8)
        np.testing.assert_allclose(path.tips[k], found.tips[0], rtol=0, atol=1e-9)
        np.testing.assert_array_equal(path.ends[k][-1], path.tips[k])


def test_it_passes_the_limit_and_comes_back() -> None:
    """Stable up to the limit, unstable beyond it, stable again behind the second one."""
    path = follow_path(arch(40.0), step=0.02, steps=250, modes=7)
    assert len(path.limits) == 2
    first, second = path.limits
    assert first > second
    turns = np.flatnonzero(np.diff(np.sign(np.diff(path.factors)))) + 1
    assert path.stable[1 : turns[0]].all()
    assert not path.stable[turns[0] + 1 : turns[1]].any()
    assert path.stable[turns[1] + 1 :].all()


def test_a_shape_without_loads_is_stable() -> None:
    """A hinged and held rod as well, though its hinge alone has no stiffness."""
    path = follow_path(arch(1.0), steps=2)
    assert path.stable[0]


@pytest.mark.parametrize("force", [20.0, 2000.0])
def test_the_size_of_the_load_does_not_count(force: float) -> None:
    """An arch too flat to snap goes down under whatever is asked for.

    With a compliance the residual is quadratic in the load.
    """
    path = follow_path(arch(force, 1.4), step=0.05, steps=60, modes=7)
    assert path.status is not PathStatus.STEPS_TOO_SMALL
    assert np.all(np.diff(path.factors) > 0)


def test_a_path_ends_at_the_load_that_was_asked_for() -> None:
    """And at the tip that the rod has there."""
    law = SectionLaw(np.diag([1.0, 1.0, 0.7]), np.zeros((3, 3)), np.zeros((3, 3)), (0, 1, 2))
    end = PointLoad(force=np.array([10.0, 0.0, 0.0]))
    rod = Rod((Segment(1.0, law, end=end),))
    path = follow_path(rod)
    assert path.status is PathStatus.FULL_LOAD
    assert path.factors[-1] == 1.0
    tip = StrainModes().solve(rod, rod.rest[None], 12).tips[0]
    np.testing.assert_allclose(path.tips[-1], tip, rtol=0, atol=1e-9)


def test_a_tip_that_is_held_elsewhere_is_refused() -> None:
    law = SectionLaw(np.diag([1.0, 1.0, 0.7]), np.zeros((3, 3)), np.zeros((3, 3)), (0, 1, 2))
    with pytest.raises(ValueError, match="held where it is without loads"):
        follow_path(Rod((Segment(1.0, law),), tip=Tip(position=np.array([0.3, 0.0, 0.8]))))
