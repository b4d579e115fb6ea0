"""Paths of small bodies: limit points, what lies behind them, stops, bifurcations, every ending."""

import time
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from beamopt.base.arrays import FloatArray
from femcheck.assembly.reduction import UpperMatrix
from femcheck.continuation.direct import (
    DirectSolver,
    SingularMatrixError,
    direct_solver,
)
from femcheck.continuation.limits import Limits
from femcheck.continuation.newton import Newton
from femcheck.continuation.outcome import Status
from femcheck.continuation.path import Path, PathPoint, summit
from femcheck.continuation.shape import Shapes
from femcheck.continuation.trace import PathSteps
from femcheck.material.gent import Gent
from femcheck.material.neo_hookean import NeoHookean
from femcheck.material.rigid_section import RigidSection
from femcheck.solid.equilibrium import Equilibrium, actuator
from femcheck.solid.state import State
from tests.clocks import Clock, run_away
from tests.femcheck.inertia import needs_inertia
from tests.femcheck.solid.tubes import tube

E = 300.0
PRESS = np.array([1.0, 0.0, 0.0])
SUCK = -PRESS
FAR = 200.0  # kPa that no soft tube holds


@pytest.fixture(scope="module")
def soft() -> Equilibrium:
    """An eccentric tube of incompressible rubber: it bends while it grows."""
    return actuator(tube(4.0, 5.0, 20.0, shift=0.3), NeoHookean(E))


@pytest.fixture(scope="module")
def stiff(soft: Equilibrium) -> Equilibrium:
    return actuator(tube(4.0, 5.0, 20.0, shift=0.3), RigidSection(E, 1000.0))


@pytest.fixture(scope="module")
def stiffening() -> Equilibrium:
    return actuator(tube(4.0, 5.0, 20.0), Gent(E, Jm=2.0))


@pytest.fixture(scope="module")
def traced(soft: Equilibrium) -> Path:
    return follow(soft, [5.0, 12.0, FAR], beyond=3.5)


def follow(
    problem: Equilibrium,
    stops: list[float],
    direction: FloatArray = PRESS,
    steps: PathSteps | None = None,
    solver: DirectSolver | None = None,
    beyond: float | None = None,
    limits: Limits | None = None,
) -> Path:
    shapes, steps, solver = Shapes(problem.body), steps or PathSteps(), solver or direct_solver()
    budget = None if limits is None else limits.begin()
    return steps.trace(problem, shapes, direction, stops, solver, beyond, budget)


class Failing:
    """A solver that fails from a certain factorisation on, or at a certain solution."""

    name = "failing"

    def __init__(self, factors: float = np.inf, solves: float = np.inf) -> None:
        self._solver: DirectSolver = direct_solver()
        self._factors, self._solves = factors, solves
        self.factor_seconds = self.solve_seconds = 0.0

    def factor(self, matrix: UpperMatrix) -> None:
        self._factors -= 1
        if self._factors < 0:
            raise SingularMatrixError("told to")
        self._solver.factor(matrix)

    def solve(self, right: FloatArray) -> FloatArray:
        self._solves -= 1
        if self._solves < 0:
            raise SingularMatrixError("told to")
        return self._solver.solve(right)

    @property
    def negative_eigenvalues(self) -> int | None:
        return self._solver.negative_eigenvalues


# limit points


def test_the_limit_point_is_that_of_a_finely_stepped_path(soft: Equilibrium, traced: Path) -> None:
    """A cubic through two points against the largest load of many: 0.1 % (measured: 0.001 %)."""
    assert traced.status is Status.LIMIT_POINT
    fine = follow(soft, [FAR], steps=PathSteps(longest=0.05))
    assert fine.status is Status.LIMIT_POINT
    assert len(fine.points) > 3 * len(traced.points) / 2
    loads = [point.load for point in fine.points]
    assert traced.critical == pytest.approx(max(loads), rel=1e-3)
    assert fine.critical == pytest.approx(max(loads), rel=1e-4)
    assert traced.stops[2] is None
    assert traced.last is not None
    assert traced.last.load == max(p.load for p in traced.points if p.growth > 0)


def test_past_the_limit_the_load_falls_while_the_volume_grows(traced: Path) -> None:
    loads = np.array([point.load for point in traced.points])
    volumes = np.array([point.volume for point in traced.points])
    growth = np.array([point.growth for point in traced.points])
    assert (np.diff(volumes) > 0).all()
    past = growth < 0
    first = int(np.argmax(past))
    assert past[first:].all()
    assert past.sum() >= 2
    assert (np.diff(loads[:first]) > 0).all()
    assert (np.diff(loads[first:]) < 0).all()
    assert volumes[-1] >= 3.5 * volumes[0]
    assert volumes[-2] < 3.5 * volumes[0]


def test_the_prediction_follows_the_path_s_bend(soft: Equilibrium) -> None:
    """Short steps take one iteration each; along the tangent alone they take two."""
    path = follow(soft, [FAR], steps=PathSteps(first=0.02, longest=0.02, most_points=31))
    assert path.statistics.iterations < 1.2 * len(path.points)


@needs_inertia
def test_one_direction_is_unstable_past_the_limit(traced: Path) -> None:
    assert [point.unstable for point in traced.points] == [
        int(point.growth < 0) for point in traced.points
    ]


def test_growth_is_the_slope_of_the_path(soft: Equilibrium) -> None:
    """DV/dP between neighbours of a fine path, against the mean of theirs, to 2 %; both branches.

    Where it changes its sign it has a pole: there dP/dV is compared.
    """
    points = follow(soft, [FAR], steps=PathSteps(longest=0.05), beyond=3.0).points
    for one, two in pairwise(points):
        slope = (two.load - one.load) / (two.volume - one.volume)
        assert slope == pytest.approx((1 / one.growth + 1 / two.growth) / 2, rel=0.02, abs=1e-5)


def test_every_point_is_an_equilibrium(soft: Equilibrium, traced: Path) -> None:
    """Out-of-balance forces, against what walls and caps carry [mN]; volume gaps to 1e-4 mm³."""
    for point in traced.points[1:]:
        forces = soft.forces(point.state, point.load * PRESS).reduced
        carried = soft.volume_gradient(point.state, point.load * PRESS)
        assert np.abs(forces).max() < 1e-4 * np.abs(carried).max()
        assert point.volume == pytest.approx(soft.volumes(point.state)[0])


def test_constant_pressure_below_the_limit_converges_and_above_does_not(
    soft: Equilibrium, traced: Path
) -> None:
    """From the last stable point: 1 % below there is one, 1 % above there is no stable one."""
    assert traced.last is not None
    tried = {
        share: Newton().solve(
            soft, traced.last.state, share * traced.critical * PRESS, direct_solver()
        )
        for share in (0.99, 1.01)
    }
    assert tried[0.99].status is Status.CONVERGED
    assert tried[0.99].negative_eigenvalues in (0, None)
    above = tried[1.01]
    assert above.status is not Status.CONVERGED or above.negative_eigenvalues != 0


def test_the_limit_point_without_inertia(soft: Equilibrium, traced: Path) -> None:
    """SuperLU counts nothing: the limit point shows by the growth alone."""
    plain = follow(soft, [5.0, 12.0, FAR], solver=direct_solver("superlu"))
    assert plain.status is Status.LIMIT_POINT
    assert plain.critical == pytest.approx(traced.critical, rel=1e-6)
    assert all(point.unstable is None for point in plain.points)


def test_a_solver_that_was_used_before_changes_nothing(
    soft: Equilibrium, stiff: Equilibrium, traced: Path
) -> None:
    solver = direct_solver()
    follow(stiff, [20.0], solver=solver)
    for _ in range(2):
        again = follow(soft, [5.0, 12.0, FAR], solver=solver, beyond=3.5)
        assert again.status is traced.status
        assert again.critical == pytest.approx(traced.critical, rel=1e-9)
        assert [p.load for p in again.points] == pytest.approx([p.load for p in traced.points])


# stops


def at_pressure(problem: Equilibrium, start: State, pressures: FloatArray) -> FloatArray:
    outcome = Newton(tolerance=1e-7).solve(problem, start, pressures, direct_solver())
    assert outcome.status is Status.CONVERGED
    assert outcome.state is not None
    return outcome.state.x


def test_stops_are_hit(soft: Equilibrium, traced: Path) -> None:
    """The load to rounding, the state to 1e-6 mm: what one more Newton step would change."""
    for stop, load in zip(traced.stops[:2], (5.0, 12.0), strict=True):
        assert stop is not None
        assert stop.load == pytest.approx(load, rel=1e-12)
        assert any(stop is point for point in traced.points)
        exact = at_pressure(soft, stop.state, load * PRESS)
        assert np.abs(exact - stop.state.x).max() < 1e-6


def test_stops_do_not_depend_on_each_other(soft: Equilibrium, traced: Path) -> None:
    """Alone or among others: the same equilibrium, to Newton's tolerance."""
    alone = follow(soft, [12.0])
    assert alone.status is Status.CONVERGED
    assert np.isnan(alone.critical)
    assert alone.stops[0] is not None
    assert traced.stops[1] is not None
    tolerance = Newton().tolerance
    assert np.abs(alone.stops[0].state.x - traced.stops[1].state.x).max() < tolerance
    assert alone.points[-1] is alone.stops[0] is alone.last


@pytest.mark.parametrize("first", [20.0, 34.0, 40.0, 50.0, 78.0, 85.0, 98.0])
def test_a_path_that_stiffens_does_not_go_past_its_stops(
    stiffening: Equilibrium, first: float
) -> None:
    """Gent's rubber near its limit: loads rise more than the tangent says."""
    path = follow(stiffening, [first, 150.0], steps=PathSteps(most_points=30))
    assert path.status is Status.CONVERGED
    assert [stop and stop.load for stop in path.stops] == pytest.approx([first, 150.0], rel=1e-12)


def test_a_single_stop_far_up_a_path_that_stiffens(stiffening: Equilibrium) -> None:
    path = follow(stiffening, [300.0], steps=PathSteps(most_points=30))
    assert path.status is Status.CONVERGED
    assert path.points[-1].load == pytest.approx(300.0, rel=1e-12)


def test_a_stiff_body_takes_few_points(stiff: Equilibrium) -> None:
    """From rest, and a step that doubles: five points and one a stop are enough."""
    path = follow(stiff, [0.0, 10.0, 20.0])
    assert path.status is Status.CONVERGED
    assert np.isnan(path.critical)
    assert [stop and stop.load for stop in path.stops] == pytest.approx([0, 10, 20])
    assert path.stops[0] is path.points[0]
    np.testing.assert_array_equal(path.points[0].state.x, stiff.body.nodes)
    assert len(path.points) <= 8
    assert path.last is path.points[-1]
    assert path.statistics.iterations <= 3 * len(path.points)
    assert path.statistics.seconds > path.statistics.factor_seconds > 0
    for stop, load in zip(path.stops[1:], (10.0, 20.0), strict=True):
        assert stop is not None
        exact = at_pressure(stiff, stop.state, load * PRESS)
        assert np.abs(exact - stop.state.x).max() < 1e-6


def test_rest_alone(soft: Equilibrium) -> None:
    path = follow(soft, [0.0])
    assert path.status is Status.CONVERGED
    assert path.stops == path.points
    assert len(path.points) == 1
    assert path.last is path.points[0]


def test_a_load_on_chambers_that_are_not_there(soft: Equilibrium) -> None:
    """Nothing moves, and every stop is an equilibrium."""
    path = follow(soft, [5.0, 50.0], direction=np.array([0.0, 1.0, 0.0]))
    assert path.status is Status.CONVERGED
    assert path.stops[1] is not None
    np.testing.assert_allclose(path.stops[1].state.x, soft.body.nodes, atol=1e-9)
    assert path.stops[1].volume == path.stops[1].growth == 0


# bifurcations


def test_suction_does_not_buckle_a_column() -> None:
    """Sections that stay rigid: V = a ∫ (1 + ε) ds, linear in the strains, and so Π is convex.

    Suction on a straight closed cavity of area a pulls the cap down by P a, but the cavity loses
    just that force: what buckles a column is N_wall − p a, which is zero in every section. In
    strains: Π = ∫ ½ E A ε² + ½ E I κ² − P a ε, a rest strain, with one minimum ε = P a/(E A). A
    dead weight of this size would have buckled it at π² E I/(4 L²) long before.
    """
    load, length = 20.0, 200.0
    body = tube(3.0, 5.0, length, 8, 4)
    moments = body.extrusion.section.moments
    bore, wall = moments.chamber_areas[0], moments.area
    inertia = moments.raw[0, 3]
    dead = np.pi**2 * E * inertia / (4 * length**2)
    assert load * bore > 50 * dead
    path = follow(actuator(body, RigidSection(E, 1000.0)), [load], direction=SUCK)
    assert path.status is Status.CONVERGED
    assert path.stops[0] is not None
    assert path.stops[0].unstable in (0, None)
    shortened = 1 - load * bore / (E * wall)
    tip = path.stops[0].state.tip
    # the section gives way by P/(cE) in its plane
    np.testing.assert_allclose(tip, [0, 0, shortened * length], atol=1e-4 * length)


@needs_inertia
@pytest.mark.parametrize("around", [16, 24])
def test_suction_flattens_a_tube(around: int) -> None:
    """Lévy's ring under external pressure: P = 3 E/(1 − ν²)/12 (t/R)³, two waves around.

    A long tube, R = 5, t = 0.8, L = 100. The formula is that of a thin ring, free along its axis:
    a thick wall (t/R = 0.16), clamped ends and chords for arcs are not in it; how much each of them
    adds was not separated. Measured: 5.4 % above it with 16 chords, 4.5 % with 24, both to the 1 %
    to which a bifurcation is closed in.
    """
    R, t = 5.0, 0.8
    ring = 3 * E / (1 - 0.25) / 12 * (t / R) ** 3
    problem = actuator(tube(R - t / 2, R + t / 2, 100.0, around, 4), NeoHookean(E))
    path = follow(problem, [10.0], direction=SUCK)
    assert path.status is Status.BUCKLED
    assert path.critical == pytest.approx(ring, rel=0.08)
    assert path.critical > ring
    assert path.stops == (None,)
    buckled, stable = path.points[-1], path.points[-2]
    assert buckled.growth > 0
    assert buckled.unstable is not None
    assert buckled.unstable >= 2  # the waves may stand at any angle
    assert stable.unstable == 0
    assert stable.load < path.critical < buckled.load
    assert path.last is stable


@needs_inertia
def test_a_bifurcation_is_closed_in() -> None:
    """Twice: from steps that differ, loads that agree to the share `narrow` and no worse."""
    problem = actuator(tube(4.6, 5.4, 100.0, 16, 4), NeoHookean(E))
    found = [
        follow(problem, [10.0], SUCK, PathSteps(first=first, longest=0.1, narrow=narrow)).critical
        for first, narrow in ((0.05, 0.01), (0.037, 0.001))
    ]
    assert found[0] == pytest.approx(found[1], rel=0.0105)


@needs_inertia
def test_without_inertia_a_bifurcation_is_not_seen() -> None:
    """The symmetric path has growth > 0: a solver that counts nothing goes on along it."""
    problem = actuator(tube(4.6, 5.4, 100.0, 16, 4), NeoHookean(E))
    path = follow(problem, [1.0], SUCK, solver=direct_solver("superlu"))
    assert path.status is Status.CONVERGED
    assert path.last is not None
    assert path.last.unstable is None


@needs_inertia
def test_a_limit_point_and_a_bifurcation_in_one_step() -> None:
    """A longer tube bulges to one side right behind its limit point; a long step passes both.

    Which of them was first is found between the two points, and so is the load.
    """
    problem = actuator(tube(4.0, 5.0, 60.0, layers=4), NeoHookean(E))
    fine = follow(problem, [FAR])
    long = follow(problem, [FAR], steps=PathSteps(longest=2.0))
    assert long.points[-1].growth < 0
    assert long.points[-1].unstable == 2
    assert long.status is fine.status is Status.LIMIT_POINT
    assert long.critical == pytest.approx(fine.critical, rel=1e-3)


class Pessimist(Failing):
    """A solver that finds one unstable direction in everything but the first tangent."""

    def factor(self, matrix: UpperMatrix) -> None:
        super().factor(matrix)
        self.first = not hasattr(self, "first")

    @property
    def negative_eigenvalues(self) -> int | None:
        size, first = self._hydrostatic, self.first
        return size if first else size + 1

    def __init__(self, problem: Equilibrium) -> None:
        super().__init__()
        self._hydrostatic = problem.hydrostatic_unknowns


def test_a_path_that_is_unstable_from_rest_on_ends(soft: Equilibrium) -> None:
    """There is no share of no load to be closed in to."""
    path = follow(soft, [5.0], solver=Pessimist(soft))
    assert path.status is Status.BUCKLED
    assert 0 <= path.critical < 5e-3
    assert path.last is path.points[0]


# other endings


def test_time_out(soft: Equilibrium) -> None:
    path = follow(soft, [5.0], limits=Limits(seconds=0.0))
    assert path.status is Status.TIME_OUT
    assert path.stops == (None,)
    assert path.critical == 0
    assert path.last is path.points[0]


def test_no_clock_has_a_say_unless_it_is_asked_to(
    soft: Equilibrium, traced: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On a machine that is as busy as can be every path is the same, to the last bit."""
    run_away(monkeypatch)
    path = follow(soft, [5.0, 12.0, FAR], beyond=3.5)
    assert (path.status, path.critical) == (traced.status, traced.critical)
    assert len(path.points) == len(traced.points)
    for one, other in zip(path.points, traced.points, strict=True):
        assert (one.load, one.volume) == (other.load, other.volume)
        np.testing.assert_array_equal(one.state.x, other.state.x)
    assert path.statistics.iterations == traced.statistics.iterations
    assert path.statistics.seconds > 1e4  # the clock did jump


def test_times_are_of_the_processor(soft: Equilibrium, monkeypatch: pytest.MonkeyPatch) -> None:
    """What passes on the wall while other programs have the processor is no cost of a path."""
    run_away(monkeypatch)
    monkeypatch.setattr(time, "process_time", lambda: 7.0)
    spent = follow(soft, [5.0]).statistics
    assert spent.iterations > 0
    times = (spent.seconds, spent.assembly_seconds, spent.factor_seconds, spent.solve_seconds)
    assert times == (0.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize("readings", range(2, 60, 3))
def test_a_clock_that_runs_out_anywhere_says_so(
    soft: Equilibrium, traced: Path, monkeypatch: pytest.MonkeyPatch, readings: int
) -> None:
    """Also behind the limit point, and while that is closed in: no answer depends on a clock."""
    monkeypatch.setattr(time, "perf_counter", Clock(readings))
    path = follow(soft, [5.0, 12.0, FAR], beyond=3.5, limits=Limits(seconds=1.0))
    whole = readings > traced.statistics.iterations
    assert path.status is (traced.status if whole else Status.TIME_OUT)
    assert path.statistics.iterations == min(readings - 1, traced.statistics.iterations)


def test_work_limit(soft: Equilibrium, traced: Path) -> None:
    """With every iteration that it takes a path is whole; with fewer it stops where it is."""
    needed = traced.statistics.iterations
    stops = [5.0, 12.0, FAR]
    assert follow(soft, stops, beyond=3.5, limits=Limits(needed)).status is traced.status
    path = follow(soft, stops, beyond=3.5, limits=Limits(5))
    assert path.status is Status.WORK_LIMIT
    assert path.statistics.iterations == 5
    assert path.last is not None
    assert path.critical == path.last.load > 0
    # the end of the stable part stands, wherever behind it the work is spent
    late = follow(soft, stops, beyond=3.5, limits=Limits(needed - 1))
    assert (late.status, late.critical) == (traced.status, traced.critical)


@pytest.mark.parametrize("factors", [0, 1, 4])
def test_linear_solver(soft: Equilibrium, factors: int) -> None:
    """At rest, where there is not even a slope; in the first step; later."""
    path = follow(soft, [5.0], solver=Failing(factors=factors))
    assert path.status is Status.LINEAR_SOLVER
    assert path.stops == (None,)
    assert (path.last is None) == (factors == 0)
    assert len(path.points) >= min(factors, 1)
    assert (len(path.points) > 1) == (factors > 1)


@pytest.mark.parametrize("solves", range(12))
def test_a_solution_that_fails_anywhere_ends_with_a_status(soft: Equilibrium, solves: int) -> None:
    path = follow(soft, [5.0], solver=Failing(solves=solves))
    assert path.status is Status.LINEAR_SOLVER


def test_step_too_small(soft: Equilibrium) -> None:
    """One iteration is never enough."""
    steps = PathSteps(newton=Newton(tolerance=1e-14, most_iterations=1), smallest=0.01)
    path = follow(soft, [5.0], steps=steps)
    assert path.status is Status.STEP_TOO_SMALL
    assert path.critical == 0
    assert len(path.points) == 1
    # 0.05, 0.025, 0.0125
    assert path.statistics.steps == path.statistics.iterations == 3


def test_too_many_points(soft: Equilibrium) -> None:
    path = follow(soft, [FAR], steps=PathSteps(most_points=4))
    assert path.status is Status.STEP_TOO_SMALL
    assert len(path.points) == 4
    assert path.last is path.points[-1]
    assert path.critical == path.last.load


def test_inverted(soft: Equilibrium) -> None:
    """A step so long that it turns elements inside out, and none shorter allowed."""
    steps = PathSteps(first=40.0, longest=40.0, smallest=30.0)
    path = follow(soft, [1e5], steps=steps)
    assert path.status is Status.INVERTED
    assert path.last is path.points[0]


def test_a_failure_past_the_limit_does_not_hide_it(soft: Equilibrium, traced: Path) -> None:
    """What was found stays: asked for more than can be followed, it ends as a limit point."""
    path = follow(soft, [FAR], steps=PathSteps(most_points=len(traced.points)), beyond=1e3)
    assert path.status is Status.LIMIT_POINT
    assert path.critical == pytest.approx(traced.critical, rel=1e-3)


# the cubic


@given(st.floats(1, 50), st.floats(5, 500), st.floats(0.1, 1.0), st.floats(0.2, 1.0))
def test_summit_of_a_cubic(top: float, at: float, before: float, after: float) -> None:
    """P = top − c (v − at)² − d (v − at)³ with its maximum at v = at, between the two points."""
    c = top / (2 * at**2)
    d = c / (8 * at)

    def point(v: float) -> PathPoint:
        x = v - at
        slope = -2 * c * x - 3 * d * x**2
        assume(slope != 0)
        return replace(NOWHERE, load=top - c * x**2 - d * x**3, volume=v, growth=1 / slope)

    here, there = point(at * (1 - before)), point(at * (1 + after))
    assert here.growth > 0 > there.growth
    assert summit(here, there)[0] == pytest.approx(top, rel=1e-9)


NOWHERE = PathPoint(State(np.zeros((0, 3)), np.zeros(3), np.eye(3)), 0.0, 0.0, 1.0, None)


def test_summit_of_a_cubic_that_only_rises_is_its_end() -> None:
    here, there = NOWHERE, replace(NOWHERE, load=7.0, volume=7.0)
    assert summit(here, there)[0] == pytest.approx(7.0, rel=1e-12)


def test_a_minimum_is_no_summit() -> None:
    """P = (v − 1)² from 0 to 3: falls first, and is highest at the end."""
    here = replace(NOWHERE, load=1.0, growth=-1 / 2)
    there = replace(NOWHERE, load=4.0, volume=3.0, growth=1 / 4)
    assert summit(here, there)[0] == pytest.approx(4.0, rel=1e-12)
