"""Where an equilibrium is lost, and whether that is a crease."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from femcheck.assembly.reduction import UpperMatrix
from femcheck.continuation.direct import direct_solver
from femcheck.continuation.mode import LOCAL, unstable_mode
from femcheck.continuation.outcome import Status
from femcheck.continuation.shape import Shapes
from femcheck.continuation.trace import PathSteps
from femcheck.material.neo_hookean import NeoHookean
from femcheck.material.rigid_section import RigidSection
from femcheck.mesh.extrusion import extrude, stations
from femcheck.mesh.section_mesh import SectionMesh
from femcheck.prediction.ray_trace import RayResult
from femcheck.solid.body import Body, discretise
from femcheck.solid.equilibrium import Equilibrium, actuator
from tests.femcheck.inertia import needs_inertia
from tests.femcheck.solid.tubes import tube, tube_section

E = 300.0
SUCK = np.array([-1.0, 0.0, 0.0])


def blistered(place: float, wall: float) -> Body:
    """A thick tube whose wall is thin over one chord in twelve, at an angle `place` [rad]."""
    section = tube_section(3.0, 5.0, 24, across=2)
    angle = np.arctan2(section.points[:, 1], section.points[:, 0])
    radius = np.hypot(*section.points.T)
    near = np.cos(angle - place) > np.cos(2.2 * 2 * np.pi / 24)
    pulled = np.where(near & (radius < 4.9), 5.0 - wall * (5.0 - radius) / 2.0, radius)
    points = section.points * (pulled / radius)[:, None]
    moved = SectionMesh(points, section.triangles, section.edges, section.supply)
    return discretise(extrude(moved, stations(20.0, 2)), "wedge18")


@needs_inertia
@pytest.mark.parametrize("place", [0.0, 7 * np.pi / 6])
def test_a_thin_spot_of_the_wall_is_found(place: float) -> None:
    """0.25 mm of 2 mm thick: what goes is there, wherever it is turned, and halfway up."""
    problem = actuator(blistered(place, 0.25), NeoHookean(E))
    solver = direct_solver()
    steps = PathSteps()
    path = steps.trace(problem, Shapes(problem.body), -SUCK, [400.0], solver)
    assert path.status in (Status.LIMIT_POINT, Status.BUCKLED)
    past = next(point for point in path.points if point.unstable)
    mode = unstable_mode(problem, past.state, past.load * -SUCK, solver)
    assert mode is not None
    x, y, z = mode.place
    off = np.angle(np.exp(1j * (np.arctan2(y, x) - place)))
    assert abs(off) < 2.5 * 2 * np.pi / 24
    assert 5 < z < 15
    assert mode.share < 0.5  # with five planes of nodes nothing is very local


@needs_inertia
def test_a_tube_that_collapses_is_no_crease() -> None:
    """Two waves around all of it: halfway up, and shared by a large part of the nodes."""
    problem = actuator(tube(4.6, 5.4, 100.0, 16, 4), NeoHookean(E))
    path = PathSteps().trace(problem, Shapes(problem.body), SUCK, [10.0], direct_solver())
    assert path.status is Status.BUCKLED
    assert path.mode is not None
    assert path.mode.share > 2 * LOCAL
    assert 25 < path.mode.place[2] < 75


class Softened:
    """An equilibrium whose tangent is negative for motions of one node."""

    def __init__(self, problem: Equilibrium, node: int) -> None:
        self._problem, self._node = problem, node

    def __getattr__(self, name: str) -> Any:
        return getattr(self._problem, name)

    def tangent(self, *arguments: Any) -> UpperMatrix:
        matrix, problem, rest = self._problem.tangent(*arguments), self._problem, self.rest()
        data = matrix.data.copy()
        for unknown, step in enumerate(1e-3 * np.eye(problem.unknowns)):
            moved = np.abs(problem.moved(rest, step).x - rest.x).max(axis=1) > 1e-9
            if moved[self._node] and moved.sum() == 1:
                data[matrix.starts[unknown]] *= -1  # columns ascend from the diagonal on
        return replace(matrix, data=data)


@pytest.mark.parametrize("number", [0, 5])
def test_one_soft_node_is_found(number: int) -> None:
    """Whoever solves: the motion is that node's and its neighbours', a twentieth of all nodes."""
    problem = actuator(tube(3.0, 5.0, 10.0, 8, 2), RigidSection(E, 100.0))
    body = problem.body
    node = int(np.setdiff1d(body.walls.ravel(), [*body.base, *body.tip])[number])
    softened: Any = Softened(problem, node)
    mode = unstable_mode(softened, problem.rest(), np.zeros(3), direct_solver())
    assert mode is not None
    np.testing.assert_array_equal(mode.place, body.nodes[node])
    assert 1 / len(body.nodes) <= mode.share < 0.1


def test_a_small_part_is_local() -> None:
    nothing = np.empty((0, 8))
    for share, local in ((LOCAL / 2, True), (2 * LOCAL, False), (np.nan, False)):
        found = RayResult(Status.BUCKLED, 5.0, (None,), None, nothing, mode_share=share)
        assert found.is_local is local


def test_a_stable_equilibrium_has_no_unstable_mode() -> None:
    problem = actuator(tube(3.0, 5.0, 10.0, 8, 2), NeoHookean(E))
    assert unstable_mode(problem, problem.rest(), np.zeros(3), direct_solver()) is None
