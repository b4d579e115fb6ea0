"""One step along a path of equilibria: predicted along its tangent, corrected on the normal to it.

The tangent is that in the plane of load and enclosed volume, scaled by the load asked for and by
the volume at rest. Far from a limit point of a stiff body that is load control, near that of a soft
one volume control, and nobody sets anything.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np

from beamopt.base.arrays import FloatArray
from femcheck.continuation.control import ArcControl, Control, Mix
from femcheck.continuation.direct import DirectSolver, SingularMatrixError
from femcheck.continuation.limits import Budget
from femcheck.continuation.newton import Newton, unstable_directions
from femcheck.continuation.outcome import SolidOutcome, Statistics, Status
from femcheck.continuation.path import PathPoint, is_past
from femcheck.solid.equilibrium import Equilibrium
from femcheck.solid.state import State

__all__ = ["Exhausted", "Failed", "Leg", "Predictor", "Slope", "Stepper"]


class Exhausted(Exception):  # noqa: N818
    """A limit was reached within a step. status : which one."""

    def __init__(self, status: Status) -> None:
        super().__init__(status.value)
        self.status = status


class Predictor(Protocol):
    """States as vectors that can be extrapolated; `Shapes` for actuators."""

    def of(self, state: State) -> FloatArray:
        """The vector of a state."""
        ...

    def state(self, shape: FloatArray) -> State:
        """The state of a vector."""
        ...


class Slope(NamedTuple):
    """Tangent of a path by its length: unit vector (volume, load), scaled, and d shape."""

    plane: FloatArray
    shape: FloatArray


class Leg(NamedTuple):
    """Where a step begins: a point, its slope, and slope and length of the step before."""

    here: PathPoint
    slope: Slope
    before: tuple[Slope, float] | None


class Failed(NamedTuple):
    """A step that found nothing, and the state it was begun from.

    unstable : directions in which the potential falls there; None: not known.
    """

    status: Status
    unstable: int | None
    state: State
    load: float


class Stepper:
    """Steps along P · direction of one problem, with one solver.

    iterations : of the last step. spent : on all of them.
    """

    def __init__(
        self,
        newton: Newton,
        problem: Equilibrium,
        predictor: Predictor,
        direction: FloatArray,
        stops: Sequence[float],
        solver: DirectSolver,
        budget: Budget,
    ) -> None:
        self._newton, self._problem, self._predictor = newton, problem, predictor
        self._direction, self._stops, self._solver = direction, list(stops), solver
        self._budget = budget
        self.spent = Statistics()
        self.iterations = 0
        worked_on = float(np.abs(direction) @ problem.volumes(problem.rest()))
        self.scale = np.array([worked_on or 1.0, self._stops[-1] or 1.0])

    def start(self) -> tuple[PathPoint, Slope]:
        """Rest, and the slope there.

        Raises
        ------
        SingularMatrixError : the tangent at rest can not be factored.
        """
        rest, nothing = self._problem.rest(), np.zeros(3)
        forces = self._problem.forces(rest, nothing)
        self._solver.factor(self._problem.tangent(rest, nothing, forces))
        unstable = unstable_directions(self._problem, self._solver)
        return self._measured(rest, 0.0, unstable)

    def rise(self, slope: Slope, length: float) -> float:
        """Change of the load on a step [kPa]."""
        return float(slope.plane[1] * self.scale[1] * length)

    def step(self, leg: Leg, length: float) -> tuple[PathPoint | Failed, Slope | None, float]:
        """The next point, or how it failed; its slope; the length that was tried.

        A step that would go past a stop ends on it.

        Raises
        ------
        Exhausted : the budget is spent.
        """
        here, slope, before = leg
        to_stop, stop = self._to_stop(here, slope)
        stops = length >= to_stop
        length = min(length, to_stop)
        at = np.array([here.volume, here.load]) / self.scale + length * slope.plane
        if stops:
            mix, target = Mix(0.0, 1.0), stop
        else:
            mix, target = Mix(*(slope.plane / self.scale)), float(slope.plane @ at)
        bend: FloatArray | float = 0.0
        if before is not None:
            bend = (slope.shape - before[0].shape) / before[1]
        shape = self._predictor.of(here.state) + length * (slope.shape + length / 2 * bend)
        guess, load = self._predictor.state(shape), float(at[1] * self.scale[1])
        control = ArcControl(self._direction, load, mix, target)
        outcome = self._followed(guess, control)
        self.iterations = outcome.statistics.iterations
        if outcome.state is None:
            return Failed(outcome.status, outcome.negative_at_start, guess, load), None, length
        if not stops and to_stop < np.inf and control.load > stop:
            # a path that stiffens rises more than its tangent: back to the stop it went past
            return self.step(leg, to_stop)
        unstable = outcome.negative_eigenvalues
        try:
            point, there = self._measured(outcome.state, control.load, unstable, slope)
        except SingularMatrixError:
            return Failed(Status.LINEAR_SOLVER, None, guess, load), None, length
        return point, there, length

    def at(self, load: float, near: PathPoint) -> PathPoint | None:
        """The equilibrium at a load near a point; None where it is not found.

        Raises
        ------
        Exhausted : the budget is spent.
        """
        control = ArcControl(self._direction, near.load, Mix(0.0, 1.0), load)
        outcome = self._followed(near.state, control)
        if outcome.state is None:
            return None
        return self._measured(outcome.state, load, outcome.negative_eigenvalues)[0]

    def _followed(self, guess: State, control: Control) -> SolidOutcome:
        outcome = self._newton.follow(self._problem, guess, control, self._solver, self._budget)
        self.spent.add(outcome.statistics)
        if outcome.status.is_limit:
            raise Exhausted(outcome.status)
        return outcome

    def share_of_law(self, point: PathPoint) -> float:
        """Largest stretch at a point over the largest of the law; 0 where that has no end."""
        most = self._problem.law.most_stretch
        return self._problem.largest_stretch(point.state)[0] / most if np.isfinite(most) else 0.0

    def _to_stop(self, here: PathPoint, slope: Slope) -> tuple[float, float]:
        """Length to the next load asked for, and that load; infinite where there is none."""
        ahead = [stop for stop in self._stops if stop > here.load * (1 + 1e-9)]
        rise = self.rise(slope, 1.0)
        if not ahead or is_past(here) or rise <= 0:
            return float("inf"), float("nan")
        return (ahead[0] - here.load) / rise, ahead[0]

    def _measured(
        self, state: State, load: float, unstable: int | None, before: Slope | None = None
    ) -> tuple[PathPoint, Slope]:
        """A point and the path's slope there; the tangent is factored in the solver."""
        gradient = self._problem.volume_gradient(state, self._direction)
        by_load = self._solver.solve(gradient)
        growth = float(gradient @ by_load)
        volume = float(self._direction @ self._problem.volumes(state))
        plane = np.array([growth, 1.0]) / self.scale
        rate = 1 / float(np.linalg.norm(plane))
        if before is not None and before.plane @ plane < 0:
            rate = -rate
        far = max(self._problem.support.extent(by_load)[0], 1e-300)
        small = 1e-4 / far  # mm of the largest displacement
        near = self._predictor.of(self._problem.moved(state, small * by_load))
        change = (near - self._predictor.of(state)) / small
        point = PathPoint(state, load, volume, growth, unstable)
        return point, Slope(rate * plane, rate * change)
