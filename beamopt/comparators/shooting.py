"""Single shooting: force and moment at the base, such that what is left at the tip vanishes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import inf

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray
from beamopt.base.compiled import compiled
from beamopt.comparators.elimination import assign, solve
from beamopt.comparators.following import Attempt, solve_cases
from beamopt.comparators.growing import under
from beamopt.comparators.loaded import Loaded, at_rest, loaded_rod
from beamopt.comparators.sweep import (
    WORK,
    StepRule,
    advance,
    drawn,
    leftover,
    segments_of,
    wrench_size,
)
from beamopt.rod.rod import Rod
from beamopt.rod.solution import RodSolution
from beamopt.rod.status import RodStatus

__all__ = ["HALVINGS", "ITERATIONS", "Shooting", "shoot", "stations_of", "status_of"]

TOLERANCE = 1e-10
"""What may be left at the tip, as a share of all forces, before the last correction."""
ITERATIONS = 40
HALVINGS = 8
"""Of a step of Newton's method, before it is given up."""


@dataclass(frozen=True)
class Shooting:
    """Newton's method on the six components of force and moment at the base.

    Unknowns and equations are few, but errors of the base grow along the rod as exp(√(n/B) H)
    does: a long or heavy rod can not be shot at. Jacobians are the derivatives of the steps.

    stepper : classical Runge-Kutta, or a Magnus method; resolution is the number of steps.
    first_step : share of the loads that is tried first from the rod at rest; with all at once,
        heavy loads may lead to another equilibrium than if they grow.
    seconds : of processor time that a case may take; the very first call compiles, and that counts.
    """

    stepper: StepRule = StepRule.RUNGE_KUTTA
    first_step: float = 1.0
    seconds: float = inf
    resolutions: Sequence[int] = field(default=(4, 8, 16, 32, 64, 128, 256, 512, 1024))

    @property
    def name(self) -> str:
        """One word for tables and figures."""
        return "shooting" if self.stepper is StepRule.RUNGE_KUTTA else "shooting-magnus"

    def solve(self, rod: Rod, rest: FloatArray, resolution: int) -> RodSolution:
        """Solve for the rest strains (n, segments, 6) of n cases, with `resolution` steps."""
        if len(rod.base.hinges):
            return RodSolution.unsolved(len(rest), RodStatus.NOT_REPRESENTABLE, rod.length)
        model = loaded_rod(rod, resolution)
        cases = [
            _Case(rod, model._replace(rest=one), self.stepper) for one in at_rest(rest, rod.length)
        ]
        return solve_cases(cases, stations_of(rod, model), self.seconds, self.first_step)


def stations_of(rod: Rod, model: Loaded) -> FloatArray:
    """(Σ steps + 1,) undeformed arc lengths [mm] at the ends of the steps."""
    steps = np.repeat(model.lengths / model.steps, model.steps)
    return np.append(0.0, np.cumsum(steps)) * rod.length


class _Case:
    """One case; its shape is force and moment (6,) at the base."""

    def __init__(self, rod: Rod, model: Loaded, stepper: StepRule) -> None:
        self.rod = rod
        self.model = model
        self.stepper = int(stepper)
        self.segments = segments_of(model.steps)
        self.at_rest: tuple[FloatArray, FloatArray] | None = None

    def unloaded(self) -> FloatArray:
        return np.zeros(6)

    def attempt(self, guess: FloatArray, factor: float, seconds: float) -> Attempt[FloatArray]:
        del seconds  # an attempt takes milliseconds
        wrench = guess.copy()
        model = self._under(factor)
        least, iterations = shoot(self.stepper, model, self.segments, wrench)
        return Attempt(status_of(least), wrench, iterations)

    def _under(self, factor: float) -> Loaded:
        if factor == 1:
            return self.model
        if self.at_rest is None:
            none = under(self.model, 0.0, np.zeros(3), np.eye(3))
            line = np.empty((len(self.segments) + 1, 3))
            frame = drawn(self.stepper, none, self.segments, np.zeros(6), line)
            self.at_rest = line[-1], frame
        return under(self.model, factor, *self.at_rest)

    def drawn(self, shape: FloatArray) -> tuple[FloatArray, FloatArray]:
        line = np.empty((len(self.segments) + 1, 3))
        frame = drawn(self.stepper, self.model, self.segments, shape, line)
        return self.rod.base.position + self.rod.length * line, frame


def status_of(least: float) -> RodStatus:
    """The ending that the least v3 tells, which is not a number where the iteration diverged."""
    if np.isnan(least):
        return RodStatus.DIVERGED
    return RodStatus.CONVERGED if least > 0 else RodStatus.CRUSHED


@compiled
def shoot(
    stepper: int, rod: Loaded, segments: NDArray[np.int64], wrench: FloatArray
) -> tuple[float, int]:
    """Newton's method with halved steps; `wrench` (6,) is the guess, and then the solution.

    Returns the least v3, not a number if it did not converge, and the number of iterations.
    """
    left, slope = np.empty(6), np.empty((6, 6))
    trial, new_left, new_slope = np.empty(6), np.empty(6), np.empty((6, 6))
    ahead, work = np.empty(6), np.empty((WORK, 7))
    loads = wrench_size(rod)
    least = _miss(stepper, rod, segments, wrench, left, slope, work)
    for iteration in range(ITERATIONS):
        size = loads + _largest(wrench)
        now = _size(rod, left, size)
        if not np.isfinite(now) or not solve(slope, left, ahead):
            return np.nan, iteration
        if now <= TOLERANCE:
            for i in range(6):  # the derivatives are there: the last correction is for free
                wrench[i] -= ahead[i]
            return least, iteration
        share = 1.0
        for _ in range(HALVINGS):
            for i in range(6):
                trial[i] = wrench[i] - share * ahead[i]
            least = _miss(stepper, rod, segments, trial, new_left, new_slope, work)
            if _size(rod, new_left, size) < (1 - share / 4) * now:
                break
            share /= 2
        else:
            return np.nan, iteration + 1
        for i in range(6):
            wrench[i], left[i] = trial[i], new_left[i]
        assign(slope, new_slope)
    return np.nan, ITERATIONS


@compiled
def _largest(wrench: FloatArray) -> float:
    result = 0.0
    for one in wrench:
        result = max(result, abs(one))
    return result


@compiled
def _size(rod: Loaded, left: FloatArray, size: float) -> float:
    """The largest of what is left, forces and moments as shares of `size`."""
    result = 0.0
    for i in range(6):
        held = rod.held[0] if i < 3 else rod.held[1]
        one = abs(left[i]) if held else abs(left[i]) / size
        if not one <= result:  # also if it is not a number
            result = one
    return result


@compiled
def _miss(
    stepper: int,
    rod: Loaded,
    segments: NDArray[np.int64],
    wrench: FloatArray,
    left: FloatArray,
    slope: FloatArray,
    work: FloatArray,
) -> float:
    """What is left (6,) at the tip, its derivatives (6, 6) by the wrench; returns the least v3."""
    state, rows = np.zeros((12, 7)), np.empty((6, 12))
    frame = rod.base.copy()
    for i in range(6):
        state[6 + i, 0] = wrench[i]
        state[6 + i, 1 + i] = 1.0
    least = 1e300
    for step in range(len(segments)):
        least = min(least, advance(stepper, rod, segments, step, frame, state, work))
    leftover(rod, frame, state, left, rows)
    for i in range(6):
        for j in range(6):
            total = 0.0
            for r in range(12):
                total += rows[i, r] * state[r, 1 + j]
            slope[i, j] = total
    return least
