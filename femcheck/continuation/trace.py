"""Following the equilibria along one load, past limit points, without parameters to set."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, field

from beamopt.base.arrays import FloatArray
from femcheck.continuation.direct import DirectSolver, SingularMatrixError
from femcheck.continuation.limits import Budget, Limits
from femcheck.continuation.mode import unstable_mode
from femcheck.continuation.newton import Newton
from femcheck.continuation.outcome import Status
from femcheck.continuation.path import Path, PathPoint, is_limit, is_past, summit
from femcheck.continuation.stepper import Exhausted, Failed, Leg, Predictor, Slope, Stepper
from femcheck.solid.equilibrium import Equilibrium
from femcheck.solid.state import State

__all__ = ["PathSteps"]

FLAT = 0.05  # load by length of a path, scaled, below which a limit point may be near

End = tuple[Status, float]
"""What ended the stable part of a path, and at which load [kPa]."""


@dataclass(frozen=True, slots=True)
class PathSteps:
    """Settings of a trace; lengths are of the path in the scaled plane.

    first, longest, smallest : steps.
    brisk : iterations up to which the next step is longer, but after one that failed.
    narrow : share of the load to which a bifurcation is closed in.
    patience, tries : volume, over that at rest, and steps that a path is given past a limit point
        to become stable again at a higher load: a snap.
    most_points : of a path, all of which are held in memory; steps that do not reach the last
        stop with so many are too small.
    """

    newton: Newton = field(default_factory=lambda: Newton(most_iterations=8))
    first: float = 0.05
    longest: float = 0.4
    smallest: float = 1e-4
    brisk: int = 4
    narrow: float = 0.01
    patience: float = 0.5
    tries: int = 6
    most_points: int = 1000

    def trace(
        self,
        problem: Equilibrium,
        predictor: Predictor,
        direction: FloatArray,
        stops: Sequence[float],
        solver: DirectSolver,
        beyond: float | None = None,
        budget: Budget | None = None,
    ) -> Path:
        """Follow the equilibria at P · direction from rest to the last of the `stops`.

        Parameters
        ----------
        direction : (3,) load, its largest component 1.
        stops : ascending loads P [kPa] at which an equilibrium is wanted.
        beyond : volume over that at rest up to which the path is followed past a limit point; what
            chambers lose under suction counts as grown. By default `patience` more than at it.
        budget : what every iteration is taken from; None: the usual limits.
        """
        budget = budget or Limits().begin()
        stepper = Stepper(self.newton, problem, predictor, direction, stops, solver, budget)
        trace = _Trace(self, stepper, stops, beyond)
        began = time.process_time()
        status, critical = trace.follow()
        stepper.spent.seconds = time.process_time() - began
        mode = None
        if trace.lost is not None:
            state, load = trace.lost
            mode = unstable_mode(problem, state, load * direction, solver)
        stable = [point for point in trace.points if not is_past(point)]
        return Path(
            status=status,
            critical=critical,
            points=tuple(trace.points),
            stops=tuple(trace.found),
            last=max(stable, key=lambda point: point.load) if stable else None,
            snaps=tuple(trace.snaps),
            growth=trace.grown(trace.volume),
            mode=mode,
            statistics=stepper.spent,
        )


class _Trace:
    """One path while it is followed.

    points : so far. found : stable equilibria at the stops. snaps : limit points behind which it
    became stable again at a higher load. lost : state and load close behind where stability ended.
    volume : where it did.
    """

    def __init__(
        self, steps: PathSteps, stepper: Stepper, stops: Sequence[float], beyond: float | None
    ) -> None:
        self._steps, self._stepper, self._stops = steps, stepper, list(stops)
        self._beyond = beyond
        self.points: list[PathPoint] = []
        self.found: list[PathPoint | None] = [None] * len(stops)
        self.snaps: list[float] = []
        self.lost: tuple[State, float] | None = None
        self.volume = float("nan")
        self._ended: End | None = None
        self._ended_at = 0.0

    def follow(self) -> End:
        """Step by step to the last stop, to what ends the stable part, or to a limit.

        Work that is spent behind the end of the stable part leaves that end as it is, as it is
        the same each time. A clock that runs out there has left open whether there is a snap.
        """
        try:
            point, slope = self._stepper.start()
        except SingularMatrixError:
            return Status.LINEAR_SOLVER, 0.0
        self._take(point, None)
        try:
            return self._followed(point, slope)
        except Exhausted as limit:
            if self._ended is None:
                return limit.status, self.points[-1].load
            return (limit.status, self._ended[1]) if limit.status.is_interrupted else self._ended

    def _followed(self, point: PathPoint, slope: Slope) -> End:
        leg, length = Leg(point, slope, None), self._steps.first
        halved = False
        tries = self._steps.tries
        while len(self.points) < self._steps.most_points and not self._has_all():
            tried, slope_there, length = self._stepper.step(leg, length)
            if isinstance(tried, Failed):
                if self._ended is None and self._is_lost(leg, tried, length):
                    return Status.BUCKLED, leg.here.load
                length, halved = length / 2, True
                tries -= self._ended is not None
                if length < self._steps.smallest or tries < 0:
                    return self._ended or (tried.status, leg.here.load)
                continue
            if self._stepper.share_of_law(tried) > 1:
                passed = self._ended or self._passing(leg, tried, length)
                if passed is not None:
                    return passed
                if not is_past(tried):  # a snap within the step, to a shape beyond the law
                    length, halved = length / 2, True
                    if length < self._steps.smallest:
                        return Status.BEYOND_LAW, leg.here.load
                    continue
            if self._ended is None and is_past(tried):
                self._ended = self._ending(leg, tried, length)
                self._ended_at = leg.here.volume
            elif self._ended is not None and self._has_snapped(self._ended, tried):
                self.snaps.append(self._ended[1])
                self._ended, self.lost, tries = None, None, self._steps.tries
                self.volume = float("nan")
                self._catch_up(tried)
            self._take(tried, self._ended)
            if self._ended is not None and self._is_far(self._ended, tried):
                return self._ended
            assert slope_there is not None
            leg = Leg(tried, slope_there, (leg.slope, length))
            longer = self._stepper.iterations <= self._steps.brisk and not halved
            length = min(length * (2.0 if longer else 1.0), self._steps.longest)
            halved = False
        if all(point is not None for point in self.found):
            return Status.CONVERGED, float("nan")
        if self._has_all():
            return Status.STEP_TOO_SMALL, self.snaps[-1]
        return self._ended or (Status.STEP_TOO_SMALL, self.points[-1].load)

    def _take(self, point: PathPoint, ended: End | None) -> None:
        self.points.append(point)
        if ended is not None:
            return
        for place, stop in enumerate(self._stops):
            if self.found[place] is None and abs(point.load - stop) <= 1e-9 * max(stop, 1.0):
                self.found[place] = point

    def _catch_up(self, point: PathPoint) -> None:
        """Solve at the stops that a snap has jumped over."""
        for place, stop in enumerate(self._stops):
            if self.found[place] is None and stop <= point.load:
                solved = self._stepper.at(stop, point)
                if solved is None or is_past(solved):
                    continue
                if self._stepper.share_of_law(solved) <= 1:
                    self.found[place] = solved

    def _has_all(self) -> bool:
        return self.found[-1] is not None

    def _has_snapped(self, ended: End, point: PathPoint) -> bool:
        status, critical = ended
        return status is Status.LIMIT_POINT and not is_past(point) and point.load > critical

    def grown(self, volume: float) -> float:
        """Volume over that at rest; what chambers lose under suction counts as grown."""
        if not self.points:
            return float("nan")
        return 1 + (volume - self.points[0].volume) / float(self._stepper.scale[0])

    def _is_far(self, ended: End, point: PathPoint) -> bool:
        """Whether a path past its stable part has been followed far enough."""
        if self._beyond is not None:
            return self.grown(point.volume) >= self._beyond
        since = (point.volume - self._ended_at) / float(self._stepper.scale[0])
        return ended[0] is not Status.LIMIT_POINT or since >= self._steps.patience

    def _is_lost(self, leg: Leg, failed: Failed, length: float) -> bool:
        """Whether a short step failed because stability is lost on it.

        Close to a bifurcation the tangent is nearly singular and iterations diverge; that they
        began on the other side of it tells it from other failures.
        """
        if failed.unstable is None or failed.unstable < 1:
            return False
        rise = self._stepper.rise(leg.slope, length)
        is_short = length <= self._steps.first and 0 < rise <= self._steps.narrow * leg.here.load
        # where the load hardly rises, one direction is lost at a limit point too: halve on
        is_flat = failed.unstable == 1 and leg.slope.plane[1] < FLAT
        if not is_short or (is_flat and length / 2 >= self._steps.smallest):
            return False
        self.lost = failed.state, failed.load
        self.volume = leg.here.volume
        return True

    def _passing(self, leg: Leg, there: PathPoint, length: float) -> End | None:
        """At which load a step leaves what the law describes; None where stability ends before."""
        inside, outside, low, high = leg.here, there, 0.0, length
        steps, share = self._steps, self._stepper.share_of_law
        if share(inside) > 1:  # behind a snap, say
            return Status.BEYOND_LAW, inside.load
        while high - low >= steps.smallest and (
            abs(outside.load - inside.load) > steps.narrow * outside.load
        ):
            middle = (low + high) / 2
            tried, _, _ = self._stepper.step(leg, middle)
            if isinstance(tried, Failed):
                break
            if share(tried) > 1:
                outside, high = tried, middle
            elif is_past(tried):
                return None
            else:
                inside, low = tried, middle
        if inside is not leg.here:
            self._take(inside, None)
        part = (1 - share(inside)) / (share(outside) - share(inside))
        self.volume = float(inside.volume + part * (outside.volume - inside.volume))
        return Status.BEYOND_LAW, float(inside.load + part * (outside.load - inside.load))

    def _ending(self, leg: Leg, there: PathPoint, length: float) -> End:
        """What ended the stable part between two points, and at which load."""
        stable, lost, low, high = leg.here, there, 0.0, length
        top = _top(stable, lost)
        narrow = self._steps.narrow
        while not is_limit(lost) and top - stable.load > narrow * top:
            if high - low < self._steps.smallest:  # unstable from rest on, say
                break
            middle = (low + high) / 2
            tried, _, _ = self._stepper.step(leg, middle)
            if isinstance(tried, Failed):
                break
            if is_past(tried):
                lost, high = tried, middle
            else:
                stable, low = tried, middle
            top = _top(stable, lost)
        self.lost = lost.state, lost.load
        if not is_limit(lost):
            self.volume = stable.volume
            return Status.BUCKLED, stable.load
        self.volume = summit(stable, lost)[1]
        return Status.LIMIT_POINT, top


def _top(stable: PathPoint, lost: PathPoint) -> float:
    """Largest load between two points; past a limit point that of the second is less."""
    return summit(stable, lost)[0] if lost.growth < 0 else lost.load
