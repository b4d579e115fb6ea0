"""A thread: its energy's derivatives, what it does in the toe, beyond it and in compression."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from femcheck.material.fibre import Thread

K, TOE = 300.0, 0.02
THREAD = Thread(K, TOE)
STRAINS = st.floats(-0.5, 0.5)


def one(of: object, strain: float) -> float:
    return float(of(np.array([strain]))[0])  # type: ignore[operator]


@given(STRAINS)
def test_tension_and_slope_are_derivatives(strain: float) -> None:
    """Central differences; at the ends of the toe the slope has a kink, and they are h K/t off."""
    h = 1e-6
    for value, derivative in (
        (THREAD.energy, THREAD.tension),
        (THREAD.tension, THREAD.slope),
    ):
        measured = (one(value, strain + h) - one(value, strain - h)) / (2 * h)
        assert one(derivative, strain) == pytest.approx(measured, abs=2 * h * K / TOE)


@given(STRAINS, st.floats(0, 1e-3))
def test_twice_continuously_differentiable(strain: float, step: float) -> None:
    """The slope's own slope is nowhere more than K/t."""
    change = one(THREAD.slope, strain + step) - one(THREAD.slope, strain)
    assert -1e-12 <= change <= K / TOE * step * (1 + 1e-9) + 1e-9


@given(st.floats(-0.9, 0))
def test_slack_in_compression(strain: float) -> None:
    for part in (THREAD.energy, THREAD.tension, THREAD.slope):
        assert one(part, strain) == 0


@given(st.floats(TOE, 2.0))
def test_beyond_the_toe_a_spring_half_a_toe_too_long(strain: float) -> None:
    """Tension k (e − t/2); energy k (e − t/2)²/2 + k t²/24, the toe's share of it k t²/6."""
    assert one(THREAD.slope, strain) == K
    assert one(THREAD.tension, strain) == pytest.approx(K * (strain - TOE / 2), rel=1e-12)
    energy = K * ((strain - TOE / 2) ** 2 / 2 + TOE**2 / 24)
    assert one(THREAD.energy, strain) == pytest.approx(energy, rel=1e-12)
    assert one(THREAD.energy, TOE) == pytest.approx(K * TOE**2 / 6, rel=1e-12)


def test_within_the_toe_tension_rises_with_the_square() -> None:
    strain = np.linspace(0, TOE, 7)
    np.testing.assert_allclose(THREAD.tension(strain), K * strain**2 / (2 * TOE), rtol=1e-12)


def test_arrays_of_any_shape() -> None:
    strain = np.linspace(-0.1, 0.1, 6).reshape(2, 3)
    for part in (THREAD.energy, THREAD.tension, THREAD.slope):
        assert part(strain).shape == (2, 3)


@pytest.mark.parametrize("value", [0.0, -1.0, np.nan, np.inf])
@pytest.mark.parametrize("name", ["stiffness", "toe"])
def test_refusals(name: str, value: float) -> None:
    with pytest.raises(ValueError, match=rf"{name} = .*: must be above 0"):
        Thread(**{"stiffness": 100.0, name: value})
