"""The rod's equations in h, q, n, m, all segments side by side on the interval 0…1."""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.compiled import compiled
from beamopt.comparators.loaded import Loaded
from beamopt.comparators.runge_kutta import slope_of, turned_by
from beamopt.comparators.se3 import exponential
from beamopt.comparators.sweep import WORK, leftover, pass_load

__all__ = ["arcs_at_rest", "boundary", "jacobians", "rotation_of", "slopes"]


@compiled
def slopes(rod: Loaded, y: FloatArray) -> tuple[FloatArray, float]:
    """Derivatives (13 s, m) of the unknowns y at m points, and the least v3 there."""
    result = np.empty(y.shape)
    x, slope, state = np.empty((13, 1)), np.empty((13, 1)), np.zeros((12, 1))
    turned, work, same = np.empty((3, 3)), np.empty((WORK, 1)), np.eye(3)
    least = np.inf
    for k in range(len(rod.lengths)):
        for j in range(y.shape[1]):
            for i in range(13):
                x[i, 0] = y[13 * k + i, j]
            v3 = slope_of(rod, k, same, state, x, slope, turned, work)
            if not v3 >= least:
                least = v3
            for i in range(13):
                result[13 * k + i, j] = rod.lengths[k] * slope[i, 0]
    return result, least


@compiled
def jacobians(rod: Loaded, y: FloatArray) -> FloatArray:
    """(13 s, 13 s, m) derivatives of the slopes by the unknowns; they do not depend on h."""
    n, m = y.shape
    result = np.zeros((n, n, m))
    x, slope, state = np.zeros((13, 11)), np.empty((13, 11)), np.zeros((12, 11))
    turned, work, same = np.empty((3, 3)), np.empty((WORK, 11)), np.eye(3)
    for i in range(10):
        x[3 + i, 1 + i] = 1.0
    for k in range(len(rod.lengths)):
        for j in range(m):
            for i in range(13):
                x[i, 0] = y[13 * k + i, j]
            slope_of(rod, k, same, state, x, slope, turned, work)
            for i in range(13):
                for c in range(10):
                    result[13 * k + i, 13 * k + 3 + c, j] = rod.lengths[k] * slope[i, 1 + c]
    return result


@compiled
def boundary(rod: Loaded, start: FloatArray, end: FloatArray) -> FloatArray:
    """What is wrong at the ends, in column 0 of (13 s, 1 + 26 s), and its derivatives.

    start, end : (13 s,) unknowns at 0 and at 1, by which the derivatives are, in this order.
    Rows: h and q at the base (7), h, q, n, m where segments meet (13 each), the tip (6).
    """
    n = len(start)
    result = np.zeros((n, 1 + 2 * n))
    x, state, same = np.zeros((13, 14)), np.empty((12, 14)), np.eye(3)
    turned, left, rows = np.empty((3, 3)), np.empty(6), np.empty((6, 12))
    first = _after_kink(rod.kinks[0], _quaternion(rod.base))
    for i in range(7):
        result[i, 0] = start[i] - (0.0 if i < 3 else first[i - 3])
        result[i, 1 + i] = 1.0
    for i in range(13):
        x[i, 1 + i] = 1.0
    for k in range(n // 13):
        at, row = 13 * k, 13 * k + 7
        for i in range(13):
            x[i, 0] = end[at + i]
        for j in range(14):
            for i in range(3):
                state[i, j] = x[i, j]
                state[3 + i, j] = 0.0
                state[6 + i, j] = x[7 + i, j]
                state[9 + i, j] = x[10 + i, j]
        turned_by(x, same, state[3:6], turned)
        pass_load(rod.end[k], turned, state)
        if at + 13 == n:
            leftover(rod, turned, state, left, rows)
            for i in range(6):
                result[row + i, 0] = left[i]
                for c in range(13):
                    for r in range(12):
                        result[row + i, 1 + n + at + c] += rows[i, r] * state[r, 1 + c]
        else:
            _meet(rod.kinks[k + 1], start[at + 13 : at + 26], x, state, result[row:], at)
    return result


@compiled
def _meet(
    kink: FloatArray, after: FloatArray, x: FloatArray, state: FloatArray, rows: FloatArray, at: int
) -> None:
    """Rows of the place where the segment of unknowns `at`… meets the next, `after` (13,)."""
    n = rows.shape[1] // 2
    for i in range(13):
        rows[i, 0] = after[i]
        rows[i, 1 + at + 13 + i] = 1.0
    for c in range(14):
        column = 0 if c == 0 else n + at + c
        q = _after_kink(kink, x[3:7, c].copy())
        for i in range(3):
            rows[i, column] -= state[i, c]
            rows[7 + i, column] -= state[6 + i, c]
            rows[10 + i, column] -= state[9 + i, c]
        for i in range(4):
            rows[3 + i, column] -= q[i]


@compiled
def _after_kink(kink: FloatArray, q: FloatArray) -> FloatArray:
    """(4,) quaternion of R(q) kink."""
    return _product(q, _quaternion(kink))


@compiled
def _product(q: FloatArray, p: FloatArray) -> FloatArray:
    """(4,) quaternion q p."""
    result = np.empty(4)
    result[0] = q[0] * p[0] - q[1] * p[1] - q[2] * p[2] - q[3] * p[3]
    result[1] = q[0] * p[1] + q[1] * p[0] + q[2] * p[3] - q[3] * p[2]
    result[2] = q[0] * p[2] + q[2] * p[0] + q[3] * p[1] - q[1] * p[3]
    result[3] = q[0] * p[3] + q[3] * p[0] + q[1] * p[2] - q[2] * p[1]
    return result


@compiled
def _quaternion(frame: FloatArray) -> FloatArray:
    """(4,) of a rotation (3, 3), by the largest of its components (Shepperd 1978)."""
    a, b, c = frame[0, 0], frame[1, 1], frame[2, 2]
    x, y, z = (
        frame[2, 1] - frame[1, 2],
        frame[0, 2] - frame[2, 0],
        frame[1, 0] - frame[0, 1],
    )
    q = np.empty(4)
    trace = a + b + c
    if trace >= max(a, b, c):
        q[0], q[1], q[2], q[3] = 1 + trace, x, y, z
    elif a >= max(b, c):
        q[0], q[1] = x, 1 + a - b - c
        q[2], q[3] = frame[0, 1] + frame[1, 0], frame[0, 2] + frame[2, 0]
    elif b >= c:
        q[0], q[2] = y, 1 + b - a - c
        q[1], q[3] = frame[0, 1] + frame[1, 0], frame[1, 2] + frame[2, 1]
    else:
        q[0], q[3] = z, 1 + c - a - b
        q[1], q[2] = frame[0, 2] + frame[2, 0], frame[1, 2] + frame[2, 1]
    size = np.sqrt(q[0] ** 2 + q[1] ** 2 + q[2] ** 2 + q[3] ** 2)
    for i in range(4):
        q[i] /= size
    return q


@compiled
def rotation_of(q: FloatArray) -> FloatArray:
    """(3, 3) rotation of a quaternion (4,)."""
    x, turn, turned = np.zeros((13, 1)), np.zeros((3, 1)), np.empty((3, 3))
    for i in range(4):
        x[3 + i, 0] = q[i]
    turned_by(x, np.eye(3), turn, turned)
    return turned


@compiled
def arcs_at_rest(rod: Loaded, x: FloatArray) -> FloatArray:
    """(13 s, m) unknowns of the unloaded rod: each segment is an arc from where the last ends."""
    n, m = len(rod.lengths), len(x)
    y = np.zeros((13 * n, m))
    twist, moved, turned = np.zeros((6, 1)), np.empty((6, 1)), np.empty((3, 3))
    q, h = _quaternion(rod.base), np.zeros(3)
    for k in range(n):
        q = _after_kink(rod.kinks[k], q)
        start = rotation_of(q)
        for j in range(m):
            for i in range(6):
                twist[i, 0] = x[j] * rod.lengths[k] * rod.rest[k, i]
            exponential(twist, turned, moved)
            for i in range(3):
                y[13 * k + i, j] = h[i]
                for r in range(3):
                    y[13 * k + i, j] += start[i, r] * moved[3 + r, 0]
            angle = np.sqrt(twist[0, 0] ** 2 + twist[1, 0] ** 2 + twist[2, 0] ** 2)
            scale = np.sin(angle / 2) / angle if angle > 0 else 0.5
            turn = np.empty(4)
            turn[0] = np.cos(angle / 2)
            for i in range(3):
                turn[1 + i] = scale * twist[i, 0]
            here = _product(q, turn)
            for i in range(4):
                y[13 * k + 3 + i, j] = here[i]
        h, q = y[13 * k : 13 * k + 3, m - 1].copy(), y[13 * k + 3 : 13 * k + 7, m - 1].copy()
    return y
