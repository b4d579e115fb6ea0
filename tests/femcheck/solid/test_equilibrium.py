"""Potential, forces and tangent against each other, and against pressure integrated by hand."""

import numpy as np
import pytest

from beamopt.base.arrays import FloatArray
from femcheck.continuation.direct import direct_solver
from femcheck.continuation.newton import Newton
from femcheck.continuation.outcome import Status
from femcheck.material.rigid_section import RigidSection
from femcheck.mesh.extrusion import extrude
from femcheck.solid.body import Body, discretise, nodes_at
from femcheck.solid.elements import ELEMENTS
from femcheck.solid.equilibrium import Equilibrium, actuator
from femcheck.solid.plate import cross_matrix, rotation, symmetric_turn
from femcheck.solid.state import State, rest_state
from tests.femcheck.lattice import (
    SOFT,
    bent_state,
    lattice_body,
    lattice_extrusion,
    lattice_section,
    random_direction,
)

TURN = (0.5, -0.7, 0.3)
PRESSURES = np.array([30.0, -12.0, 55.0])


@pytest.fixture(params=list(ELEMENTS), scope="module")
def problem(request: pytest.FixtureRequest) -> Equilibrium:
    return actuator(lattice_body(request.param), SOFT)


@pytest.fixture(scope="module")
def wedges() -> Equilibrium:
    return actuator(lattice_body("wedge18"), SOFT)


def along(problem: Equilibrium, state: State, step: FloatArray, share: float) -> State:
    step = share * step
    return problem.moved(state, step)


def directions(problem: Equilibrium) -> list[FloatArray]:
    """Everything at once, each motion of the plate alone, and all free nodes alone."""
    size = problem.body.unknowns
    alone = [random_direction(size, 1), random_direction(size, 2), *np.eye(size)[-6:]]
    alone.append(np.concatenate([random_direction(size - 6, 3), np.zeros(6)]))
    return alone


def test_forces_are_the_derivative_of_the_potential(problem: Equilibrium) -> None:
    state, h = bent_state(problem.body, TURN, 0.02), 1e-5
    forces = problem.forces(state, PRESSURES).reduced
    for d in directions(problem):
        ends = [problem.potential(along(problem, state, d, s * h), PRESSURES) for s in (1, -1)]
        measured = (ends[0] - ends[1]) / (2 * h)
        scale = np.linalg.norm(forces) * np.linalg.norm(d)
        assert forces @ d == pytest.approx(measured, abs=1e-7 * scale)


def test_tangent_is_the_derivative_of_the_forces(problem: Equilibrium) -> None:
    """The turn's unknowns are increments exp(δθ) of the rotation there; a torque m seen from a
    state turned on by θ gets ½ θ × m besides the (symmetric) second derivative's part.
    """
    state, h = bent_state(problem.body, TURN, 0.02), 1e-6
    forces = problem.forces(state, PRESSURES)
    K = problem.tangent(state, PRESSURES, forces).whole()
    assert abs(K - K.T).max() == 0
    for d in directions(problem):
        ends = [problem.forces(along(problem, state, d, s * h), PRESSURES).reduced for s in (1, -1)]
        expected = K @ d
        expected[-3:] += np.cross(d[-3:], forces.reduced[-3:]) / 2
        measured = (ends[0] - ends[1]) / (2 * h)
        np.testing.assert_allclose(measured, expected, atol=1e-7 * np.abs(expected).max())


def test_tangent_is_the_second_derivative_of_the_potential(wedges: Equilibrium) -> None:
    state, h = bent_state(wedges.body, TURN, 0.02), 1e-3
    K = wedges.tangent(state, PRESSURES, wedges.forces(state, PRESSURES)).whole()
    middle = wedges.potential(state, PRESSURES)
    for d in (
        np.eye(wedges.body.unknowns)[-6:]
        + 0.3 * random_direction(6, 4) @ np.eye(wedges.body.unknowns)[-6:]
    ):
        ends = [wedges.potential(along(wedges, state, d, s * h), PRESSURES) for s in (1, -1)]
        assert d @ (K @ d) == pytest.approx((ends[0] - 2 * middle + ends[1]) / h**2, rel=1e-4)


def test_volumes_and_their_gradient(problem: Equilibrium) -> None:
    state, h = bent_state(problem.body, TURN, 0.02), 1e-4
    for supply in (1, 2, 3):
        slope = problem.volume_gradient(state, np.eye(3)[supply - 1])
        for d in directions(problem):
            ends = [problem.volumes(along(problem, state, d, s * h)) for s in (1, -1)]
            measured = (ends[0] - ends[1])[supply - 1] / (2 * h)
            assert slope @ d == pytest.approx(measured, abs=1e-6 * np.linalg.norm(slope))
    loads = sum(
        p * problem.volume_gradient(state, one) for one, p in zip(np.eye(3), PRESSURES, strict=True)
    )
    without = problem.forces(state, np.zeros(3)).reduced
    np.testing.assert_allclose(problem.forces(state, PRESSURES).reduced, without - loads, atol=1e-9)


def pressed(body: Body, x: FloatArray) -> FloatArray:
    """(n, 3) pressure integrated over the walls: Σ ∫ p φ_a n da, from the facets' functions."""
    facet, loads = body.facet, np.zeros_like(x)
    at = x[body.walls]
    s = np.einsum("ga,fac->fgc", facet.along, at)
    t = np.einsum("ga,fac->fgc", facet.across, at)
    into_chamber = np.cross(s, t)
    p = PRESSURES[body.wall_supply - 1]
    # gas pushes against the normal that points into the chamber
    f = -np.einsum("f,g,ga,fgc->fac", p, facet.weights, facet.values, into_chamber)
    np.add.at(loads, body.walls, f)
    return loads


def cap_centres(body: Body) -> FloatArray:
    """(3, 2) centroid of each supply's chambers in the undeformed section [mm]."""
    raw = body.extrusion.section.moments.raw
    return raw[1:, 1:3] / raw[1:, :1]


def test_a_closed_cavity_has_no_net_force_and_no_net_moment(problem: Equilibrium) -> None:
    """Walls, the tip's caps and the base's, each at its place, on a random deformed state."""
    body = problem.body
    state = bent_state(body, TURN, 0.02)
    loads = pressed(body, state.x)
    force, moment = loads.sum(axis=0), np.cross(state.x, loads).sum(axis=0)
    areas, centres = body.cap_areas, cap_centres(body)
    for p, area, (x, y) in zip(PRESSURES, areas, centres, strict=True):
        tip = state.tip + state.turn @ (np.array([x, y, body.extrusion.length]) - body.tip_centre)
        for place, thrust in (
            (tip, p * area * state.turn[:, 2]),
            (np.array([x, y, 0.0]), p * area * np.array([0, 0, -1.0])),
        ):
            force, moment = force + thrust, moment + np.cross(place, thrust)
    scale = float(np.abs(PRESSURES) @ areas)
    np.testing.assert_allclose(force, 0, atol=1e-12 * scale)
    np.testing.assert_allclose(moment, 0, atol=1e-12 * scale * body.extrusion.length)


def test_the_potential_s_pressure_is_that_on_walls_and_caps(problem: Equilibrium) -> None:
    """Free nodes get the pressure on their walls, the plate what presses on its rim and caps."""
    body = problem.body
    state = bent_state(body, TURN, 0.02)
    nothing = problem.forces(state, np.zeros(3)).reduced
    found = nothing - problem.forces(state, PRESSURES).reduced
    loads = pressed(body, state.x)
    scale = float(np.abs(PRESSURES) @ body.cap_areas)
    np.testing.assert_allclose(found[:-6], loads[problem.support.free].ravel(), atol=1e-11 * scale)
    on_tip = loads[body.tip]
    force = on_tip.sum(axis=0)
    moment = np.cross(state.x[body.tip] - state.tip, on_tip).sum(axis=0)
    for p, area, (x, y) in zip(PRESSURES, body.cap_areas, cap_centres(body), strict=True):
        thrust = p * area * state.turn[:, 2]
        arm = state.turn @ (np.array([x, y, body.extrusion.length]) - body.tip_centre)
        force, moment = force + thrust, moment + np.cross(arm, thrust)
    np.testing.assert_allclose(found[-6:-3], force, atol=1e-11 * scale)
    np.testing.assert_allclose(found[-3:], moment, atol=1e-11 * scale * body.extrusion.length)


def test_the_potential_does_not_see_rigid_motions(problem: Equilibrium) -> None:
    """Any rotation about a point of the base's plane, and shifts along it, of everything.

    The base's cap is left out of the volume: it has to stay in a plane through the origin.
    """
    body = problem.body
    state = bent_state(body, TURN, 0.02)
    before = problem.potential(state, PRESSURES)
    energy, volumes = problem.strain_energy(state), problem.volumes(state)
    Q, shift = rotation(np.array([1.1, 0.4, -2.0])), np.array([7.0, -4.0, 0.0])
    after = State((state.x + shift) @ Q.T, Q @ (state.tip + shift), Q @ state.turn)
    assert problem.strain_energy(after) == pytest.approx(energy, rel=1e-11)
    np.testing.assert_allclose(problem.volumes(after), volumes, rtol=1e-11)
    assert problem.potential(after, PRESSURES) == pytest.approx(before, rel=1e-11)
    one, two = problem.forces(state, PRESSURES), problem.forces(after, PRESSURES)
    inner = problem.support.free
    np.testing.assert_allclose(
        two.nodal[inner], one.nodal[inner] @ Q.T, atol=1e-11 * np.abs(one.nodal).max()
    )


def solved(problem: Equilibrium, pressures: FloatArray, start: State) -> State:
    tight = Newton(tolerance=1e-7)
    outcome = tight.solve(problem, start, pressures, direct_solver("superlu"))
    assert outcome.status is Status.CONVERGED
    assert outcome.state is not None
    return outcome.state


def test_work_of_pressure_is_the_change_of_strain_energy(wedges: Equilibrium) -> None:
    """Σ ½ (p + p') · (V' − V) over a path converges to the energy as the square of the steps."""
    end, errors = np.array([30.0, 0.0, 12.0]), []
    for steps in (2, 4):
        at, state = np.zeros(3), rest_state(wedges.body)
        volumes, work = wedges.volumes(state), 0.0
        for share in np.arange(1, steps + 1) / steps:
            # not a straight line in the pressures: energy does not depend on the path
            to = end * np.array([share, share, share**2])
            state = solved(wedges, to, state)
            now = wedges.volumes(state)
            work += float((at + to) @ (now - volumes)) / 2
            at, volumes = to, now
        errors.append(abs(work / wedges.strain_energy(state) - 1))
    assert errors[0] < 0.02
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.1)


def test_load_and_unload_return_to_zero(wedges: Equilibrium) -> None:
    rest = rest_state(wedges.body)
    loaded = solved(wedges, np.array([25.0, 0.0, 10.0]), rest)
    assert np.linalg.norm(loaded.tip - rest.tip) > 0.1
    back = solved(wedges, np.zeros(3), loaded)
    np.testing.assert_allclose(back.x, rest.x, atol=1e-9)
    np.testing.assert_allclose(back.turn, np.eye(3), atol=1e-9)
    assert wedges.strain_energy(back) < 1e-12


def test_an_inverted_element_has_infinite_energy(wedges: Equilibrium) -> None:
    rest = rest_state(wedges.body)
    mirrored = State(rest.x * [1, 1, -1], rest.tip, rest.turn)
    assert wedges.strain_energy(mirrored) == np.inf
    forces = wedges.forces(mirrored, PRESSURES)
    assert forces.least_volume_ratio == pytest.approx(-1)
    assert np.isnan(forces.reduced).all()


def test_another_law_on_the_same_body(wedges: Equilibrium) -> None:
    other = wedges.with_law(RigidSection(600.0, 20.0))
    state = bent_state(wedges.body, TURN, 0.02)
    assert other.strain_energy(state) == pytest.approx(2 * wedges.strain_energy(state))
    assert wedges.law is SOFT


@pytest.mark.parametrize("element", ["wedge18", "tet4"])
def test_a_body_without_chambers(element: str) -> None:
    """Pressure does nothing to it."""
    full = extrude(lattice_section(chambers={}), np.array([0.0, 5, 12]))
    problem = actuator(discretise(full, element), SOFT)
    rest = rest_state(problem.body)
    assert problem.volumes(rest).tolist() == [0, 0, 0]
    forces = problem.forces(rest, PRESSURES)
    np.testing.assert_allclose(forces.reduced, 0, atol=1e-9)
    np.linalg.cholesky(problem.tangent(rest, PRESSURES, forces).whole().toarray())


def test_unknown_element_and_places() -> None:
    with pytest.raises(ValueError, match="element = hex8: one of wedge18"):
        discretise(lattice_extrusion(), "hex8")
    body = lattice_body("tet4")
    assert nodes_at(body, body.nodes[[3, 1]]).tolist() == [3, 1]
    with pytest.raises(ValueError, match="no node within"):
        nodes_at(body, body.nodes[:1] + 1e-3)


def test_plate_rotations() -> None:
    from scipy.spatial.transform import Rotation

    rng = np.random.default_rng(4)
    for size in (0.0, 1e-9, 1e-4, 1.0, 3.1):
        vector = rng.normal(size=3)
        vector *= size / np.linalg.norm(vector)
        expected = Rotation.from_rotvec(vector).as_matrix()
        np.testing.assert_allclose(rotation(vector), expected, atol=1e-15)
    a, b = rng.normal(size=(2, 4, 3))
    np.testing.assert_allclose(np.einsum("kij,kj->ki", cross_matrix(a), b), np.cross(a, b))
    turn = rng.normal(size=3)
    H = symmetric_turn(a, b)
    second = np.cross(turn, np.cross(turn, b))
    assert turn @ H @ turn == pytest.approx((a * second).sum())
    np.testing.assert_array_equal(H, H.T)
