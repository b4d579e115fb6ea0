"""Steps down to the pressures whose arc ends nearest to a point: kernels."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray
from beamopt.base.compiled import compiled

__all__ = ["descend", "tip_at"]

MOST_STEPS = 60
PLAIN_STEPS = 6  # without second derivatives
DIFFERENCE = 1e-6  # of the box
EXACT = 1e-12  # of the length: nearer than this is there
FLAT = 1e-16  # share of |r|² that a step has to promise
SMALL_ANGLE = 1e-4  # rad, below which (cos θ − sin θ/θ)/θ is −θ/3, to 1e-13


@compiled
def descend(
    matrix: FloatArray,
    start: FloatArray,
    length: float,
    point: FloatArray,
    at: FloatArray,
    tip: FloatArray,
    slopes: FloatArray,
) -> float:
    """Go from the shares `at` to a minimum of |h − point|² in the unit box; returns that.

    Shares at an end of the box that would leave it are held there for a step.
    """
    gradient, step, tried, there = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    normal, held = np.empty((3, 3)), np.empty(3, dtype=np.bool_)
    exact = (EXACT * length) ** 2
    _tip_and_slopes(matrix, start, length, at, tip, slopes)
    square = _square(tip, point)
    damping = 1e-4
    for steps in range(MOST_STEPS):
        if square <= exact:
            break
        for j in range(3):
            gradient[j] = 0.0
            for x in range(3):
                gradient[j] += slopes[x, j] * (tip[x] - point[x])
        largest = 0.0
        for j in range(3):
            for k in range(3):
                normal[j, k] = 0.0
                for x in range(3):
                    normal[j, k] += slopes[x, j] * slopes[x, k]
            held[j] = (at[j] <= 0 and gradient[j] > 0) or (at[j] >= 1 and gradient[j] < 0)
            if held[j]:
                gradient[j] = 0.0
            else:
                largest = max(largest, normal[j, j])
        if steps >= PLAIN_STEPS:
            _add_curvature(matrix, start, length, point, at, tip, slopes, normal)
        moved = False
        while damping < 1e12:
            if not _solve(normal, gradient, held, damping * largest, step):
                damping *= 8
                continue
            promised = -(gradient[0] * step[0] + gradient[1] * step[1] + gradient[2] * step[2])
            if not promised > FLAT * square:
                break
            for j in range(3):
                tried[j] = min(max(at[j] + step[j], 0.0), 1.0)
            tip_at(matrix, start, length, tried, there)
            lower = _square(there, point)
            if lower < square:
                moved = True
                break
            damping *= 8
        if not moved:
            break
        at[:] = tried
        damping = max(damping / 16, 1e-13)
        _tip_and_slopes(matrix, start, length, at, tip, slopes)
        square = _square(tip, point)
    return square


@compiled
def tip_at(
    matrix: FloatArray, start: FloatArray, length: float, at: FloatArray, tip: FloatArray
) -> None:
    """Tip of the arc at shares `at` of the box; see `arc.arc_tips`."""
    stretch = start[0] + matrix[0, 0] * at[0] + matrix[0, 1] * at[1] + matrix[0, 2] * at[2]
    k1 = start[1] + matrix[1, 0] * at[0] + matrix[1, 1] * at[1] + matrix[1, 2] * at[2]
    k2 = start[2] + matrix[2, 0] * at[0] + matrix[2, 1] * at[1] + matrix[2, 2] * at[2]
    angle = np.hypot(k1, k2) * length
    half = np.sin(angle / 2) / (angle / 2) if angle > 0 else 1.0
    sideways = length / 2 * half * half
    along = (1 + stretch) * length
    tip[0] = along * sideways * k2
    tip[1] = -along * sideways * k1
    tip[2] = along * (np.sin(angle) / angle if angle > 0 else 1.0)


@compiled
def _tip_and_slopes(
    matrix: FloatArray,
    start: FloatArray,
    length: float,
    at: FloatArray,
    tip: FloatArray,
    slopes: FloatArray,
) -> None:
    """Tip, and its derivatives (3, 3) by the shares.

    With f = (1 − cos θ)/θ², g = sin θ/θ and e = κ/|κ|: ∂(f κ_i)/∂κ_j = f δ_ij + (g − 2f) e_i e_j
    and ∂g/∂κ_j = H e_j (cos θ − g)/θ.
    """
    stretch = start[0] + matrix[0, 0] * at[0] + matrix[0, 1] * at[1] + matrix[0, 2] * at[2]
    k1 = start[1] + matrix[1, 0] * at[0] + matrix[1, 1] * at[1] + matrix[1, 2] * at[2]
    k2 = start[2] + matrix[2, 0] * at[0] + matrix[2, 1] * at[1] + matrix[2, 2] * at[2]
    size = np.hypot(k1, k2)
    angle = size * length
    half = np.sin(angle / 2) / (angle / 2) if angle > 0 else 1.0
    f = half * half / 2
    g = np.sin(angle) / angle if angle > 0 else 1.0
    change = (np.cos(angle) - g) / angle if angle > SMALL_ANGLE else -angle / 3
    e1 = k1 / size if size > 0 else 0.0
    e2 = k2 / size if size > 0 else 0.0
    along = (1 + stretch) * length
    tip[0], tip[1], tip[2] = along * length * f * k2, -along * length * f * k1, along * g
    versed = g - 2 * f
    for j in range(3):
        by_stretch, by_1, by_2 = matrix[0, j], matrix[1, j], matrix[2, j]
        turned = e1 * by_1 + e2 * by_2
        wide = along * length
        slopes[0, j] = length * length * f * k2 * by_stretch
        slopes[0, j] += wide * (f * by_2 + versed * e2 * turned)
        slopes[1, j] = -length * length * f * k1 * by_stretch
        slopes[1, j] -= wide * (f * by_1 + versed * e1 * turned)
        slopes[2, j] = length * g * by_stretch + wide * change * turned


@compiled
def _add_curvature(
    matrix: FloatArray,
    start: FloatArray,
    length: float,
    point: FloatArray,
    at: FloatArray,
    tip: FloatArray,
    slopes: FloatArray,
    normal: FloatArray,
) -> None:
    """Add Σ r ∂²h to the normal matrix Jᵀ J, r = h − point: Newton's instead of Gauss–Newton's.

    By differences of the slopes. Points far from what is reached need it: there each step of
    Gauss and Newton leaves a share of the way.
    """
    moved, there, other = at.copy(), np.empty(3), np.empty((3, 3))
    change = np.empty((3, 3))
    for k in range(3):
        moved[k] = at[k] + DIFFERENCE
        _tip_and_slopes(matrix, start, length, moved, there, other)
        moved[k] = at[k]
        for j in range(3):
            change[j, k] = 0.0
            for x in range(3):
                change[j, k] += (tip[x] - point[x]) * (other[x, j] - slopes[x, j]) / DIFFERENCE
    for j in range(3):
        for k in range(3):
            normal[j, k] += (change[j, k] + change[k, j]) / 2


@compiled
def _square(tip: FloatArray, point: FloatArray) -> float:
    total = 0.0
    for x in range(3):
        total += (tip[x] - point[x]) ** 2
    return total


@compiled
def _solve(
    normal: FloatArray,
    gradient: FloatArray,
    held: NDArray[np.bool_],
    damping: float,
    step: FloatArray,
) -> bool:
    """step = −(normal + damping · 1)⁻¹ gradient in the rows that are not held, 0 in the others.

    By Cholesky's decomposition L Lᵀ, row by row; False where there is none. The gradient of what is
    held is 0.
    """
    lower = np.zeros((3, 3))
    for j in range(3):
        for k in range(j):
            value = 0.0 if held[j] or held[k] else normal[j, k]
            for x in range(k):
                value -= lower[j, x] * lower[k, x]
            lower[j, k] = value / lower[k, k]
        value = 1.0 if held[j] else normal[j, j] + damping
        for x in range(j):
            value -= lower[j, x] * lower[j, x]
        if not value > 0:
            return False
        lower[j, j] = np.sqrt(value)
    for j in range(3):
        value = -gradient[j]
        for x in range(j):
            value -= lower[j, x] * step[x]
        step[j] = value / lower[j, j]
    for j in range(2, -1, -1):
        value = step[j]
        for x in range(j + 1, 3):
            value -= lower[x, j] * step[x]
        step[j] = value / lower[j, j]
    return True
