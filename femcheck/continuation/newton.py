"""Newton's method with a line search on the potential."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from beamopt.base.arrays import FloatArray
from femcheck.continuation.control import Control, FixedLoad
from femcheck.continuation.direct import DirectSolver, SingularMatrixError
from femcheck.continuation.limits import Budget
from femcheck.continuation.outcome import SolidOutcome, Statistics, Status
from femcheck.solid.equilibrium import Equilibrium, Forces
from femcheck.solid.state import State

__all__ = ["Newton", "unstable_directions"]

SUFFICIENT = 1e-4  # Armijo's share of the decrease that the slope promises
ROUNDING = 1e-10  # differences of the potential below this share of it are noise
SHORTEST = 1 / 64
DIVERGED = 5.0  # a step so much longer than the shortest before it: on a path, give up
LARGEST_TURN = 1.0  # rad that the tip plate may turn in one iteration
LARGEST_MOVE = 0.5  # of the body's size that a node may move in one iteration


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
        budget: Budget | None = None,
    ) -> SolidOutcome:
        """The equilibrium at `pressures` (3,) [kPa] near `start`, or how the search for it ended.

        budget : what every iteration is taken from; None: without a limit.
        """
        return self.follow(problem, start, FixedLoad(pressures), solver, budget)

    def follow(
        self,
        problem: Equilibrium,
        start: State,
        control: Control,
        solver: DirectSolver,
        budget: Budget | None = None,
    ) -> SolidOutcome:
        """The equilibrium near `start` at the pressures that the control settles on."""
        statistics = Statistics(steps=1)
        at_start: int | None = None
        least = np.inf

        def failed(status: Status) -> SolidOutcome:
            return SolidOutcome(status, None, statistics=statistics, negative_at_start=at_start)

        state = start
        forces = _timed(problem, state, control.pressures, statistics)
        if not forces.least_volume_ratio > 0:
            return failed(Status.INVERTED)
        for number in range(self.most_iterations):
            exhausted = budget.spend() if budget is not None else None
            if exhausted is not None:
                return failed(exhausted)
            try:
                step = _direction(problem, state, control, forces, solver, statistics)
            except SingularMatrixError:
                return failed(Status.LINEAR_SOLVER)
            unstable = unstable_directions(problem, solver)
            at_start = unstable if number == 0 else at_start
            far = problem.support.extent(step)[0]
            if not control.is_fixed and far > DIVERGED * least:
                return failed(Status.STEP_TOO_SMALL)
            least = min(least, far)
            share = _share(problem, state, control, forces, step)
            if share is None:
                return failed(Status.INVERTED)
            state = problem.moved(state, share * step)
            control.advance(share)
            forces = _timed(problem, state, control.pressures, statistics)
            if share == 1 and far <= self.tolerance:
                residual = float(np.abs(forces.reduced).max())
                return SolidOutcome(
                    Status.CONVERGED, state, 1.0, residual, unstable, statistics, at_start
                )
        return failed(Status.STEP_TOO_SMALL)


def unstable_directions(problem: Equilibrium, solver: DirectSolver) -> int | None:
    """Negative eigenvalues of the factored tangent, less those of the hydrostatic pressures.

    None where the solver can not count them.
    """
    negative = solver.negative_eigenvalues
    return None if negative is None else negative - problem.hydrostatic_unknowns


def _timed(
    problem: Equilibrium, state: State, pressures: FloatArray, statistics: Statistics
) -> Forces:
    began = time.process_time()
    forces = problem.forces(state, pressures)
    statistics.assembly_seconds += time.process_time() - began
    return forces


def _direction(
    problem: Equilibrium,
    state: State,
    control: Control,
    forces: Forces,
    solver: DirectSolver,
    statistics: Statistics,
) -> FloatArray:
    began = time.process_time()
    tangent = problem.tangent(state, control.pressures, forces)
    statistics.assembly_seconds += time.process_time() - began
    factored, solved = solver.factor_seconds, solver.solve_seconds
    statistics.iterations += 1
    solver.factor(tangent)
    step = control.step(problem, state, forces, solver)
    statistics.factor_seconds += solver.factor_seconds - factored
    statistics.solve_seconds += solver.solve_seconds - solved
    return step


def _share(
    problem: Equilibrium, state: State, control: Control, forces: Forces, step: FloatArray
) -> float | None:
    """How much of a step to take: all of it, or halves until the potential falls as it should.

    A direction along which the potential rises leads to an equilibrium that is not its minimum;
    it is followed as far as no element inverts, and so is every direction in the mixed form, whose
    potential has no minimum, and where the pressures change with the step. None: every share
    inverts an element.
    """
    minimises = control.is_fixed and problem.mixed is None
    slope = float(forces.reduced @ step) if minimises else 0.0
    before = problem.potential(state, control.pressures) if minimises else 0.0
    noise = ROUNDING * max(abs(before), 1.0)
    far, turn = problem.support.extent(step)
    reach = LARGEST_MOVE * problem.body.size
    share = min(1.0, reach / max(far, reach), LARGEST_TURN / max(turn, LARGEST_TURN))
    intact = None
    while share >= SHORTEST:
        energy = problem.potential(problem.moved(state, share * step), control.pressures)
        if np.isfinite(energy):
            intact = intact or share
            if slope >= 0 or energy - before <= SUFFICIENT * share * slope + noise:
                return share
        share /= 2
    return intact
