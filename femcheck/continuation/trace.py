"""Following the equilibria along one load, past limit points, without parameters to set.

Each step goes along the path's tangent in the plane of load and enclosed volume, scaled by the
load asked for and by the volume at rest; the corrector stays on the normal to it. Far from a limit
point of a stiff body that is load control, near that of a soft one volume control, and nobody sets
anything.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

import numpy as np

from beamopt.arrays import FloatArray
from femcheck.continuation.control import ArcControl, Mix
from femcheck.continuation.direct import DirectSolver, SingularMatrixError
from femcheck.continuation.mode import unstable_mode
from femcheck.continuation.newton import Newton, unstable_directions
from femcheck.continuation.outcome import Statistics, Status
from femcheck.continuation.path import Path, PathPoint, highest_load, is_limit, is_past
from femcheck.solid.equilibrium import Equilibrium
from femcheck.solid.state import State

__all__ = ["PathSteps", "Predictor"]


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


@dataclass(frozen=True, slots=True)
class PathSteps:
    """Settings of a trace; lengths are of the path in the scaled plane.

    first, longest, smallest : steps.
    brisk : iterations up to which the next step is longer.
    narrow : share of the load to which a bifurcation is closed in.
    seconds : time limit of a trace [s].
    """

    newton: Newton = field(default_factory=lambda: Newton(most_iterations=8))
    first: float = 0.05
    longest: float = 0.4
    smallest: float = 1e-4
    brisk: int = 4
    narrow: float = 0.01
    most_points: int = 200
    seconds: float = 900.0

    def trace(
        self,
        problem: Equilibrium,
        predictor: Predictor,
        direction: FloatArray,
        stops: Sequence[float],
        solver: DirectSolver,
        beyond: float | None = None,
    ) -> Path:
        """Follow the equilibria at P · direction from rest to the last of the `stops`.

        Parameters
        ----------
        direction : (3,) load, its largest component 1.
        stops : ascending loads P [kPa] at which an equilibrium is wanted.
        beyond : volume over that at rest up to which the path is followed past a limit point; what
            chambers lose under suction counts as grown. By default it ends with the first point
            behind it.
        """
        return _Trace(self, problem, predictor, direction, stops, solver).run(beyond)


class _Trace:
    """One path while it is followed."""

    def __init__(
        self,
        steps: PathSteps,
        problem: Equilibrium,
        predictor: Predictor,
        direction: FloatArray,
        stops: Sequence[float],
        solver: DirectSolver,
    ) -> None:
        self._steps, self._problem, self._predictor = steps, problem, predictor
        self._direction, self._stops, self._solver = direction, list(stops), solver
        self._deadline = time.perf_counter() + steps.seconds
        self._spent = Statistics()
        self._points: list[PathPoint] = []
        self._found: list[PathPoint | None] = [None] * len(stops)
        self._failed: tuple[int | None, State, float] | None = None
        self._lost: tuple[State, float] | None = None
        rest = problem.rest()
        worked_on = float(np.abs(direction) @ problem.volumes(rest))
        self._scale = np.array([worked_on or 1.0, self._stops[-1] or 1.0])

    def run(self, beyond: float | None) -> Path:
        began = time.perf_counter()
        status, critical = self._follow(beyond)
        self._spent.seconds = time.perf_counter() - began
        stable = [point for point in self._points if not is_past(point)]
        last = max(stable, key=lambda point: point.load) if stable else None
        points, found = tuple(self._points), tuple(self._found)
        mode = None
        if status is Status.BUCKLED and self._lost is not None:
            state, load = self._lost
            mode = unstable_mode(self._problem, state, load * self._direction, self._solver)
        return Path(status, critical, points, found, last, mode, self._spent)

    def _follow(self, beyond: float | None) -> tuple[Status, float]:
        rest = self._problem.rest()
        try:
            slope = self._at_rest(rest)
        except SingularMatrixError:
            return Status.LINEAR_SOLVER, 0.0
        if self._has_all():
            return Status.CONVERGED, float("nan")
        ended: tuple[Status, float] | None = None
        earlier: tuple[Slope, float] | None = None
        step = self._steps.first
        while len(self._points) < self._steps.most_points:
            here = self._points[-1]
            tried, slope_there, length = self._step(here, slope, earlier, step)
            if isinstance(tried, Status):
                step = length / 2
                if ended is None and self._is_lost_ahead(here, slope, length):
                    return Status.BUCKLED, here.load + self._rise(slope, step)
                if tried is Status.TIME_OUT or step < self._steps.smallest:
                    return ended or (tried, here.load)
                continue
            if ended is None and is_past(tried):
                ended = self._ending(here, tried, slope, earlier, length)
            self._points.append(tried)
            if ended is None:
                self._note(tried)
                if self._has_all():
                    return Status.CONVERGED, float("nan")
            elif beyond is None or self._grown(tried) >= beyond:
                return ended
            assert slope_there is not None
            earlier, slope = (slope, length), slope_there
            quick = self._iterations <= self._steps.brisk
            step = min(length * (2.0 if quick else 1.0), self._steps.longest)
        return ended or (Status.STEP_TOO_SMALL, self._points[-1].load)

    def _has_all(self) -> bool:
        return self._found[-1] is not None

    def _is_lost_ahead(self, here: PathPoint, slope: Slope, length: float) -> bool:
        """Whether a short step failed because stability is lost on it.

        Close to a bifurcation the tangent is nearly singular and iterations diverge; that they
        began on the other side of it tells it from other failures.
        """
        short = 0 < self._rise(slope, length) <= self._steps.narrow * here.load
        if not (short and self._failed is not None and self._failed[0]):
            return False
        self._lost = self._failed[1:]
        return True

    def _rise(self, slope: Slope, length: float) -> float:
        """Change of the load on a step [kPa]."""
        return float(slope.plane[1] * self._scale[1] * length)

    def _grown(self, point: PathPoint) -> float:
        return 1 + (point.volume - self._points[0].volume) / float(self._scale[0])

    def _at_rest(self, rest: State) -> Slope:
        nothing = np.zeros(3)
        forces = self._problem.forces(rest, nothing)
        self._solver.factor(self._problem.tangent(rest, nothing, forces))
        unstable = unstable_directions(self._problem, self._solver)
        point, slope = self._measured(rest, 0.0, unstable)
        self._points.append(point)
        if self._stops[0] <= 0:
            self._note(point)
        return slope

    def _note(self, point: PathPoint) -> None:
        for place, stop in enumerate(self._stops):
            if self._found[place] is None and abs(point.load - stop) <= 1e-9 * max(stop, 1.0):
                self._found[place] = point

    def _step(
        self, here: PathPoint, slope: Slope, earlier: tuple[Slope, float] | None, length: float
    ) -> tuple[PathPoint | Status, Slope | None, float]:
        """The next point, or why there is none; its slope; the length that was tried."""
        ahead = [stop for stop in self._stops if stop > here.load * (1 + 1e-9)]
        to_stop = (
            (ahead[0] - here.load) / self._rise(slope, 1.0)
            if ahead and not is_past(here)
            else np.inf
        )
        stops = length >= to_stop
        length = min(length, to_stop)
        at = np.array([here.volume, here.load]) / self._scale + length * slope.plane
        if stops:
            mix, target = Mix(0.0, 1.0), ahead[0]
        else:
            mix, target = Mix(*(slope.plane / self._scale)), float(slope.plane @ at)
        bend: FloatArray | float = 0.0
        if earlier is not None:
            bend = (slope.shape - earlier[0].shape) / earlier[1]
        shape = self._predictor.of(here.state) + length * (slope.shape + length / 2 * bend)
        guess = self._predictor.state(shape)
        control = ArcControl(self._direction, float(at[1] * self._scale[1]), mix, target)
        outcome = self._steps.newton.follow(
            self._problem, guess, control, self._solver, self._deadline
        )
        self._spent.add(outcome.statistics)
        self._iterations = outcome.statistics.iterations
        if outcome.state is None:
            self._failed = (outcome.negative_at_start, guess, float(at[1] * self._scale[1]))
            return outcome.status, None, length
        if not stops and to_stop < np.inf and control.load > ahead[0]:
            # a path that stiffens rises more than its tangent: back to the stop it went past
            return self._step(here, slope, earlier, to_stop)
        unstable = outcome.negative_eigenvalues
        try:
            point, slope_there = self._measured(outcome.state, control.load, unstable, slope)
        except SingularMatrixError:
            return Status.LINEAR_SOLVER, None, length
        return point, slope_there, length

    def _measured(
        self, state: State, load: float, unstable: int | None, before: Slope | None = None
    ) -> tuple[PathPoint, Slope]:
        """A point and the path's slope there; the tangent is factored in the solver."""
        gradient = self._problem.volume_gradient(state, self._direction)
        by_load = self._solver.solve(gradient)
        growth = float(gradient @ by_load)
        volume = float(self._direction @ self._problem.volumes(state))
        plane = np.array([growth, 1.0]) / self._scale
        rate = 1 / float(np.linalg.norm(plane))
        if before is not None and before.plane @ plane < 0:
            rate = -rate
        far = max(self._problem.support.extent(by_load)[0], 1e-300)
        small = 1e-4 / far  # mm of the largest displacement
        near = self._predictor.of(self._problem.moved(state, small * by_load))
        change = (near - self._predictor.of(state)) / small
        return (
            PathPoint(state, load, volume, growth, unstable),
            Slope(rate * plane, rate * change),
        )

    def _ending(
        self,
        here: PathPoint,
        there: PathPoint,
        slope: Slope,
        earlier: tuple[Slope, float] | None,
        length: float,
    ) -> tuple[Status, float]:
        """What ended the stable part between two points, and at which load."""
        stable, lost, low, high = here, there, 0.0, length
        top = _top(stable, lost)
        while not is_limit(lost) and top - stable.load > self._steps.narrow * top:
            if high - low < self._steps.smallest:  # unstable from rest on, say
                break
            middle = (low + high) / 2
            tried, _, _ = self._step(here, slope, earlier, middle)
            if isinstance(tried, Status):
                break
            if is_past(tried):
                lost, high = tried, middle
            else:
                stable, low = tried, middle
            top = _top(stable, lost)
        if is_limit(lost):
            return Status.LIMIT_POINT, top
        self._lost = (lost.state, lost.load)
        return Status.BUCKLED, (stable.load + top) / 2


def _top(stable: PathPoint, lost: PathPoint) -> float:
    """Largest load between two points; past a limit point that of the second is less."""
    return highest_load(stable, lost) if lost.growth < 0 else lost.load
