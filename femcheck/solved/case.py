"""One pressure combination of one solid: the unit of work that processes share."""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from femcheck.continuation.direct import DirectSolver, SingularMatrixError, direct_solver
from femcheck.continuation.limits import Budget, Limits
from femcheck.continuation.load_steps import LoadSteps
from femcheck.continuation.outcome import SolidOutcome, Statistics, Status
from femcheck.continuation.shape import Shapes
from femcheck.continuation.trace import PathSteps
from femcheck.material.fibre import Thread
from femcheck.material.law import Law
from femcheck.mesh.extrusion import Extrusion, extrude
from femcheck.mesh.section_mesh import SectionMesh
from femcheck.solid.body import Body, discretise, nodes_at
from femcheck.solid.elements import ELEMENTS
from femcheck.solid.equilibrium import Equilibrium, actuator
from femcheck.solid.state import State
from femcheck.solid.winding import Wound, wind

__all__ = [
    "Case",
    "CaseResult",
    "Solid",
    "Workshop",
    "forget_workshops",
    "rest_slopes",
    "solve_case",
    "stopped",
    "workshop",
]


class Shown(NamedTuple):
    """A mesh to look at, and the node of the solid at each of its corners."""

    extrusion: Extrusion
    nodes: IndexArray


@dataclass(frozen=True, eq=False)
class Solid:
    """What is discretised, and of which law it is.

    name : for files and tables.
    section : the triangulated section.
    heights : planes between layers [mm].
    element : name of the element.
    law : the material.
    solver : "auto", "pardiso" or "superlu".
    wound : which surfaces are wound with what thread; None where none is.
    """

    name: str
    section: SectionMesh
    heights: FloatArray
    element: str
    law: Law
    solver: str = "auto"
    wound: tuple[Wound, Thread] | None = None

    def body(self) -> Body:
        """Its discretisation."""
        return discretise(extrude(self.section, self.heights), self.element)

    def problem(self, body: Body) -> Equilibrium:
        """The equilibrium of its body, ready to be asked."""
        winding = wind(body, *self.wound) if self.wound else None
        return actuator(body, self.law, winding)

    def shown(self) -> Shown:
        """Its corners, and the middles of upright edges that are nodes, as a mesh to look at."""
        body = self.body()
        if ELEMENTS[self.element].wall_degree == 1:
            return Shown(body.extrusion, nodes_at(body, body.extrusion.points))
        middles = (self.heights[1:] + self.heights[:-1]) / 2
        finer = extrude(self.section, np.sort(np.concatenate([self.heights, middles])))
        return Shown(finer, nodes_at(body, finer.points))

    @cached_property
    def digest(self) -> str:
        """Tells discretisations apart; solids of the same mesh and other laws share it."""
        said = f"{self.element} {self.solver}" + (f" {self.wound}" if self.wound else "")
        state = hashlib.blake2b(said.encode(), digest_size=16)
        section = self.section
        for array in (section.points, section.triangles, section.edges, section.supply):
            state.update(np.ascontiguousarray(array).tobytes())
        state.update(self.heights.tobytes())
        return state.hexdigest()


@dataclass(frozen=True, eq=False)
class Case:
    """A pressure combination to be solved.

    guess : shape to try first; None starts from `start`.
    start : an equilibrium and its pressures; None is the unloaded body.
    limits : of load steps and path together.
    smallest : share of the load below which load steps are given up, and the path is followed.
    """

    solid: Solid
    pressures: FloatArray
    guess: FloatArray | None
    start: tuple[State, FloatArray] | None
    limits: Limits = field(default_factory=Limits)
    smallest: float = LoadSteps().smallest


@dataclass(frozen=True, eq=False)
class CaseResult:
    """How a case ended.

    shape : of the equilibrium, to predict others from; None unless converged.
    volumes : (3,) of the chambers [mm³]. strain_energy : ∫ W dV [mN mm].
    """

    outcome: SolidOutcome
    shape: FloatArray | None = None
    volumes: FloatArray | None = None
    strain_energy: float = float("nan")

    @property
    def status(self) -> Status:
        """How it ended."""
        return self.outcome.status

    def is_final(self, limits: Limits) -> bool:
        """True if it would end alike if it was solved again under these limits."""
        return not limits.repeats(self.status, self.outcome.statistics)


@dataclass(frozen=True, eq=False)
class Workshop:
    """What one process keeps of a solid between tasks."""

    problem: Equilibrium
    shapes: Shapes
    solver: DirectSolver


LOST = (Status.INVERTED, Status.STEP_TOO_SMALL, Status.LINEAR_SOLVER)
_WORKSHOPS: dict[str, Workshop] = {}
MOST_WORKSHOPS = 2  # factors are large; a check goes back and forth between two meshes at most


def workshop(solid: Solid) -> Workshop:
    """Built once a process and a mesh; laws of one mesh share the pattern and its analysis."""
    shop = _WORKSHOPS.get(solid.digest)
    if shop is None:
        while len(_WORKSHOPS) >= MOST_WORKSHOPS:
            _WORKSHOPS.pop(next(iter(_WORKSHOPS)))
        body = solid.body()
        shop = Workshop(solid.problem(body), Shapes(body), direct_solver(solid.solver))
        _WORKSHOPS[solid.digest] = shop
    return replace(shop, problem=shop.problem.with_law(solid.law))


def forget_workshops() -> None:
    """Have the next task of this process discretise anew, as if it were the first."""
    _WORKSHOPS.clear()


def solve_case(case: Case) -> CaseResult:
    """Find the equilibrium; whatever happens, a result with a status."""
    shop = workshop(case.solid)
    start = case.start or (shop.problem.rest(), np.zeros(3))
    guess = None if case.guess is None else shop.shapes.state(case.guess)
    steps, budget = LoadSteps(smallest=case.smallest), case.limits.begin()
    outcome = steps.walk(
        shop.problem, shop.shapes, start, case.pressures, shop.solver, guess, budget
    )
    left = _is_beyond_law(shop.problem, outcome)
    if (outcome.status in LOST or left) and case.pressures.any():
        outcome = _followed(shop, case, outcome, budget)
    if outcome.state is None:
        return CaseResult(outcome)
    return CaseResult(
        outcome,
        shop.shapes.of(outcome.state),
        shop.problem.volumes(outcome.state),
        shop.problem.strain_energy(outcome.state),
    )


def _is_beyond_law(problem: Equilibrium, found: SolidOutcome) -> bool:
    """Whether an equilibrium was found that is stretched beyond what the law describes."""
    most = problem.law.most_stretch
    if found.state is None or math.isinf(most):
        return False
    return problem.largest_stretch(found.state)[0] > most


def _followed(shop: Workshop, case: Case, failed: SolidOutcome, budget: Budget) -> SolidOutcome:
    """Where load steps found nothing, or what no law describes: the path from rest."""
    spent = failed.statistics
    load = float(np.abs(case.pressures).max())
    direction = case.pressures / load
    path = PathSteps().trace(
        shop.problem, shop.shapes, direction, [load], shop.solver, budget=budget
    )
    spent.add(path.statistics)
    spent.seconds += path.statistics.seconds
    found = path.stops[0]
    if found is not None:
        return SolidOutcome(Status.CONVERGED, found.state, 1.0, math.nan, found.unstable, spent)
    return SolidOutcome(path.status, None, path.critical / load, statistics=spent)


def rest_slopes(solid: Solid) -> FloatArray | None:
    """(3, m) change of the unloaded body's shape with each supply's pressure [1/kPa].

    None where the tangent at rest is singular.
    """
    shop = workshop(solid)
    problem, rest = shop.problem, shop.problem.rest()
    nothing = np.zeros(3)
    try:
        shop.solver.factor(problem.tangent(rest, nothing, problem.forces(rest, nothing)))
        steps = [shop.solver.solve(problem.volume_gradient(rest, one)) for one in np.eye(3)]
    except SingularMatrixError:
        return None
    undeformed = shop.shapes.of(rest)
    slopes = []
    for step in steps:
        small = 1e-4 / max(float(np.abs(step).max()), 1e-12)  # mm of the largest displacement
        near = problem.moved(rest, small * step)
        slopes.append((shop.shapes.of(near) - undeformed) / small)
    return np.stack(slopes)


def stopped() -> CaseResult:
    """The result of a case whose process ended under it."""
    return CaseResult(SolidOutcome(Status.STOPPED, None, statistics=Statistics()))
