"""Following the loads, on equations with one unknown."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from beamopt.base.arrays import FloatArray
from beamopt.comparators.following import Attempt, follow, solve_cases
from beamopt.rod.status import RodStatus


class Scalar:
    """load(x) = factor, x by Newton's method with at most four iterations; x ≥ 1 is crushed."""

    def __init__(self, load: Callable[[float], float], slope: Callable[[float], float]) -> None:
        self.load, self.slope = load, slope
        self.tried: list[float] = []

    def unloaded(self) -> float:
        return 0.0

    def attempt(self, guess: float, factor: float, seconds: float) -> Attempt[float]:
        self.tried.append(factor)
        x = guess
        for iteration in range(5):
            left = self.load(x) - factor
            if abs(left) < 1e-12:
                status = RodStatus.CONVERGED if x < 1 else RodStatus.CRUSHED
                return Attempt(status, x, iteration)
            x -= left / self.slope(x)
        return Attempt(RodStatus.DIVERGED, x, 5)

    def drawn(self, shape: float) -> tuple[FloatArray, FloatArray]:
        return np.array([[0.0, 0.0, 0.0], [shape, 0.0, 1.0]]), np.eye(3)


def linear(stiffness: float) -> Scalar:
    return Scalar(lambda x: stiffness * x, lambda x: stiffness)


def with_a_limit_point() -> Scalar:
    """4 · 0.7 x (1 − x) has its maximum 0.7 at x = 0.5."""
    return Scalar(lambda x: 2.8 * x * (1 - x), lambda x: 2.8 - 5.6 * x)


def test_all_at_once_if_that_converges() -> None:
    case = linear(2.0)
    found = follow(case, None)
    assert (found.status, found.shape, found.factor) == (RodStatus.CONVERGED, 0.5, 1.0)
    assert case.tried == [1.0]


def test_a_first_step() -> None:
    case = linear(2.0)
    follow(case, None, step=0.25)
    assert case.tried == [0.25, 0.75, 1.0]


def test_steps_get_too_small_at_a_limit_point() -> None:
    found = follow(with_a_limit_point(), None)
    assert found.status is RodStatus.STEPS_TOO_SMALL
    assert found.factor == pytest.approx(0.7, abs=2e-3)
    assert found.factor < 0.7


def test_crushed_halfway() -> None:
    found = follow(linear(0.5), None)
    assert found.status is RodStatus.CRUSHED
    assert found.factor == pytest.approx(0.5, abs=1e-3)


def test_no_way_at_all() -> None:
    found = follow(Scalar(lambda x: np.nan, lambda x: 1.0), None)
    assert (found.status, found.factor) == (RodStatus.DIVERGED, 0.0)


def test_one_failure_does_not_spoil_the_next() -> None:
    cases = [linear(2.5), with_a_limit_point(), linear(4.0)]
    found = solve_cases(cases, np.array([0.0, 1.0]), 10.0, 1.0)
    assert found.converged.tolist() == [True, False, True]
    assert found.tips[[0, 2], 0] == pytest.approx([0.4, 0.25])
    assert np.isnan(found.centrelines[1]).all()
    assert found.factor[1] < 1
