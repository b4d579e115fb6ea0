"""Newton's method and load steps: convergence, and every way in which they can end."""

import numpy as np
import pytest

from beamopt.base.arrays import FloatArray
from femcheck.assembly.reduction import UpperMatrix
from femcheck.continuation.direct import DirectSolver, SingularMatrixError, direct_solver
from femcheck.continuation.limits import Limits
from femcheck.continuation.load_steps import LoadSteps
from femcheck.continuation.newton import Newton
from femcheck.continuation.outcome import SolidOutcome, Status
from femcheck.continuation.shape import Shapes
from femcheck.material.rigid_section import RigidSection
from femcheck.solid.equilibrium import Equilibrium, actuator
from femcheck.solid.state import State, rest_state
from tests.femcheck.lattice import SOFT, bent_state, lattice_body

LAW = RigidSection(300.0, 1000.0)
LOAD = np.array([40.0, 0.0, 15.0])


@pytest.fixture(scope="module")
def problem() -> Equilibrium:
    return actuator(lattice_body("wedge18"), LAW)


class Watched:
    """A solver that notes how long the steps are, and fails when it is told to."""

    name = "watched"

    def __init__(self, fails: bool = False) -> None:
        self._solver: DirectSolver = direct_solver()
        self._fails = fails
        self.steps: list[float] = []
        self.factor_seconds = self.solve_seconds = 0.0

    def factor(self, matrix: UpperMatrix) -> None:
        if self._fails:
            raise SingularMatrixError("told to")
        self._solver.factor(matrix)

    def solve(self, right: FloatArray) -> FloatArray:
        step = self._solver.solve(right)
        self.steps.append(float(np.abs(step).max()))
        return step

    @property
    def negative_eigenvalues(self) -> int | None:
        return self._solver.negative_eigenvalues


def walk(
    problem: Equilibrium, pressures: FloatArray, settings: LoadSteps, **changes: object
) -> SolidOutcome:
    start = rest_state(problem.body), np.zeros(3)
    solver = changes.pop("solver", None) or direct_solver()
    limits = changes.pop("limits", None) or Limits()
    assert isinstance(limits, Limits)
    changes["budget"] = limits.begin()
    return settings.walk(problem, Shapes(problem.body), start, pressures, solver, **changes)


def test_convergence_is_quadratic(problem: Equilibrium) -> None:
    """The number of right digits doubles with every step."""
    solver = Watched()
    outcome = Newton(tolerance=1e-9).solve(problem, rest_state(problem.body), LOAD, solver)
    assert outcome.status is Status.CONVERGED
    assert outcome.state is not None
    large = [step for step in solver.steps if step > 1e-10]
    assert len(large) >= 4
    first, second, third = np.log(large[-3:])
    assert (third - second) / (second - first) > 1.7
    assert len(solver.steps) == outcome.statistics.iterations <= 10
    forces = problem.forces(outcome.state, LOAD)
    assert outcome.residual == np.abs(forces.reduced).max() < 1e-6
    assert outcome.reached == 1.0
    assert outcome.negative_eigenvalues in (0, None)


def test_the_default_tolerance_is_enough(problem: Equilibrium) -> None:
    """What the last, quadratic step leaves is far below the step itself."""
    rest, tips = rest_state(problem.body), []
    for settings in (Newton(), Newton(tolerance=1e-10)):
        outcome = settings.solve(problem, rest, LOAD, direct_solver())
        assert outcome.state is not None
        tips.append(outcome.state.tip)
    assert np.abs(tips[0] - tips[1]).max() < Newton().tolerance / 10


def test_nothing_to_do_is_converged(problem: Equilibrium) -> None:
    outcome = walk(problem, np.zeros(3), LoadSteps())
    assert outcome.status is Status.CONVERGED
    assert outcome.statistics.iterations == 1
    assert outcome.state is not None
    np.testing.assert_allclose(outcome.state.x, problem.body.nodes, atol=1e-12)


def test_from_far_away(problem: Equilibrium) -> None:
    """A bent start that is no equilibrium: the line search on the potential brings it home."""
    soft = problem.with_law(SOFT)
    start = bent_state(problem.body, (0.3, -0.4, 0.2), 0.01)
    ends = []
    for state in (start, rest_state(problem.body)):
        outcome = Newton(tolerance=1e-8).solve(soft, state, LOAD / 4, direct_solver())
        assert outcome.status is Status.CONVERGED
        assert outcome.state is not None
        ends.append(outcome.state.x)
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-7)


def test_inverted_start(problem: Equilibrium) -> None:
    rest = rest_state(problem.body)
    mirrored = State(rest.x * [1, 1, -1], rest.tip, rest.turn)
    outcome = Newton().solve(problem, mirrored, LOAD, direct_solver())
    assert outcome.status is Status.INVERTED
    assert outcome.state is None
    # as a guess it only costs a try: load steps start from the known equilibrium
    assert walk(problem, LOAD, LoadSteps(), guess=mirrored).status is Status.CONVERGED


def test_pressures_beyond_sense_end_with_a_status(problem: Equilibrium) -> None:
    """Steps shrink to nothing, or elements invert: a status and how far it came, no numbers."""
    soft = problem.with_law(RigidSection(300.0, 2.0, 1.0))
    settings = LoadSteps(smallest=1 / 8)
    outcome = walk(soft, np.array([3e3, -2e3, 4e3]), settings)
    assert outcome.status in (Status.STEP_TOO_SMALL, Status.INVERTED, Status.LINEAR_SOLVER)
    assert outcome.state is None
    assert 0 <= outcome.reached < 1
    assert outcome.statistics.steps >= 4


def test_step_too_small(problem: Equilibrium) -> None:
    """Two iterations are not enough for any step."""
    settings = LoadSteps(newton=Newton(tolerance=1e-14, most_iterations=2), smallest=1 / 4)
    outcome = walk(problem, LOAD, settings)
    assert outcome.status is Status.STEP_TOO_SMALL
    assert outcome.reached == 0
    # the first try, then steps of 1/2 and 1/4
    assert outcome.statistics.steps == 3
    assert outcome.statistics.iterations == 6


def test_load_steps_where_one_step_is_too_long(problem: Equilibrium) -> None:
    """Few iterations allowed: the load is divided, and the end is the same equilibrium."""
    few = LoadSteps(newton=Newton(tolerance=1e-3, most_iterations=3))
    stepped = walk(problem, LOAD, few)
    whole = walk(problem, LOAD, LoadSteps(newton=Newton(tolerance=1e-8)))
    assert stepped.statistics.steps > 2
    assert stepped.status is Status.CONVERGED
    assert stepped.reached == 1
    assert stepped.state is not None
    assert whole.state is not None
    assert whole.statistics.steps == 1
    np.testing.assert_allclose(stepped.state.x, whole.state.x, atol=1e-4)


def test_linear_solver(problem: Equilibrium) -> None:
    outcome = walk(problem, LOAD, LoadSteps(smallest=1 / 4), solver=Watched(fails=True))
    assert outcome.status is Status.LINEAR_SOLVER
    assert outcome.state is None


def test_a_start_that_is_not_finite_ends_with_a_status(problem: Equilibrium) -> None:
    rest = rest_state(problem.body)
    lost = State(np.full_like(rest.x, np.nan), rest.tip, rest.turn)
    for name in ("auto", "superlu"):
        outcome = Newton(most_iterations=3).solve(problem, lost, LOAD, direct_solver(name))
        assert outcome.status in (Status.INVERTED, Status.LINEAR_SOLVER)


def test_time_out(problem: Equilibrium) -> None:
    solver = direct_solver()
    rest = rest_state(problem.body)
    late = Limits(seconds=0.0)
    tried = Newton().solve(problem, rest, LOAD, solver, late.begin())
    assert tried.status is Status.TIME_OUT
    outcome = walk(problem, LOAD, LoadSteps(), limits=late)
    assert outcome.status is Status.TIME_OUT
    assert outcome.state is None
    assert outcome.statistics.steps == 2  # the try at once, and one step


def test_work_limit(problem: Equilibrium) -> None:
    """One iteration more than is needed is enough, one less is not; it is counted, not timed."""
    whole = walk(problem, LOAD, LoadSteps())
    needed = whole.statistics.iterations
    assert walk(problem, LOAD, LoadSteps(), limits=Limits(needed)).status is Status.CONVERGED
    outcome = walk(problem, LOAD, LoadSteps(), limits=Limits(needed - 1))
    assert outcome.status is Status.WORK_LIMIT
    assert outcome.state is None
    assert outcome.statistics.iterations == needed - 1


def test_a_failed_factorisation_is_work_too(problem: Equilibrium) -> None:
    outcome = walk(problem, LOAD, LoadSteps(), solver=Watched(fails=True), limits=Limits(3))
    assert outcome.status is Status.WORK_LIMIT
    assert outcome.statistics.iterations == 3


def test_every_status_has_a_text() -> None:
    assert all(status.value and status.value != status.name for status in Status)
