"""Integrals along edges against closed forms, triangles and elements."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beamopt.base.arrays import FloatArray
from beamopt.outline.green import loop_integrals


def rectangle(x: tuple[float, float], y: tuple[float, float]) -> FloatArray:
    return np.array([[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]])


def star(seed: int, corners: int = 9) -> FloatArray:
    """A simple polygon about (3, −2), neither convex nor symmetric."""
    rng = np.random.default_rng(seed)
    phi = np.sort(rng.uniform(0, 2 * np.pi, corners))
    phi = np.arange(corners) * 2 * np.pi / corners + 0.3 * phi / corners
    radius = rng.uniform(1, 5, corners)
    return np.stack([3 + radius * np.cos(phi), -2 + radius * np.sin(phi)], axis=1)


def by_triangles(points: FloatArray, apex: FloatArray) -> FloatArray:
    """A fan of signed triangles; the rule of edge midpoints is exact for second order."""
    total = np.zeros(6)
    for a, b in zip(points, np.roll(points, -1, axis=0), strict=True):
        u, v = a - apex, b - apex
        area = (u[0] * v[1] - u[1] * v[0]) / 2
        for x, y in ((apex + a) / 2, (a + b) / 2, (b + apex) / 2):
            total += area / 3 * np.array([1, x, y, x * x, y * y, x * y])
    return total


def test_a_rectangle() -> None:
    (a, b), (c, d) = (1.0, 4.0), (-2.0, 3.0)
    expected = [
        (b - a) * (d - c),
        (b**2 - a**2) / 2 * (d - c),
        (b - a) * (d**2 - c**2) / 2,
        (b**3 - a**3) / 3 * (d - c),
        (b - a) * (d**3 - c**3) / 3,
        (b**2 - a**2) / 2 * (d**2 - c**2) / 2,
    ]
    np.testing.assert_allclose(loop_integrals(rectangle((a, b), (c, d))), expected, rtol=1e-14)


@pytest.mark.parametrize("n", [3, 4, 7, 100])
def test_a_regular_polygon(n: int) -> None:
    """A = n/2 R² sin 2π/n and ∫x² = ∫y² = A R²/12 (2 + cos 2π/n), for n > 2."""
    R, angle = 3.0, 2 * np.pi / n
    area = n / 2 * R**2 * np.sin(angle)
    second = area * R**2 / 12 * (2 + np.cos(angle))
    phi = angle * np.arange(n)
    found = loop_integrals(R * np.stack([np.cos(phi), np.sin(phi)], axis=1))
    np.testing.assert_allclose(found, [area, 0, 0, second, second, 0], atol=1e-12)


@given(st.integers(0, 10_000))
def test_triangles_say_the_same(seed: int) -> None:
    points = star(seed)
    apex = np.array([-7.0, 11.0])
    np.testing.assert_allclose(loop_integrals(points), by_triangles(points, apex), rtol=1e-10)


def test_the_other_way_round_is_negative() -> None:
    points = star(1)
    np.testing.assert_allclose(loop_integrals(points[::-1]), -loop_integrals(points), rtol=1e-12)


@given(st.integers(0, 10_000), st.floats(-50, 50), st.floats(-50, 50), st.floats(0, 7))
def test_moved_and_turned(seed: int, dx: float, dy: float, turn: float) -> None:
    """Moments move by Steiner's theorem, and turn as a tensor."""
    points = star(seed)
    A, sx, sy, sxx, syy, sxy = loop_integrals(points)
    c, s = np.cos(turn), np.sin(turn)
    Q = np.array([[c, -s], [s, c]])
    d = np.array([dx, dy])
    first = Q @ [sx, sy]
    second = Q @ [[sxx, sxy], [sxy, syy]] @ Q.T
    second = second + np.outer(first, d) + np.outer(d, first) + A * np.outer(d, d)
    first = first + A * d
    expected = [A, *first, second[0, 0], second[1, 1], second[0, 1]]
    np.testing.assert_allclose(loop_integrals(points @ Q.T + d), expected, rtol=1e-9, atol=1e-9)


def test_a_small_loop_far_away_keeps_its_digits() -> None:
    tiny = rectangle((24.0, 24.0 + 2**-20), (7.0, 7.0 + 2**-20))
    assert loop_integrals(tiny)[0] == pytest.approx(2.0**-40, rel=1e-14)
