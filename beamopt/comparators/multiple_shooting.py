"""Multiple shooting: the sections at the ends of intervals are unknown, too."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import inf

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray
from beamopt.base.compiled import compiled
from beamopt.comparators.elimination import assign, eliminate, solve, substitute
from beamopt.comparators.following import Attempt, solve_cases
from beamopt.comparators.growing import under
from beamopt.comparators.loaded import Loaded, at_rest, loaded_rod
from beamopt.comparators.se3 import rotation_vector
from beamopt.comparators.sections import Sections, draw, largest_wrench, move, take
from beamopt.comparators.shooting import HALVINGS, ITERATIONS, stations_of, status_of
from beamopt.comparators.sweep import (
    WORK,
    StepRule,
    advance,
    between,
    leftover,
    segments_of,
    wrench_size,
)
from beamopt.rod.rod import Rod
from beamopt.rod.solution import RodSolution
from beamopt.rod.status import RodStatus

__all__ = ["MultipleShooting", "shoot_between"]

TOLERANCE = 1e-10
"""What may be left at interval ends: lengths as a share of H, forces of all forces; then comes
one more correction."""


@dataclass(frozen=True)
class MultipleShooting:
    """Newton's method on the sections between intervals, condensed from the base to the tip.

    Errors grow along one interval only, and elimination with row pivoting (of almost block-diagonal
    systems: Diaz, Fairweather & Keast, ACM TOMS 9, 1983) does not let them grow further.

    stepper : classical Runge-Kutta, or a Magnus method; resolution is the number of steps.
    intervals : at most; there is at least a step in each.
    first_step : share of the loads that is tried first from the rod at rest; with all at once,
        heavy loads may lead to another equilibrium than if they grow.
    seconds : of processor time that a case may take; the very first call compiles, and that counts.
    """

    stepper: StepRule = StepRule.RUNGE_KUTTA
    intervals: int = 16
    first_step: float = 1.0
    seconds: float = inf
    resolutions: Sequence[int] = field(default=(4, 8, 16, 32, 64, 128, 256, 512, 1024))

    @property
    def name(self) -> str:
        """One word for tables and figures."""
        runge_kutta = self.stepper is StepRule.RUNGE_KUTTA
        return "multiple-shooting" if runge_kutta else "multiple-shooting-magnus"

    def solve(self, rod: Rod, rest: FloatArray, resolution: int) -> RodSolution:
        """Solve for the rest strains (n, segments, 6) of n cases, with `resolution` steps."""
        if len(rod.base.hinges):
            return RodSolution.unsolved(len(rest), RodStatus.NOT_REPRESENTABLE, rod.length)
        model = loaded_rod(rod, resolution)
        cases = [
            _Case(rod, model._replace(rest=one), self.stepper, self.intervals)
            for one in at_rest(rest, rod.length)
        ]
        return solve_cases(cases, stations_of(rod, model), self.seconds, self.first_step)


class _Case:
    """One case; its shape is that of the sections between intervals."""

    def __init__(self, rod: Rod, model: Loaded, stepper: StepRule, intervals: int) -> None:
        self.rod = rod
        self.model = model
        self.stepper = int(stepper)
        self.segments = segments_of(model.steps)
        steps = len(self.segments)
        self.marks = np.rint(np.linspace(0, steps, min(intervals, steps) + 1)).astype(np.int64)
        self.at_rest: Sections | None = None

    def unloaded(self) -> Sections:
        if self.at_rest is None:
            none = under(self.model, 0.0, np.zeros(3), np.eye(3))
            n = len(self.marks)
            start = Sections(self.marks, np.empty((n, 3, 3)), np.zeros((n, 9)))
            start.frames[0] = self.model.base
            draw(self.stepper, none, self.segments, start, True)
            self.at_rest = start
        return self.at_rest

    def attempt(self, guess: Sections, factor: float, seconds: float) -> Attempt[Sections]:
        del seconds  # an attempt takes milliseconds
        rest, shape = self.unloaded(), guess.copy()
        model = under(self.model, factor, rest.values[-1, :3], rest.frames[-1])
        least, iterations = shoot_between(self.stepper, model, self.segments, shape)
        return Attempt(status_of(least), shape, iterations)

    def drawn(self, shape: Sections) -> tuple[FloatArray, FloatArray]:
        line = draw(self.stepper, self.model, self.segments, shape, False)
        return self.rod.base.position + self.rod.length * line, shape.frames[-1].copy()


@compiled
def shoot_between(
    stepper: int, rod: Loaded, segments: NDArray[np.int64], shape: Sections
) -> tuple[float, int]:
    """Newton's method with halved steps; `shape` is the guess, and then the solution.

    Returns the least v3, not a number if it did not converge, and the number of iterations.
    """
    n = len(shape.marks) - 1
    systems, ahead = np.empty((n + 1, 18, 25)), np.empty((n + 1, 12))
    trial = Sections(shape.marks, shape.frames.copy(), shape.values.copy())
    loads = wrench_size(rod)
    size = loads + largest_wrench(shape)
    least, now = _mismatch(stepper, rod, segments, shape, size, systems)
    for iteration in range(ITERATIONS):
        if not np.isfinite(now) or not _condense(systems, ahead):
            return np.nan, iteration
        if now <= TOLERANCE:  # the derivatives are there: the last correction is for free
            move(shape, ahead, 1.0, trial)
            _keep(trial, shape)
            return least, iteration
        share, new = 1.0, now
        for _ in range(HALVINGS):
            move(shape, ahead, share, trial)
            least, new = _mismatch(stepper, rod, segments, trial, size, systems)
            if new < (1 - share / 4) * now:
                break
            share /= 2
        else:
            return np.nan, iteration + 1
        _keep(trial, shape)
        before, size = size, loads + largest_wrench(shape)
        now = new * max(1.0, before / size)
    return np.nan, ITERATIONS


@compiled
def _keep(one: Sections, to: Sections) -> None:
    for i in range(len(to.marks)):
        assign(to.frames[i], one.frames[i])
    assign(to.values, one.values)


@compiled
def _mismatch(
    stepper: int,
    rod: Loaded,
    segments: NDArray[np.int64],
    shape: Sections,
    size: float,
    systems: FloatArray,
) -> tuple[float, float]:
    """Linearised equations: what intervals end with is what the next begin with.

    systems : (i + 1, 18, 25), written. Rows 6… of i are −G Δ_i + Δ_(i+1) = −defect; the first six
        of the first hold the base, those of the last are the tip's.

    Returns the least v3 and the largest defect, forces and moments as shares of `size`.
    """
    n = len(shape.marks) - 1
    state, work, frame = np.empty((12, 10)), np.empty((WORK, 10)), np.empty((3, 3))
    turn, slope = np.empty((3, 3)), np.empty((3, 3))
    left, rows = np.empty(12), np.zeros((6, 12))
    systems[:] = 0.0
    for r in range(6):
        systems[0, r, r] = 1.0
    least, most = 1e300, 0.0
    for i in range(n):
        take(shape, i, frame, state)
        for step in range(shape.marks[i], shape.marks[i + 1]):
            least = min(least, advance(stepper, rod, segments, step, frame, state, work))
        # R_(i+1) = exp(φ) R_end: φ_(i+1) − turn φ_end = −log turn
        turn = between(shape.frames[i + 1], frame)
        rotation_vector(turn, left[3:6], slope)
        for j in range(10):
            p0, p1, p2 = state[3, j], state[4, j], state[5, j]
            for r in range(3):
                state[3 + r, j] = turn[r, 0] * p0 + turn[r, 1] * p1 + turn[r, 2] * p2
        for r in range(12):
            if r < 3 or r > 5:
                left[r] = shape.values[i + 1, r if r < 3 else r - 3] - state[r, 0]
            systems[i, 6 + r, 12 + r] = 1.0
            systems[i, 6 + r, 24] = -left[r]
            if r < 3:
                systems[i, 6 + r, r] = -1.0
            for j in range(9):
                systems[i, 6 + r, 3 + j] = -state[r, 1 + j]
            most = _larger(most, left[r] / (size if r > 5 else 1.0))
    take(shape, n, frame, state)
    leftover(rod, frame, state, left[:6], rows)
    for r in range(6):
        for c in range(12):
            systems[n, 6 + r, c] = rows[r, c]
        systems[n, 6 + r, 24] = -left[r]
        held = rod.held[0] if r < 3 else rod.held[1]
        most = _larger(most, left[r] / (1.0 if held else size))
    return least, most


@compiled
def _larger(most: float, one: float) -> float:
    """The larger of `most` and |one|; not a number if `one` is none."""
    return most if abs(one) <= most else abs(one)


@compiled
def _condense(systems: FloatArray, ahead: FloatArray) -> bool:
    """Solve for the increments (i + 1, 12): eliminate section after section, and come back."""
    n = len(systems) - 1
    for i in range(n):
        if not eliminate(systems[i], 12):
            return False
        for r in range(6):  # six equations are left, for the next section
            for c in range(12):
                systems[i + 1, r, c] = systems[i, 12 + r, 12 + c]
            systems[i + 1, r, 24] = systems[i, 12 + r, 24]
    last = systems[n, :12]
    if not solve(last[:, :12], last[:, 24], ahead[n]):
        return False
    right = np.empty(12)
    for back in range(n):
        i = n - 1 - back
        for r in range(12):
            right[r] = systems[i, r, 24]
            for c in range(12):
                right[r] -= systems[i, r, 12 + c] * ahead[i + 1, c]
        substitute(systems[i], right, ahead[i])
    return True
