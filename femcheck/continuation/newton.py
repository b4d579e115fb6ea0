"""Newton's method with a line search on the potential."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from beamopt.arrays import FloatArray
from femcheck.continuation.direct import DirectSolver, SingularMatrixError
from femcheck.continuation.outcome import Outcome, Statistics, Status
from femcheck.solid.equilibrium import Equilibrium, Forces
from femcheck.solid.state import State, moved

__all__ = ["Newton"]

SUFFICIENT = 1e-4  # Armijo's share of the decrease that the slope promises
ROUNDING = 1e-10  # differences of the potential below this share of it are noise
SHORTEST = 1 / 64
LARGEST_TURN = 1.0  # rad that the tip plate may turn in one iteration


@dataclass(frozen=True, slots=True)
class Newton:
    """Settings of the iteration.

    tolerance : largest displacement of the last iteration [mm]; convergence is quadratic, so the
        equilibrium is far nearer than that.
    most_iterations : after which it has failed.
    """

    tolerance: float = 2e-4
    most_iterations: int = 25

    def solve(
        self,
        problem: Equilibrium,
        start: State,
        pressures: FloatArray,
        solver: DirectSolver,
        deadline: float = np.inf,
    ) -> Outcome:
        """The equilibrium at `pressures` (3,) [kPa] near `start`, or how the search for it ended.

        deadline : of `time.perf_counter`, at which it gives up.
        """
        statistics = Statistics(steps=1)
        state = start
        forces = _timed(problem, state, pressures, statistics)
        if forces.least_volume_ratio <= 0:
            return Outcome(Status.INVERTED, None, statistics=statistics)
        for _ in range(self.most_iterations):
            if time.perf_counter() > deadline:
                return Outcome(Status.TIME_OUT, None, statistics=statistics)
            try:
                step = _direction(problem, state, pressures, forces, solver, statistics)
            except SingularMatrixError:
                return Outcome(Status.LINEAR_SOLVER, None, statistics=statistics)
            share = _share(problem, state, pressures, forces, step)
            if share is None:
                return Outcome(Status.INVERTED, None, statistics=statistics)
            state = _after(problem, state, share * step)
            forces = _timed(problem, state, pressures, statistics)
            if share == 1 and np.abs(step[:-3]).max() <= self.tolerance:
                residual = float(np.abs(forces.reduced).max())
                negative = solver.negative_eigenvalues
                return Outcome(Status.CONVERGED, state, 1.0, residual, negative, statistics)
        return Outcome(Status.STEP_TOO_SMALL, None, statistics=statistics)


def _timed(
    problem: Equilibrium, state: State, pressures: FloatArray, statistics: Statistics
) -> Forces:
    began = time.perf_counter()
    forces = problem.forces(state, pressures)
    statistics.assembly_seconds += time.perf_counter() - began
    return forces


def _direction(
    problem: Equilibrium,
    state: State,
    pressures: FloatArray,
    forces: Forces,
    solver: DirectSolver,
    statistics: Statistics,
) -> FloatArray:
    began = time.perf_counter()
    tangent = problem.tangent(state, pressures, forces)
    statistics.assembly_seconds += time.perf_counter() - began
    factored, solved = solver.factor_seconds, solver.solve_seconds
    solver.factor(tangent)
    step = solver.solve(-forces.reduced)
    statistics.factor_seconds += solver.factor_seconds - factored
    statistics.solve_seconds += solver.solve_seconds - solved
    statistics.iterations += 1
    turn = float(np.abs(step[-3:]).max())
    return step if turn <= LARGEST_TURN else step * (LARGEST_TURN / turn)


def _after(problem: Equilibrium, state: State, step: FloatArray) -> State:
    return moved(problem.body, state, problem.free, step[:-6].reshape(-1, 3), step[-6:])


def _share(
    problem: Equilibrium, state: State, pressures: FloatArray, forces: Forces, step: FloatArray
) -> float | None:
    """How much of a step to take: all of it, or halves until the potential falls as it should.

    A direction along which the potential rises leads to an equilibrium that is not its minimum;
    it is followed as far as no element inverts. None: every share inverts an element.
    """
    slope = float(forces.reduced @ step)
    before = problem.potential(state, pressures)
    noise = ROUNDING * max(abs(before), 1.0)
    share, intact = 1.0, None
    while share >= SHORTEST:
        after = _after(problem, state, share * step)
        energy = problem.potential(after, pressures)
        if np.isfinite(energy):
            intact = intact or share
            if slope >= 0 or energy - before <= SUFFICIENT * share * slope + noise:
                return share
        share /= 2
    return intact
