"""Patch tests: what every element must do exactly, on distorted elements."""

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from femcheck.solid.body import Body
from femcheck.solid.elements import ELEMENTS
from femcheck.solid.equilibrium import actuator
from femcheck.solid.plate import rotation
from femcheck.solid.state import State, rest_state
from tests.femcheck.lattice import SOFT, inner_nodes, lattice_body

A = np.array([[1.02, 0.03, 0.01], [-0.01, 0.97, 0.04], [0.05, -0.02, 1.06]])
NOTHING = np.zeros(3)
STIFF = SOFT.penalty * SOFT.youngs_modulus


@pytest.fixture(params=list(ELEMENTS), scope="module")
def body(request: pytest.FixtureRequest) -> Body:
    return lattice_body(request.param, layers=2)


def test_the_mesh_is_distorted_and_whole(body: Body) -> None:
    section = body.extrusion.section
    volume = section.moments.area * body.extrusion.length
    assert body.weights.sum() == pytest.approx(volume, rel=1e-12)
    sizes = body.weights.sum(axis=1)
    assert sizes.min() > 0
    assert sizes.max() > 1.5 * sizes.min()


def test_affine_motion_gives_uniform_stress_and_no_inner_forces(body: Body) -> None:
    problem = actuator(body, SOFT)
    state = State(body.nodes @ A.T, A @ body.tip_centre, np.eye(3))
    forces = problem.forces(state, NOTHING)
    C = A.T @ A
    expected = SOFT.stress(np.array([[C[0, 0], C[1, 1], C[2, 2], C[0, 1], C[1, 2], C[0, 2]]]))[0]
    assert np.abs(expected).max() > 100
    assert np.abs(forces.S - expected).max() < 1e-12 * STIFF
    inner = inner_nodes(body)
    assert inner.size >= 4
    assert np.abs(forces.nodal).max() > 1  # what nodes of the boundary carry [mN]
    assert np.abs(forces.nodal[inner]).max() < 1e-12 * STIFF


def test_inner_nodes_find_the_affine_motion(body: Body) -> None:
    """Boundary nodes moved affinely, inner ones anywhere: Newton brings them to the affine place.

    This is the tangent's patch test too.
    """
    problem = actuator(body, SOFT)
    inner = inner_nodes(body)
    exact = body.nodes @ A.T
    x = exact.copy()
    x[inner] += np.random.default_rng(3).uniform(-0.01, 0.01, (inner.size, 3))
    row = np.full(len(body.nodes), -1)
    row[problem.support.free] = np.arange(problem.support.free.size)
    rows = (3 * row[inner][:, None] + np.arange(3)).ravel()
    assert (row[inner] >= 0).all()
    for _ in range(6):
        state = State(x, A @ body.tip_centre, np.eye(3))
        forces = problem.forces(state, NOTHING)
        K = problem.tangent(state, NOTHING, forces).whole().tocsc()[rows][:, rows]
        x = x.copy()
        x[inner] -= spsolve(K, forces.nodal[inner].ravel()).reshape(-1, 3)
    np.testing.assert_allclose(x, exact, atol=1e-12 * body.extrusion.length)


def test_a_rigid_motion_gives_no_stress_and_no_energy(body: Body) -> None:
    problem = actuator(body, SOFT)
    Q = rotation(np.array([0.9, -1.4, 0.6]))
    state = State(body.nodes @ Q.T + [3.0, -8.0, 5.0], Q @ body.tip_centre + [3.0, -8.0, 5.0], Q)
    forces = problem.forces(state, NOTHING)
    assert np.abs(forces.S).max() < 1e-12 * STIFF
    assert forces.least_volume_ratio == pytest.approx(1, abs=1e-12)
    assert problem.strain_energy(state) < 1e-24 * STIFF * body.weights.sum()
    area = body.extrusion.section.moments.area
    assert np.abs(forces.reduced).max() < 1e-12 * STIFF * area


def test_rest(body: Body) -> None:
    problem = actuator(body, SOFT)
    rest = rest_state(body)
    assert problem.strain_energy(rest) < 1e-20
    areas = body.extrusion.section.moments.chamber_areas
    assert (areas > 0.5).all()
    np.testing.assert_allclose(problem.volumes(rest), areas * body.extrusion.length, rtol=1e-12)
