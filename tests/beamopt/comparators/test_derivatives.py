"""Jacobians against finite differences."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from beamopt.base.arrays import FloatArray
from beamopt.comparators.loaded import Loaded, loaded_rod
from beamopt.comparators.quaternion_form import boundary, jacobians, slopes
from beamopt.comparators.sweep import WORK, advance, leftover, segments_of
from tests.beamopt.comparators.loaded_rods import MAGNUS, RUNGE_KUTTA, tangle

STEP = 1e-5


def central(function: Callable[[FloatArray], FloatArray], at: FloatArray) -> FloatArray:
    """(m, n) differences of order four."""
    columns = []
    for i in range(len(at)):
        d = np.zeros(len(at))
        d[i] = STEP
        near = function(at + d) - function(at - d)
        far = function(at + 2 * d) - function(at - 2 * d)
        columns.append((8 * near - far) / (12 * STEP))
    return np.column_stack(columns)


def model(held: bool = False) -> Loaded:
    made = loaded_rod(tangle(), 4)
    place, frame = np.array([0.1, 0.2, 0.3]), Rotation.from_rotvec([1.0, 0.2, 0.4]).as_matrix()
    return made._replace(held=np.array([held, held]), place=place, frame=frame)


@pytest.mark.parametrize("stepper", [RUNGE_KUTTA, MAGNUS])
@pytest.mark.parametrize("held", [False, True])
def test_from_the_base_to_what_is_left_at_the_tip(stepper: int, held: bool) -> None:
    """Kinks, steps, point loads and the tip's conditions, by φ, n, m at the base."""
    rod = model(held)
    segments = segments_of(rod.steps)

    def shoot(at: FloatArray, columns: int) -> tuple[FloatArray, FloatArray]:
        frame = Rotation.from_rotvec(at[:3]).as_matrix() @ rod.base
        state, work = np.zeros((12, 1 + columns)), np.empty((WORK, 1 + columns))
        state[6:, 0] = at[3:]
        for j in range(columns):
            state[3 + j, 1 + j] = 1.0
        for step in range(len(segments)):
            advance(int(stepper), rod, segments, step, frame, state, work)
        left, rows = np.empty(6), np.empty((6, 12))
        leftover(rod, frame, state, left, rows)
        return left, rows @ state[:, 1:]

    at = np.array([0.0, 0.0, 0.0, 1.0, -0.7, 0.4, 0.5, 0.9, -0.3])
    _, exact = shoot(at, 9)
    differences = central(lambda x: shoot(x, 0)[0], at)
    assert exact == pytest.approx(differences, abs=2e-9 * np.max(abs(exact)))


def test_quaternion_form() -> None:
    rod = model()
    y = np.random.default_rng(3).normal(size=(26, 2))
    exact = jacobians(rod, y)
    for j in range(2):
        differences = central(
            lambda x, j=j: slopes(rod, np.column_stack([x, y[:, 1 - j]]))[0][:, 0], y[:, j]
        )
        assert exact[:, :, j] == pytest.approx(differences, abs=1e-8 * np.max(abs(exact)))


@pytest.mark.parametrize("held", [False, True])
def test_boundary(held: bool) -> None:
    rod = model(held)
    ends = np.random.default_rng(4).normal(size=52)
    exact = boundary(rod, ends[:26].copy(), ends[26:].copy())
    differences = central(lambda x: boundary(rod, x[:26].copy(), x[26:].copy())[:, 0], ends)
    assert exact[:, 1:] == pytest.approx(differences, abs=1e-8 * np.max(abs(exact)))
