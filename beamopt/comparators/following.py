"""Cases one after the other, and the way from the unloaded rod where the direct one fails."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf
from time import thread_time
from typing import Generic, Protocol, TypeVar

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.rod.solution import RodSolution
from beamopt.rod.status import RodStatus

__all__ = ["Attempt", "BoundaryProblem", "Followed", "follow", "solve_cases"]

LEAST_STEP = 1 / 1024
"""Of the loads already carried: shorter steps are given up."""
LEAST_START = 2.0**-20
"""Of all loads, likewise: the first step of a rod with very large ones may have to be short."""

Shape = TypeVar("Shape")


@dataclass(frozen=True, eq=False)
class Attempt(Generic[Shape]):
    """How a try at some share of the loads ended: `shape` is an equilibrium if it converged."""

    status: RodStatus
    shape: Shape
    iterations: int


class BoundaryProblem(Protocol[Shape]):
    """One boundary-value problem, for any share of its loads."""

    def unloaded(self) -> Shape:
        """The rod at rest: a guess."""
        ...

    def attempt(self, guess: Shape, factor: float, seconds: float) -> Attempt[Shape]:
        """Solve at `factor` times the loads from a guess.

        seconds : of processor time, about which it may take at most.
        """
        ...

    def drawn(self, shape: Shape) -> tuple[FloatArray, FloatArray]:
        """The axis (m, 3) [mm] and the rotation (3, 3) of the section at the tip."""
        ...


@dataclass(frozen=True, eq=False)
class Followed(Generic[Shape]):
    """Where following one case ended: `shape` is an equilibrium at `factor` times the loads."""

    status: RodStatus
    shape: Shape
    factor: float
    iterations: int


def follow(
    case: BoundaryProblem[Shape], guess: Shape | None, seconds: float = inf, step: float = 1.0
) -> Followed[Shape]:
    """Try all loads at once from `guess`; failing that, let them grow from the rod at rest.

    Natural continuation: the shape at one share of the loads is the guess for the next; the first
    try is `step` of the loads; steps are halved where one fails and doubled where it does not.
    That ends at limit points, or jumps over them if Newton's method finds another equilibrium.
    """
    end = thread_time() + seconds
    iterations = 0
    if guess is not None:
        first = case.attempt(guess, 1.0, seconds)
        iterations = first.iterations
        if first.status is RodStatus.CONVERGED:
            return Followed(first.status, first.shape, 1.0, iterations)
    shape, factor = case.unloaded(), 0.0
    while factor < 1:
        left = end - thread_time()
        if left <= 0:
            return Followed(RodStatus.TOO_SLOW, shape, factor, iterations)
        there = min(1.0, factor + step)
        tried = case.attempt(shape, there, left)
        iterations += tried.iterations
        if tried.status is RodStatus.CONVERGED:
            shape, factor, step = tried.shape, there, 2 * step
            continue
        step = (there - factor) / 2
        if step < max(LEAST_START, LEAST_STEP * factor):
            return Followed(_given_up(tried.status, factor), shape, factor, iterations)
    return Followed(RodStatus.CONVERGED, shape, factor, iterations)


def _given_up(last: RodStatus, factor: float) -> RodStatus:
    if last in (RodStatus.DIVERGED, RodStatus.CONVERGED) and factor > 0:
        return RodStatus.STEPS_TOO_SMALL
    return last


def solve_cases(
    cases: Sequence[BoundaryProblem[Shape]],
    stations: FloatArray,
    seconds: float,
    step: float,
    *,
    from_previous: bool = True,
) -> RodSolution:
    """Follow the cases in their order, each from the one before it if that converged.

    seconds : of processor time that a case may take.
    step : share of the loads that is tried first from rest.
    """
    n, m = len(cases), len(stations)
    tips, rotations = np.full((n, 3), np.nan), np.full((n, 3, 3), np.nan)
    lines = np.full((n, m, 3), np.nan)
    factor, iterations = np.zeros(n), np.zeros(n, dtype=np.int64)
    status = []
    guess: Shape | None = None
    for i, case in enumerate(cases):
        found = follow(case, guess if from_previous else None, seconds, step)
        status.append(found.status)
        factor[i], iterations[i] = found.factor, found.iterations
        guess = None
        if found.status is RodStatus.CONVERGED:
            guess = found.shape
            lines[i], rotations[i] = case.drawn(found.shape)
            tips[i] = lines[i, -1]
    error = np.full(n, np.nan)
    return RodSolution(tuple(status), tips, rotations, factor, error, iterations, stations, lines)
