"""From the base to the tip, step by step, and what is left over there."""

from __future__ import annotations

from enum import IntEnum
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray
from beamopt.base.compiled import compiled
from beamopt.comparators.loaded import Loaded
from beamopt.comparators.munthe_kaas import munthe_kaas_step
from beamopt.comparators.rates import cross, times
from beamopt.comparators.runge_kutta import runge_kutta_step
from beamopt.comparators.se3 import rotation_vector

__all__ = [
    "WORK",
    "StepRule",
    "advance",
    "between",
    "drawn",
    "leftover",
    "pass_load",
    "segments_of",
    "wrench_size",
]

WORK = 81
"""Rows of the space that steps work in."""


class StepRule(IntEnum):
    """How to go one step along the rod; both are of order four."""

    RUNGE_KUTTA = 0
    MUNTHE_KAAS = 1


def segments_of(steps: NDArray[np.int64]) -> NDArray[np.int64]:
    """(Σ steps,) segment of each step."""
    return np.repeat(np.arange(len(steps)), steps)


@compiled
def advance(
    stepper: int,
    rod: Loaded,
    segments: NDArray[np.int64],
    step: int,
    frame: FloatArray,
    state: FloatArray,
    work: FloatArray,
) -> float:
    """Go through one step, with the kink before it and the point load after it; least v3 met.

    segments : (steps,) the segment of each. frame (3, 3), state (12, 1 + p) : as for the steps.
    """
    k = segments[step]
    if step == 0 or segments[step - 1] != k:
        for i in range(3):
            e0, e1, e2 = frame[i, 0], frame[i, 1], frame[i, 2]
            for j in range(3):
                kink = rod.kinks[k, :, j]
                frame[i, j] = e0 * kink[0] + e1 * kink[1] + e2 * kink[2]
    length = rod.lengths[k] / rod.steps[k]
    if stepper == 0:
        least = runge_kutta_step(rod, k, length, frame, state, work)
    else:
        least = munthe_kaas_step(rod, k, length, frame, state, work)
    if step + 1 == len(segments) or segments[step + 1] != k:
        pass_load(rod.end[k], frame, state)
    return least


@compiled
def pass_load(end: FloatArray, frame: FloatArray, state: FloatArray) -> None:
    """Jumps: n −= F, m −= moment + R follower_moment + (R at) × F; after the tip both are zero."""
    g0, g1, g2 = times(frame, end[2, 0], end[2, 1], end[2, 2])
    t0, t1, t2 = times(frame, end[3, 0], end[3, 1], end[3, 2])
    r0, r1, r2 = times(frame, end[4, 0], end[4, 1], end[4, 2])
    f0, f1, f2 = end[0, 0] + g0, end[0, 1] + g1, end[0, 2] + g2
    for j in range(state.shape[1]):
        if j == 0:
            b0, b1, b2 = f0, f1, f2
            a0, a1, a2 = end[1, 0] + t0, end[1, 1] + t1, end[1, 2] + t2
        else:
            p0, p1, p2 = state[3, j], state[4, j], state[5, j]
            b0, b1, b2 = cross(p0, p1, p2, g0, g1, g2)
            a0, a1, a2 = cross(p0, p1, p2, t0, t1, t2)
            s0, s1, s2 = cross(p0, p1, p2, r0, r1, r2)
            s0, s1, s2 = cross(s0, s1, s2, f0, f1, f2)
            a0, a1, a2 = a0 + s0, a1 + s1, a2 + s2
        x0, x1, x2 = cross(r0, r1, r2, b0, b1, b2)
        state[6, j] -= b0
        state[7, j] -= b1
        state[8, j] -= b2
        state[9, j] -= a0 + x0
        state[10, j] -= a1 + x1
        state[11, j] -= a2 + x2


@compiled
def leftover(
    rod: Loaded, frame: FloatArray, state: FloatArray, left: FloatArray, slope: FloatArray
) -> None:
    """What is wrong at the tip, after its load.

    left : (6,) written: n and m, which are to vanish, or h − place and the rotation vector from
        the prescribed frame, where the tip is held.
    slope : (6, 12) written: its derivatives by (h, φ, n, m).
    """
    slope[:] = 0.0
    for i in range(3):
        if rod.held[0]:
            left[i] = state[i, 0] - rod.place[i]
            slope[i, i] = 1.0
        else:
            left[i] = state[6 + i, 0]
            slope[i, 6 + i] = 1.0
    if rod.held[1]:
        rotation_vector(between(frame, rod.frame), left[3:6], slope[3:6, 3:6])
    else:
        for i in range(3):
            left[3 + i] = state[9 + i, 0]
            slope[3 + i, 9 + i] = 1.0


@compiled
def between(one: FloatArray, other: FloatArray) -> FloatArray:
    """(3, 3) one · otherᵀ: the rotation that leads from the other to the one."""
    result = np.empty((3, 3))
    for i in range(3):
        for j in range(3):
            result[i, j] = (
                one[i, 0] * other[j, 0] + one[i, 1] * other[j, 1] + one[i, 2] * other[j, 2]
            )
    return result


@compiled
def wrench_size(rod: Loaded) -> float:
    """1 + all loads: what force and moment are small against."""
    size = 1.0
    for k in range(len(rod.lengths)):
        for row in range(4):
            size += _length(rod.end[k, row])
        for row in range(2):
            size += rod.lengths[k] * _length(rod.line[k, row])
    return size


@compiled
def _length(vector: FloatArray) -> float:
    return sqrt(vector[0] ** 2 + vector[1] ** 2 + vector[2] ** 2)


@compiled
def drawn(
    stepper: int, rod: Loaded, segments: NDArray[np.int64], wrench: FloatArray, line: FloatArray
) -> FloatArray:
    """The rod as it follows from force and moment (6,) at its base.

    line : (steps + 1, 3) the axis, written. Returns the rotation (3, 3) of the section at the tip.
    """
    state, work, frame = np.zeros((12, 1)), np.empty((81, 1)), rod.base.copy()
    for i in range(6):
        state[6 + i, 0] = wrench[i]
    for step in range(len(segments) + 1):
        for i in range(3):
            line[step, i] = state[i, 0]
        if step < len(segments):
            advance(stepper, rod, segments, step, frame, state, work)
    return frame
