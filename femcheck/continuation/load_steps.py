"""From a known equilibrium to another pressure, in as few load steps as it takes."""

from __future__ import annotations

import time
from dataclasses import dataclass, field

import numpy as np

from beamopt.base.arrays import FloatArray
from femcheck.continuation.direct import DirectSolver
from femcheck.continuation.limits import Budget, Limits
from femcheck.continuation.newton import Newton
from femcheck.continuation.outcome import SolidOutcome, Statistics, Status
from femcheck.continuation.shape import Shapes
from femcheck.solid.equilibrium import Equilibrium
from femcheck.solid.state import State

__all__ = ["LoadSteps"]


@dataclass(frozen=True, slots=True)
class LoadSteps:
    """Settings of the walk.

    smallest : share of the load below which a step is too small.
    shrink, grow : factors of a step after a failure and after a success.
    """

    newton: Newton = field(default_factory=Newton)
    smallest: float = 1 / 256
    shrink: float = 0.5
    grow: float = 2.0

    def walk(
        self,
        problem: Equilibrium,
        shapes: Shapes,
        start: tuple[State, FloatArray],
        pressures: FloatArray,
        solver: DirectSolver,
        guess: State | None = None,
        budget: Budget | None = None,
    ) -> SolidOutcome:
        """The equilibrium at `pressures` (3,) [kPa].

        Parameters
        ----------
        start : a known equilibrium and its pressures.
        guess : a state to try at once, before any steps.
        budget : what every iteration is taken from; None: the usual limits.
        """
        began = time.process_time()
        budget = budget or Limits().begin()
        spent = Statistics()
        tried = self.newton.solve(problem, guess or start[0], pressures, solver, budget)
        spent.add(tried.statistics)
        if tried.status is not Status.CONVERGED:
            tried = self._in_steps(problem, shapes, start, pressures, solver, budget, spent)
        spent.seconds = time.process_time() - began
        return SolidOutcome(
            tried.status,
            tried.state,
            tried.reached,
            tried.residual,
            tried.negative_eigenvalues,
            spent,
        )

    def _in_steps(
        self,
        problem: Equilibrium,
        shapes: Shapes,
        start: tuple[State, FloatArray],
        pressures: FloatArray,
        solver: DirectSolver,
        budget: Budget,
        spent: Statistics,
    ) -> SolidOutcome:
        state, first = start
        at, step = 0.0, 0.5
        here = shapes.of(state)
        slope = np.zeros_like(here)
        while True:
            to = min(at + step, 1.0)
            between = first + to * (pressures - first)
            guess = shapes.state(here + (to - at) * slope)
            tried = self.newton.solve(problem, guess, between, solver, budget)
            spent.add(tried.statistics)
            if tried.state is not None:
                now = shapes.of(tried.state)
                slope, here = (now - here) / (to - at), now
                at = to
                if at == 1.0:
                    return tried
                step *= self.grow
                continue
            step *= self.shrink
            if tried.status.is_limit or step < self.smallest:
                return SolidOutcome(tried.status, None, at)
