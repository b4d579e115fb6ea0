"""Orders of convergence, and what is exact."""

from __future__ import annotations

import numpy as np
import pytest

from beamopt.comparators.collocation import Collocation
from beamopt.comparators.multiple_shooting import MultipleShooting
from beamopt.comparators.shooting import Shooting
from beamopt.rod.arc import arc_tips
from beamopt.rod.solution import Method
from tests.beamopt.comparators.loaded_rods import (
    MAGNUS,
    RUNGE_KUTTA,
    cantilever,
    rigid_in_stretch,
    solve,
    tangle,
)


@pytest.mark.parametrize("method", [Shooting(RUNGE_KUTTA), Shooting(MAGNUS)])
def test_both_steps_are_of_order_four(method: Method) -> None:
    fine = solve(method, tangle(), 640).tips
    errors = [np.linalg.norm(solve(method, tangle(), n).tips - fine) for n in (20, 40, 80)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4, abs=0.3)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(4, abs=0.2)


@pytest.mark.parametrize("stepper", [RUNGE_KUTTA, MAGNUS])
def test_intervals_do_not_change_the_discretisation(stepper: int) -> None:
    """Multiple shooting solves the same discrete equations as single shooting."""
    steps = [MAGNUS, RUNGE_KUTTA][stepper == RUNGE_KUTTA]
    one = solve(Shooting(steps), tangle(), 40)
    for intervals in (1, 3, 40):
        other = solve(MultipleShooting(steps, intervals=intervals), tangle(), 40)
        assert other.tips == pytest.approx(one.tips, abs=1e-8)


def test_the_tolerance_of_the_collocation_is_kept() -> None:
    fine = solve(Shooting(MAGNUS), tangle(), 300).tips
    for resolution in (3, 5, 7):
        error = np.linalg.norm(solve(Collocation(), tangle(), resolution).tips - fine)
        assert error < 10.0**-resolution * tangle().length


def test_a_magnus_step_follows_an_arc_exactly() -> None:
    rest = np.array([[[0.02, -0.03, 0.0, 0.0, 0.0, 1.1]]])
    found = Shooting(MAGNUS).solve(cantilever(100.0, rigid_in_stretch(1e4)), rest, 1)
    expected = arc_tips(np.array([[0.1, 0.02, -0.03]]), 100.0)
    assert found.tips == pytest.approx(expected, abs=1e-11)
