"""Rotations along a rod: exponential, logarithm, and steps of sixth order."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from beamopt.base.arrays import FloatArray
from beamopt.rod.rotation import GAUSS_3, magnus_step, multiply_rotation, rotation_vector

angles = st.floats(0, np.pi)
directions = st.tuples(*(st.floats(-1, 1),) * 3).filter(lambda d: np.linalg.norm(d) > 0.1)


def exponential(vector: FloatArray) -> FloatArray:
    rotation = np.eye(3)
    multiply_rotation(rotation, tuple(vector))
    return rotation


def unit(direction: tuple[float, float, float]) -> FloatArray:
    return np.array(direction) / np.linalg.norm(direction)


@given(st.floats(0, 40), directions)
def test_the_exponential_is_the_rotation(
    angle: float, direction: tuple[float, float, float]
) -> None:
    vector = angle * unit(direction)
    expected = Rotation.from_rotvec(vector).as_matrix()
    np.testing.assert_allclose(exponential(vector), expected, atol=1e-14 * (1 + angle))


@pytest.mark.parametrize("angle", [0.0, 1e-200, 1e-9, 0.99e-4, 1.01e-4, 1e-3])
def test_small_rotations(angle: float) -> None:
    vector = angle * unit((1.0, -2.0, 0.5))
    expected = Rotation.from_rotvec(vector).as_matrix()
    np.testing.assert_allclose(exponential(vector), expected, rtol=0, atol=3e-16)
    np.testing.assert_allclose(rotation_vector(expected), vector, rtol=1e-12, atol=1e-300)


@given(st.floats(0, 3.1), directions)
def test_the_logarithm_undoes_the_exponential(
    angle: float, direction: tuple[float, float, float]
) -> None:
    """Up to 0.04 from a half turn, where rounding is magnified 25 times."""
    vector = angle * unit(direction)
    np.testing.assert_allclose(rotation_vector(exponential(vector)), vector, atol=1e-13)


@given(st.floats(-9, -2), directions)
def test_near_a_half_turn(power: float, direction: tuple[float, float, float]) -> None:
    """Within 1e-6 of it the angle is π and the axis that of a half turn: 1e-6 off."""
    rotation = exponential((np.pi - 10.0**power) * unit(direction))
    found = np.array(rotation_vector(rotation))
    assert np.linalg.norm(found) <= np.pi + 1e-15
    tolerance = 3e-6 if power < -5.9 else 1e-9
    np.testing.assert_allclose(exponential(found), rotation, atol=tolerance)


@given(directions)
def test_half_turns(direction: tuple[float, float, float]) -> None:
    axis = unit(direction)
    found = np.array(rotation_vector(2 * np.outer(axis, axis) - np.eye(3)))
    assert np.linalg.norm(found) == pytest.approx(np.pi, rel=1e-12)
    np.testing.assert_allclose(abs(found @ axis), np.pi, rtol=1e-12)


@pytest.mark.parametrize("axis", range(3))
def test_half_turns_about_the_axes(axis: int) -> None:
    """Two components of the axis are zero, of either sign."""
    e = np.eye(3)[axis]
    for sign in (1.0, -1.0):
        found = rotation_vector(exponential(sign * np.pi * e))
        np.testing.assert_allclose(np.abs(found), np.pi * e, atol=1e-15)


def curvature(s: FloatArray) -> FloatArray:
    """(…, 3) that turns by some 3 rad, about axes that do not commute."""
    return np.stack([3 * np.cos(2 * s), 2 * np.sin(3 * s) + s, 1 - 2 * s**2], axis=-1)


def stepped(steps: int) -> FloatArray:
    """R(1) in equal steps."""
    h = 1 / steps
    at = h * (np.arange(steps)[:, None] + GAUSS_3)
    rotation = np.eye(3)
    for k in range(steps):
        multiply_rotation(rotation, magnus_step(curvature(at), k, h))
    return rotation


def test_steps_are_of_sixth_order() -> None:
    def rate(s: float, state: FloatArray) -> FloatArray:
        x, y, z = curvature(np.array(s))
        spin = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        return np.asarray((state.reshape(3, 3) @ spin).ravel())

    end = solve_ivp(rate, (0, 1), np.eye(3).ravel(), "DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
    errors = [float(np.abs(stepped(n) - end.reshape(3, 3)).max()) for n in (4, 8, 16)]
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert np.all((orders > 5.6) & (orders < 6.8)), orders
    assert errors[-1] < 1e-8


def test_a_step_of_constant_curvature_is_exact() -> None:
    u = np.array([0.4, -2.0, 1.1])
    found = magnus_step(np.tile(u, (1, 3, 1)), 0, 0.7)
    np.testing.assert_allclose(found, 0.7 * u, rtol=1e-15)
