"""Newton's iteration at one load, and whether what it finds is stable (kernels)."""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.compiled import compiled
from beamopt.rod.balance import reaction_of, residual_into
from beamopt.rod.packed import RodArrays, Stations
from beamopt.rod.rotation import multiply_rotation
from beamopt.rod.shape import Shape, modes_into, shape_into
from beamopt.rod.tangent import tangent_into

__all__ = [
    "CLOSE",
    "DIVERGED",
    "FOUND",
    "UNSTABLE",
    "evaluate",
    "is_stable",
    "negative_pivots",
    "newton",
]

FOUND, UNSTABLE, DIVERGED = 0, 1, 2
"""How an iteration ended: at a stable equilibrium, at one that is not, or nowhere."""

MOST_ITERATIONS = 20
LARGEST_TURN = 1.0  # rad that a step of the iteration may turn any section by, about
SINGULAR = 1e-14  # of a row: a pivot that is smaller is none
CLOSE = 1e-6  # rad: a step smaller than this is the last one; convergence is quadratic


@compiled
def evaluate(
    rod: RodArrays,
    at: Stations,
    rest: FloatArray,
    start: FloatArray,
    turn: FloatArray,
    factor: float,
    unknowns: FloatArray,
    shape: Shape,
    residual: FloatArray,
) -> None:
    """The shape that the unknowns make under `factor` times the loads, and its residual.

    start : (3,) the tip of the unloaded rod; a held position is `factor` of the way from there.
    turn : (3,) rotation vector in space from the unloaded tip's rotation to the held one, and
        `start` likewise for it.
    """
    modes = at.basis.shape[1] * rod.free.shape[0]
    hinge = unknowns[modes] if rod.hinge.shape[0] == 1 else 0.0
    reaction = reaction_of(rod, at, unknowns)
    goal, held = np.zeros(3), np.eye(3)
    if rod.held_position.shape[0] == 1:
        goal[:] = start + factor * (rod.held_position[0] - start)
    if rod.held_rotation.shape[0] == 1:
        # exp(factor turn) R_start, with R_start = exp(turn)ᵀ R_held
        back = factor - 1
        multiply_rotation(held, (back * turn[0], back * turn[1], back * turn[2]))
        held = held @ rod.held_rotation[0]
    modes_into(rod, at, rest, unknowns, shape)
    shape_into(rod, at, rest, factor, hinge, reaction, shape)
    residual_into(rod, at, shape, goal, held, reaction, residual)


@compiled
def newton(
    rod: RodArrays,
    at: Stations,
    rest: FloatArray,
    start: FloatArray,
    turn: FloatArray,
    conservative: bool,
    wary: bool,
    close: float,
    factor: float,
    unknowns: FloatArray,
    shape: Shape,
) -> tuple[int, int]:
    """Iterate from `unknowns`, in place, to an equilibrium; how it ended and after how many.

    An equilibrium in which the rod is compressed to nothing (v3 ≤ 0) counts as unstable.

    wary : give up where an iterate's tangent shows that the way led out of the well it began in.
    close : rad, the last step is smaller.
    """
    size = unknowns.shape[0]
    residual, tangent = np.empty(size), np.empty((size, size))
    held = 3 * (rod.held_position.shape[0] + rod.held_rotation.shape[0])
    evaluate(rod, at, rest, start, turn, factor, unknowns, shape, residual)
    for iteration in range(1, MOST_ITERATIONS + 1):
        tangent_into(rod, at, shape, factor, reaction_of(rod, at, unknowns), tangent)
        stable = is_stable(tangent, held, conservative)
        if wary and not stable:
            return UNSTABLE, iteration
        if not np.isfinite(tangent).all():
            return DIVERGED, iteration
        step = solved(tangent, residual)
        if not np.isfinite(step).all():
            return DIVERGED, iteration
        turned = largest_turn(rod, at, step)
        share = min(1.0, LARGEST_TURN / turned) if turned > 0 else 1.0
        for k in range(size):
            unknowns[k] -= share * step[k]
        evaluate(rod, at, rest, start, turn, factor, unknowns, shape, residual)
        if share == 1.0 and turned < close:
            whole = np.min(shape.stretch) > 0.0
            return (FOUND if stable and whole else UNSTABLE), iteration
    return DIVERGED, MOST_ITERATIONS


@compiled
def largest_turn(rod: RodArrays, at: Stations, step: FloatArray) -> float:
    """A bound of the angle [rad] that a change of the unknowns turns any section by, about."""
    free, modes = rod.free.shape[0], at.basis.shape[1]
    total, length = 0.0, 0.0
    for h in at.step:
        length += h
    for k in range(modes * free):
        total = max(total, abs(step[k]))
    total *= length
    for k in range(rod.hinge.shape[0]):
        total = max(total, abs(step[modes * free + k]))
    return total


@compiled
def solved(matrix: FloatArray, right: FloatArray) -> FloatArray:
    """x with matrix x = right, by elimination with column pivots; infinite where it is singular."""
    size = right.shape[0]
    a, x = matrix.copy(), right.copy()
    for k in range(size):
        best = k
        for i in range(k + 1, size):
            if abs(a[i, k]) > abs(a[best, k]):
                best = i
        if best != k:
            for j in range(k, size):
                a[k, j], a[best, j] = a[best, j], a[k, j]
            x[k], x[best] = x[best], x[k]
        pivot = a[k, k]
        for i in range(k + 1, size):
            ratio = a[i, k] / pivot
            if ratio != 0.0:
                for j in range(k + 1, size):
                    a[i, j] -= ratio * a[k, j]
                x[i] -= ratio * x[k]
    for k in range(size - 1, -1, -1):
        total = x[k]
        for j in range(k + 1, size):
            total -= a[k, j] * x[j]
        x[k] = total / a[k, k]
    return x


@compiled
def negative_pivots(matrix: FloatArray) -> int:
    """Negative eigenvalues of the symmetric part of a matrix (Sylvester, L D Lᵀ)."""
    size = matrix.shape[0]
    a = 0.5 * (matrix + matrix.T)
    negative = 0
    for k in range(size):
        pivot, least = a[k, k], SINGULAR * np.max(np.abs(matrix[k]))
        if abs(pivot) < least:
            pivot = least  # of a mechanism that something held further down stops
        if not pivot > 0.0:
            negative += 1
        for i in range(k + 1, size):
            ratio = a[i, k] / pivot
            for j in range(k + 1, i + 1):
                a[i, j] -= ratio * a[j, k]
        # the lower triangle alone is kept up to date
    return negative


@compiled
def is_stable(tangent: FloatArray, held: int, conservative: bool) -> bool:
    """Whether the potential has a minimum here, among what a held tip allows.

    A tangent has one negative eigenvalue for each of the `held` Lagrange multipliers at a minimum.
    Loads without a potential: whether the tangent has no negative real eigenvalue; with a held
    tip, whether its determinant has the sign that it has at rest. Divergence changes that; flutter,
    which statics can not see, does not.
    """
    if conservative:
        return negative_pivots(tangent) == held
    if held == 0:
        return negative_pivots(tangent) == 0 or not _has_negative_eigenvalue(tangent)
    return _sign_of_determinant(tangent) * (1.0 if held % 2 == 0 else -1.0) > 0


@compiled
def _has_negative_eigenvalue(tangent: FloatArray) -> bool:
    """Whether a real eigenvalue is negative, rows and columns scaled to the diagonal's size."""
    scale = np.sqrt(np.abs(np.diag(tangent))) + 1e-300
    values = np.linalg.eigvals((tangent / scale / scale.reshape(-1, 1)).astype(np.complex128))
    real, imaginary = values.real, np.abs(values.imag)
    return bool(np.any((real <= 0.0) & (imaginary <= 1e-9 * np.abs(real))))


@compiled
def _sign_of_determinant(matrix: FloatArray) -> float:
    size = matrix.shape[0]
    a, sign = matrix.copy(), 1.0
    for k in range(size):
        best = k
        for i in range(k + 1, size):
            if abs(a[i, k]) > abs(a[best, k]):
                best = i
        if best != k:
            sign = -sign
            for j in range(k, size):
                a[k, j], a[best, j] = a[best, j], a[k, j]
        if not a[k, k] > 0.0:
            sign = -sign
        for i in range(k + 1, size):
            ratio = a[i, k] / a[k, k]
            for j in range(k + 1, size):
                a[i, j] -= ratio * a[k, j]
    return sign
