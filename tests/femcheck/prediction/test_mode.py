"""Where an equilibrium is lost, and whether that is a crease."""

from dataclasses import replace

import numpy as np
import pytest

from beamopt.arrays import FloatArray
from femcheck.continuation.direct import Pardiso, direct_solver
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
from femcheck.solid.equilibrium import actuator
from tests.femcheck.solid.tubes import tube, tube_section

E = 300.0
SUCK = np.array([-1.0, 0.0, 0.0])


def counts() -> bool:
    try:
        Pardiso()
    except ImportError:
        return False
    return True


needs_inertia = pytest.mark.skipif(not counts(), reason="PARDISO is not installed")


def blistered(place: float, wall: float) -> Body:
    """A thick tube whose wall is thin over one chord in twelve, at an angle `place` [rad]."""
    section = tube_section(3.0, 5.0, 24, across=2)
    angle = np.arctan2(section.points[:, 1], section.points[:, 0])
    radius = np.hypot(*section.points.T)
    near = np.cos(angle - place) > np.cos(2.2 * 2 * np.pi / 24)
    pulled = np.where(near & (radius < 4.9), 5.0 - wall * (5.0 - radius) / 2.0, radius)
    points = section.points * (pulled / radius)[:, None]
    moved = SectionMesh(points, section.triangles, section.edges, section.supply)
    return discretise(extrude(moved, stations(20.0, 4)), "wedge18")


@needs_inertia
@pytest.mark.parametrize("place", [0.0, np.pi / 2, 7 * np.pi / 6])
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
    assert mode.share < 0.2


@needs_inertia
def test_a_tube_that_collapses_is_no_crease() -> None:
    """Two waves around all of it: halfway up, and shared by a large part of the nodes."""
    problem = actuator(tube(4.6, 5.4, 100.0, 16, 4), NeoHookean(E))
    path = PathSteps().trace(problem, Shapes(problem.body), SUCK, [10.0], direct_solver())
    assert path.status is Status.BUCKLED
    assert path.mode is not None
    assert path.mode.share > 2 * LOCAL
    assert 25 < path.mode.place[2] < 75


@needs_inertia
def test_a_motion_of_one_node_has_a_share_of_one_over_their_number() -> None:
    """A node held by a spring that pushes: nothing else moves, so the mode is known."""
    problem = actuator(tube(3.0, 5.0, 10.0, 8, 1), RigidSection(E, 100.0))
    node = int(np.setdiff1d(problem.body.walls.ravel(), [*problem.body.base, *problem.body.tip])[0])
    softened = _Softened(problem, node)
    solver = direct_solver()
    mode = unstable_mode(softened, problem.rest(), np.zeros(3), solver)  # type: ignore[arg-type]
    assert mode is not None
    np.testing.assert_array_equal(mode.place, problem.body.nodes[node])
    assert mode.share < 1 / 20


class _Softened:
    """A problem of which the tangent is nearly zero, and less, at one node's place."""

    def __init__(self, problem: object, node: int) -> None:
        self._problem, self._node = problem, node

    def __getattr__(self, name: str) -> object:
        return getattr(self._problem, name)

    def tangent(self, *arguments: object) -> object:
        matrix = self._problem.tangent(*arguments)  # type: ignore[attr-defined]
        free = _unknowns_of(self._problem, self._node)
        data = matrix.data.copy()
        rows = np.repeat(np.arange(matrix.starts.size - 1), np.diff(matrix.starts))
        for unknown in free:
            at = (rows == unknown) & (matrix.columns == unknown)
            data[at] *= -0.05
        return replace(matrix, data=data)


def _unknowns_of(problem: object, node: int) -> FloatArray:
    rest = problem.rest()  # type: ignore[attr-defined]
    found = []
    for unknown in range(problem.support.unknowns):  # type: ignore[attr-defined]
        step = np.zeros(problem.unknowns)  # type: ignore[attr-defined]
        step[unknown] = 1e-3
        moved = problem.moved(rest, step).x - rest.x  # type: ignore[attr-defined]
        if moved[node].any() and np.count_nonzero(moved.any(axis=1)) == 1:
            found.append(unknown)
    return np.array(found)


def test_only_what_buckles_creases() -> None:
    nothing = np.empty((0, 8))
    for status, share, creases in (
        (Status.BUCKLED, LOCAL / 2, True),
        (Status.BUCKLED, 2 * LOCAL, False),
        (Status.BUCKLED, np.nan, False),
        (Status.LIMIT_POINT, LOCAL / 2, False),
    ):
        result = RayResult(
            status, 5.0, (None,), None, nothing, mode_at=np.zeros(3), mode_share=share
        )
        assert result.creases is creases


def test_a_stable_equilibrium_has_no_unstable_mode() -> None:
    problem = actuator(tube(3.0, 5.0, 10.0, 8, 2), NeoHookean(E))
    assert unstable_mode(problem, problem.rest(), np.zeros(3), direct_solver()) is None
