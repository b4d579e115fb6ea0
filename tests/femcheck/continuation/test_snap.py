"""What a trace makes of paths that turn, jump and fail: scripted points, no solid."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from femcheck.continuation.outcome import Statistics, Status
from femcheck.continuation.path import PathPoint
from femcheck.continuation.stepper import Exhausted, Failed, Leg, Slope
from femcheck.continuation.trace import PathSteps, _Trace

STATE: Any = None


def point(load: float, volume: float, growth: float = 1.0, unstable: int = 0) -> PathPoint:
    return PathPoint(STATE, load, volume, growth, unstable)


Script = Sequence[PathPoint | Failed | Exhausted]


class Scripted:
    """Gives one thing after the other, whatever is asked for; finds every stop that is asked at.

    most : volume up to which the law describes the body.
    """

    def __init__(self, script: Script, slope: float = 0.5, most: float = np.inf) -> None:
        self._most = most
        self._script = iter(script)
        self._slope = Slope(np.array([1.0 - slope, slope]), np.zeros(1))
        self.scale = np.array([100.0, 100.0])
        self.iterations = 3
        self.spent = Statistics()
        self.lengths: list[float] = []

    def start(self) -> tuple[PathPoint, Slope]:
        return point(0.0, 100.0), self._slope

    def rise(self, slope: Slope, length: float) -> float:
        return float(slope.plane[1] * self.scale[1] * length)

    def step(self, leg: Leg, length: float) -> tuple[PathPoint | Failed, Slope | None, float]:
        self.lengths.append(length)
        given = next(self._script)
        if isinstance(given, Exhausted):
            raise given
        return given, self._slope, length

    def share_of_law(self, point: PathPoint) -> float:
        return point.volume / self._most

    def at(self, load: float, near: PathPoint) -> PathPoint | None:
        return point(load, near.volume)


def trace(script: Script, stops: list[float], slope: float = 0.5, most: float = np.inf) -> Any:
    stepper: Any = Scripted(script, slope, most)
    done = _Trace(PathSteps(), stepper, stops, None)
    return done, done.follow()


def test_a_stop_that_a_snap_jumps_over_is_solved_for() -> None:
    """A limit point at 49, back to 47, and stable again at 55: the stop at 50 lies between."""
    script = [
        point(49.0, 130.0, 5.0),
        point(47.0, 140.0, -5.0, 1),
        point(55.0, 150.0),
        point(100.0, 160.0),
    ]
    done, (status, critical) = trace(script, [50.0, 100.0])
    assert status is Status.CONVERGED
    assert np.isnan(critical)
    assert [found.load for found in done.found] == [50.0, 100.0]
    assert len(done.snaps) == 1
    assert 49.0 <= done.snaps[0] < 50.0
    assert done.lost is None  # what was lost there was won again
    assert np.isnan(done.volume)


def test_growth_is_that_of_the_last_end_and_not_of_a_snap() -> None:
    script = [
        point(49.0, 130.0, 5.0),
        point(47.0, 140.0, -5.0, 1),
        point(55.0, 150.0),
        point(60.0, 180.0),
        *[failed(Status.STEP_TOO_SMALL, 2)] * 30,
    ]
    done, (status, critical) = trace(script, [50.0, 100.0], slope=0.06)
    assert (status, critical) == (Status.BUCKLED, 60.0)
    assert done.grown(done.volume) == pytest.approx(1.8)


def test_a_snap_to_what_no_law_describes_is_none() -> None:
    """The path ends at its limit point, though it is stable again beyond the law."""
    script = [point(49.0, 130.0, 5.0), point(47.0, 140.0, -5.0, 1), point(55.0, 150.0)]
    done, (status, critical) = trace(script, [50.0, 100.0], most=145.0)
    assert status is Status.LIMIT_POINT
    assert 49.0 <= critical < 50.0
    assert done.found == [None, None]
    assert done.snaps == []


def test_the_load_at_which_a_law_is_left_is_closed_in() -> None:
    """Halved until the loads differ by a hundredth, then in a straight line; no stop is beyond."""
    script = [
        *(point(40.0, 120.0), point(60.0, 170.0)),
        *(point(50.0, 145.0), point(55.0, 155.0), point(52.5, 150.5), point(52.0, 149.5)),
    ]
    done, (status, critical) = trace(script, [60.0], most=150.0)
    assert status is Status.BEYOND_LAW
    assert critical == pytest.approx(52.25)
    assert done.points[-1].load == 52.0
    assert done.found == [None]
    assert done.grown(done.volume) == pytest.approx(1 + 0.5)


def test_stability_that_is_lost_before_the_law_ends_counts() -> None:
    """Between two points the path turned, and only then left what the law describes."""
    fallen = [point(load, volume, -5.0, 1) for load, volume in ((40, 170), (48, 145), (39, 180))]
    script = [point(49.0, 130.0, 5.0), *fallen]
    _, (status, critical) = trace(script, [60.0], most=150.0)
    assert status is Status.LIMIT_POINT
    assert critical >= 49.0


def test_a_snap_within_a_step_does_not_lead_beyond_the_law() -> None:
    """Halfway the path has turned, and at its end it is stable again where no law holds."""
    script = [
        *(point(49.0, 130.0, 5.0), point(60.0, 170.0), point(48.0, 145.0, -5.0, 1)),
        *(point(48.0, 145.0, -5.0, 1), point(48.9, 132.0, -1.0, 1), point(39.0, 180.0, -5.0, 1)),
    ]
    done, (status, critical) = trace(script, [55.0], most=150.0)
    assert status is Status.LIMIT_POINT
    assert 49.0 <= critical < 50.0
    assert done.found == [None]
    assert max(one.volume for one in done.points) <= 150.0


def test_a_stop_jumped_over_has_no_answer_beyond_the_law() -> None:
    fallen = [point(49.0, 130.0, 5.0), point(47.0, 140.0, -5.0, 1), point(55.0, 149.0)]
    script = [*fallen, point(60.0, 152.0), *[point(60.0, 150.1)] * 30]

    class Wider(Scripted):
        def at(self, load: float, near: PathPoint) -> PathPoint | None:
            return point(load, 151.0)

    stepper: Any = Wider(script, most=150.0)
    done = _Trace(PathSteps(), stepper, [50.0, 100.0], None)
    status, _ = done.follow()
    assert status is Status.BEYOND_LAW
    assert done.found == [None, None]


def test_a_path_that_stays_lost_ends_at_its_limit() -> None:
    falling = [point(47.0 - k, 140.0 + 20 * k, -5.0, 1) for k in range(6)]
    done, (status, critical) = trace([point(49.0, 130.0, 5.0), *falling], [50.0])
    assert status is Status.LIMIT_POINT
    assert critical == pytest.approx(49.0, abs=1.0)
    assert done.snaps == []
    assert done.found == [None]
    assert len(done.points) < 8  # half a volume at rest behind the limit, no more


def failed(status: Status, unstable: int | None) -> Failed:
    return Failed(status, unstable, STATE, 40.0)


@pytest.mark.parametrize("limit", [Status.TIME_OUT, Status.WORK_LIMIT])
def test_a_limit_that_is_reached_is_no_buckling(limit: Status) -> None:
    script = [point(40.0, 120.0), Exhausted(limit)]
    _, (status, critical) = trace(script, [50.0], slope=0.01)
    assert status is limit
    assert critical == 40.0


def test_a_clock_that_runs_out_behind_a_limit_point_leaves_a_snap_open() -> None:
    """Work is the same each time, so that what it ends stays; a clock is not."""
    fallen = [point(49.0, 130.0, 5.0), point(47.0, 140.0, -5.0, 1)]
    for limit, wanted in (
        (Status.TIME_OUT, Status.TIME_OUT),
        (Status.WORK_LIMIT, Status.LIMIT_POINT),
    ):
        _, (status, critical) = trace([*fallen, Exhausted(limit)], [50.0, 100.0])
        assert status is wanted
        assert 49.0 <= critical < 50.0


@pytest.mark.parametrize(("unstable", "slope"), [(2, 0.01), (1, 0.06)])
def test_a_short_step_that_begins_unstable_tells_a_bifurcation(unstable: int, slope: float) -> None:
    fails = [failed(Status.STEP_TOO_SMALL, unstable)] * 30
    done, (status, critical) = trace([point(40.0, 120.0), *fails], [50.0], slope)
    assert status is Status.BUCKLED
    assert critical == 40.0
    assert done.lost is not None


def test_one_direction_lost_on_a_flat_path_is_followed_down_first() -> None:
    """It may be a limit point: the step is halved as far as it goes."""
    fails = [failed(Status.STEP_TOO_SMALL, 1)] * 30
    stepper: Any = Scripted([point(40.0, 120.0), *fails], 0.01)
    done = _Trace(PathSteps(), stepper, [50.0], None)
    status, _ = done.follow()
    assert status is Status.BUCKLED
    assert stepper.lengths[-1] < 2e-4


@pytest.mark.parametrize("unstable", [0, None])
def test_what_fails_without_a_lost_direction_has_failed(unstable: int | None) -> None:
    fails = [failed(Status.INVERTED, unstable)] * 30
    _, (status, critical) = trace([point(40.0, 120.0), *fails], [50.0])
    assert status is Status.INVERTED
    assert critical == 40.0
