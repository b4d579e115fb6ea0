"""The closed-form arc against integration of the rod's kinematics."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from beamopt.base.arrays import FloatArray
from beamopt.rod.arc import (
    SERIES_BELOW,
    arc_centreline,
    arc_tip_jacobian,
    arc_tip_jacobian_by_response,
    arc_tips,
)

LENGTH = 100.0


def integrated(strains: FloatArray, stations: FloatArray) -> FloatArray:
    """h(s) from h' = R v, R' = R [u]× with v = (0, 0, 1 + ε), u = (κ1, κ2, 0)."""
    epsilon, k1, k2 = strains
    v = np.array([0, 0, 1 + epsilon])
    hat = np.array([[0, 0, k2], [0, 0, -k1], [-k2, k1, 0]])

    def rate(_: float, state: FloatArray) -> FloatArray:
        R = state[3:].reshape(3, 3)
        return np.concatenate([R @ v, (R @ hat).ravel()])

    start = np.concatenate([np.zeros(3), np.eye(3).ravel()])
    end = float(stations[-1])
    result = solve_ivp(
        rate, (0, end), start, method="DOP853", t_eval=stations, rtol=1e-12, atol=1e-12
    )
    return np.asarray(result.y[:3].T)


def strains_of(angle: float, direction: float, epsilon: float) -> FloatArray:
    """Curvature `angle`/H about the axis at `direction` [rad] from x."""
    k = angle / LENGTH
    return np.array([epsilon, k * np.cos(direction), k * np.sin(direction)])


@pytest.mark.parametrize("angle", [0.0, 1e-6, 0.1, 0.22, 0.3, 1.0, 3.0, 6.0, 12.0])
@pytest.mark.parametrize("direction", [0.0, 0.7, 2.5, -1.6])
def test_tips_agree_with_integration(angle: float, direction: float) -> None:
    strains = strains_of(angle, direction, 0.13)
    expected = integrated(strains, np.array([LENGTH]))[0]
    # the integration's own error, 1e-12 a step over some dozen steps of a length of 113 mm
    np.testing.assert_allclose(arc_tips(strains, LENGTH), expected, rtol=0, atol=1e-8)


def test_centreline_agrees_with_integration() -> None:
    strains = strains_of(4.0, 1.0, -0.05)
    stations = np.linspace(0, LENGTH, 9)
    found = arc_centreline(strains, stations)
    np.testing.assert_allclose(found, integrated(strains, stations), rtol=0, atol=1e-8)


def test_curvature_about_x_bends_to_minus_y() -> None:
    """Along κ × e3 / |κ|: about x to −y, about y to x."""
    about_x = arc_tips(strains_of(1.0, 0.0, 0.0), LENGTH)
    np.testing.assert_allclose(
        about_x, [0, -LENGTH * (1 - np.cos(1.0)), LENGTH * np.sin(1.0)], atol=1e-12
    )
    about_y = arc_tips(strains_of(1.0, np.pi / 2, 0.0), LENGTH)
    np.testing.assert_allclose(
        about_y, [LENGTH * (1 - np.cos(1.0)), 0, LENGTH * np.sin(1.0)], atol=1e-12
    )


def test_a_straight_rod_stretches() -> None:
    tip = arc_tips(np.array([0.2, 0.0, 0.0]), LENGTH)
    np.testing.assert_array_equal(tip, [0, 0, 120.0])


@pytest.mark.parametrize("angle", [1e-3, 1e-5, 1e-8, 1e-12, 1e-160, 1e-300])
def test_the_straight_limit_is_continuous(angle: float) -> None:
    """Tip ≈ H (θ/2 − θ³/24, 1 − θ²/6); what is left out is below θ⁴/120 of that."""
    tip = arc_tips(strains_of(angle, np.pi / 2, 0.0), LENGTH)
    assert tip[0] == pytest.approx(LENGTH * (angle / 2 - angle**3 / 24), rel=1e-12)
    assert tip[2] == pytest.approx(LENGTH * (1 - angle**2 / 6), rel=1e-12)


@pytest.mark.parametrize("turns", [1, 2])
def test_whole_circles_close(turns: int) -> None:
    tip = arc_tips(strains_of(2 * np.pi * turns, 0.4, 0.3), LENGTH)
    np.testing.assert_allclose(tip, 0, atol=1e-13 * LENGTH)


def test_a_half_circle_has_its_diameter() -> None:
    tip = arc_tips(strains_of(np.pi, np.pi / 2, 0.0), LENGTH)
    np.testing.assert_allclose(tip, [2 * LENGTH / np.pi, 0, 0], atol=1e-12)


@given(st.floats(-20, 20), st.floats(-4, 4), st.floats(-0.5, 2))
def test_the_tip_lies_on_the_chord_of_the_arc(
    angle: float, direction: float, epsilon: float
) -> None:
    """|h| = H (1 + ε) |sin(θ/2)/(θ/2)|, at θ/2 from the rod's axis."""
    tip = arc_tips(strains_of(angle, direction, epsilon), LENGTH)
    scale = LENGTH * (1 + epsilon)
    chord = scale * np.sinc(angle / (2 * np.pi))
    assert np.linalg.norm(tip) == pytest.approx(abs(chord), abs=1e-11)
    assert tip[2] == pytest.approx(chord * np.cos(angle / 2), abs=1e-11)


def by_differences(strains: FloatArray, step: FloatArray) -> FloatArray:
    """Sixth-order central differences of the tip by each strain."""
    columns = []
    for i in range(3):
        total = np.zeros(3)
        for k, weight in ((1, 45 / 60), (2, -9 / 60), (3, 1 / 60)):
            shift = np.zeros(3)
            shift[i] = k * step[i]
            total += weight * (
                arc_tips(strains + shift, LENGTH) - arc_tips(strains - shift, LENGTH)
            )
        columns.append(total / step[i])
    return np.stack(columns, axis=1)


SWITCH = float(np.sqrt(SERIES_BELOW))


@pytest.mark.parametrize(
    "angle",
    [0.0, 1e-9, 1e-3, 0.1, SWITCH * 0.999, SWITCH, SWITCH * 1.001, 0.5, 2.0, 2 * np.pi, 9.0],
)
@pytest.mark.parametrize("direction", [0.0, 0.9, 4.0])
def test_jacobian_agrees_with_differences(angle: float, direction: float) -> None:
    strains = strains_of(angle, direction, 0.1)
    # angles change by 0.02: truncation 0.02⁶/140, rounding 1e-16/0.02, relative to H and H²
    step = np.array([0.02, 0.02 / LENGTH, 0.02 / LENGTH])
    error = arc_tip_jacobian(strains, LENGTH) - by_differences(strains, step)
    np.testing.assert_allclose(error * np.array([1, 1 / LENGTH, 1 / LENGTH]), 0, atol=1e-10)


@pytest.mark.parametrize("direction", [0.0, 0.9])
def test_the_series_goes_over_into_the_formula(direction: float) -> None:
    """Just below and just above the switch; the true change over the gap is some 1e-13."""
    below, above = (
        arc_tip_jacobian(strains_of(SWITCH * (1 + s), direction, 0.1), LENGTH)
        for s in (-1e-13, 1e-13)
    )
    size = LENGTH**2
    np.testing.assert_allclose(above, below, rtol=0, atol=1e-12 * size)


def test_jacobian_of_the_straight_rod() -> None:
    """Tip = H (1 + ε) (κ2 H/2, −κ1 H/2, 1) to first order."""
    found = arc_tip_jacobian(np.array([0.1, 0.0, 0.0]), LENGTH)
    half = 1.1 * LENGTH**2 / 2
    np.testing.assert_allclose(found, [[0, 0, half], [0, -half, 0], [LENGTH, 0, 0]], rtol=1e-15)


def test_the_centreline_runs_from_the_base_to_the_tip() -> None:
    strains = strains_of(2.0, 0.3, 0.1)
    line = arc_centreline(strains, np.linspace(0, LENGTH, 400))
    np.testing.assert_array_equal(line[0], np.zeros(3))
    np.testing.assert_array_equal(line[-1], arc_tips(strains, LENGTH))
    # a polyline of n chords is θ²/(24 n²) shorter than the arc
    length = np.linalg.norm(np.diff(line, axis=0), axis=1).sum()
    assert length == pytest.approx(1.1 * LENGTH, rel=2e-6)


def test_batches_equal_one_by_one() -> None:
    rng = np.random.default_rng(1)
    strains = rng.normal(size=(2, 3, 4, 3)) * np.array([0.1, 0.02, 0.02])
    strains[0, 0, 0] = 0  # straight among curved
    flat = strains.reshape(-1, 3)
    stations = np.linspace(0, LENGTH, 5)
    for function, argument, shape in (
        (arc_tips, LENGTH, (3,)),
        (arc_tip_jacobian, LENGTH, (3, 3)),
        (arc_centreline, stations, (5, 3)),
    ):
        together = function(strains, argument)
        assert together.shape == (2, 3, 4, *shape)
        expected = np.stack([function(one, argument) for one in flat])
        # vectorised sine and cosine may differ from scalar ones in the last bit
        np.testing.assert_allclose(
            together.reshape(expected.shape), expected, rtol=1e-14, atol=1e-11
        )


def test_derivatives_by_the_response_matrix() -> None:
    """Against central differences; their error is the square of the step."""
    rng = np.random.default_rng(5)
    matrix = rng.normal(size=(3, 3)) * [[1e-3], [1e-4], [1e-4]]
    pressures = rng.uniform(0, 100, (4, 3))

    def tips(m: np.ndarray) -> np.ndarray:
        return arc_tips(pressures @ m.T, 100.0)

    exact = arc_tip_jacobian_by_response(pressures @ matrix.T, pressures, 100.0)
    assert exact.shape == (4, 3, 3, 3)
    for i in range(3):
        for j in range(3):
            step = np.zeros((3, 3))
            step[i, j] = 1e-6 * (1.0 if i == 0 else 1e-2)
            slope = (tips(matrix + step) - tips(matrix - step)) / (2 * step[i, j])
            np.testing.assert_allclose(exact[:, :, i, j], slope, rtol=1e-6, atol=1e-2)
