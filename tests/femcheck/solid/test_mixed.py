"""The mixed form: potential, forces and tangent against each other, and what incompressible means.

Π(x, p) = ∫ W(C) + p ln J − p²/(2Λ) dV − Σ P_i V_i(x), p at the corners of the elements.
"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import triu

from beamopt.base.arrays import FloatArray
from femcheck.assembly.reduction import UpperMatrix
from femcheck.continuation.direct import Pardiso, direct_solver
from femcheck.continuation.newton import Newton
from femcheck.continuation.outcome import Status
from femcheck.material.law import Law
from femcheck.material.mooney_rivlin import MooneyRivlin
from femcheck.material.neo_hookean import NeoHookean
from femcheck.mesh.extrusion import extrude, stations
from femcheck.solid.body import Body, discretise
from femcheck.solid.elements import ELEMENTS
from femcheck.solid.equilibrium import Equilibrium, actuator
from femcheck.solid.plate import rotation
from femcheck.solid.state import State
from tests.femcheck.inertia import needs_inertia
from tests.femcheck.lattice import (
    LENGTH,
    bent_state,
    inner_nodes,
    lattice_body,
    lattice_extrusion,
    lattice_section,
    random_direction,
)
from tests.femcheck.solid.tubes import tube

LAYERS = {"wedge18": 2, "hex27": 1, "tet10": 2}  # hexahedra are six times as many
PAIRS = [name for name, choice in ELEMENTS.items() if choice.has_pair]
LAWS = {
    "incompressible": NeoHookean(300.0, 0.5),
    "nearly incompressible": NeoHookean(300.0, 0.4999),
    "mooney-rivlin": MooneyRivlin(300.0, 0.5, C2_share=0.3),
}
MU = 100.0
TURN = (0.5, -0.7, 0.3)
PRESSURES = np.array([30.0, -12.0, 55.0])
LOAD = np.array([25.0, 0.0, 10.0])


@pytest.fixture(params=PAIRS, scope="module")
def body(request: pytest.FixtureRequest) -> Body:
    return lattice_body(request.param, LAYERS[request.param])


@pytest.fixture(params=list(LAWS), scope="module")
def law(request: pytest.FixtureRequest) -> Law:
    return LAWS[request.param]


@pytest.fixture(scope="module")
def problem(body: Body, law: Law) -> Equilibrium:
    return actuator(body, law)


def anywhere(problem: Equilibrium) -> State:
    """A bent state with random hydrostatic pressures: no equilibrium."""
    state = bent_state(problem.body, TURN, 0.02)
    return replace(state, hydrostatic=80 * random_direction(problem.hydrostatic_unknowns, 7))


def directions(problem: Equilibrium) -> list[FloatArray]:
    """Everything at once; then the hydrostatic pressures, the free nodes, the plate alone."""
    pressures, plate = problem.hydrostatic_unknowns, problem.support.unknowns - 6
    everything = random_direction(problem.unknowns, 1)
    everything[-pressures:] *= MU  # as large a part of the work as that of the nodes
    alone = [everything, *np.zeros((3, problem.unknowns))]
    alone[1][-pressures:] = MU * random_direction(pressures, 2)
    alone[2][:plate] = random_direction(plate, 3)
    alone[3][plate : plate + 6] = random_direction(6, 4)
    return alone


def test_unknowns_are_those_of_the_nodes_then_one_a_corner(problem: Equilibrium) -> None:
    corners = problem.body.connectivity[:, : problem.body.corner_values.shape[1]]
    assert problem.hydrostatic_unknowns == len(set(corners.ravel()))
    assert problem.unknowns == problem.body.unknowns + problem.hydrostatic_unknowns
    rest = problem.rest()
    assert rest.hydrostatic.shape == (problem.hydrostatic_unknowns,)
    assert not rest.hydrostatic.any()


def test_hydrostatic_pressure_is_linear_between_the_corners(body: Body) -> None:
    """A field that is linear in space, given at the corners, is met at the quadrature points.

    Elements have straight edges: their corners' functions carry positions and it alike.
    """
    problem = actuator(body, LAWS["incompressible"])
    slope = np.array([3.0, -2.0, 5.0])
    assert problem.mixed is not None
    found = problem.mixed.at_points(body.nodes[body.corner_nodes] @ slope)
    np.testing.assert_allclose(found, body.places @ slope, atol=1e-11)


def test_forces_are_the_derivative_of_the_potential(problem: Equilibrium) -> None:
    """Central differences of Π, whose error is h² times its third derivative."""
    state, h = anywhere(problem), 1e-5
    forces = problem.forces(state, PRESSURES).reduced
    for d in directions(problem):
        ends = [problem.potential(problem.moved(state, s * h * d), PRESSURES) for s in (1, -1)]
        measured = (ends[0] - ends[1]) / (2 * h)
        scale = float(np.abs(forces) @ np.abs(d))
        assert forces @ d == pytest.approx(measured, abs=1e-7 * scale)


def test_tangent_is_the_derivative_of_the_forces(problem: Equilibrium) -> None:
    """But for ½ θ × m in the plate's three moments, as in the displacement form.

    Forces [mN] and volume gaps [mm³] are compared each with their own largest change.
    """
    state, h = anywhere(problem), 1e-6
    forces = problem.forces(state, PRESSURES)
    K = problem.tangent(state, PRESSURES, forces).whole()
    assert abs(K - K.T).max() == 0
    plate = problem.support.unknowns
    for d in directions(problem):
        ends = [problem.forces(problem.moved(state, s * h * d), PRESSURES) for s in (1, -1)]
        measured = (ends[0].reduced - ends[1].reduced) / (2 * h)
        expected = K @ d
        turn, moment = slice(plate - 3, plate), forces.reduced[plate - 3 : plate]
        expected[turn] += np.cross(d[turn], moment) / 2
        for part in (slice(plate), slice(plate, None)):
            scale = np.abs(expected[part]).max()
            np.testing.assert_allclose(measured[part], expected[part], atol=2e-7 * scale + 1e-9)


def test_the_tangent_s_block_of_pressures_is_minus_the_compliance(problem: Equilibrium) -> None:
    """−∫ N Nᵀ/Λ dV: its sum is −volume/Λ; it stands in the pattern even where it is zero."""
    state = anywhere(problem)
    K = problem.tangent(state, PRESSURES, problem.forces(state, PRESSURES))
    rows = K.starts[problem.support.unknowns : -1]
    np.testing.assert_array_equal(K.indices[rows], np.arange(problem.support.unknowns, K.size))
    block = K.whole()[problem.support.unknowns :, problem.support.unknowns :]
    compliance = problem.law.volumetric_compliance
    expected = -compliance * problem.body.weights.sum()
    assert block.sum() == pytest.approx(expected, rel=1e-12, abs=0)


@needs_inertia
def test_inertia_at_rest_is_the_number_of_hydrostatic_pressures(problem: Equilibrium) -> None:
    solver = Pardiso()
    rest, nothing = problem.rest(), np.zeros(3)
    solver.factor(problem.tangent(rest, nothing, problem.forces(rest, nothing)))
    assert solver.negative_eigenvalues == problem.hydrostatic_unknowns


@pytest.mark.parametrize("element", ["wedge18", "tet10"])
def test_the_pair_is_stable(element: str) -> None:
    """Every hydrostatic pressure is felt: the least eigenvalue of Bᵀ K⁻¹ B against ∫ N Nᵀ/μ dV.

    Measured: 0.257 (wedge18) and 0.114 (tet10) on two layers, rising to 0.273 and 0.132 on three. A
    pair that is not stable has zeros, or values that fall with the size of the elements.
    """
    law, least = LAWS["incompressible"], []
    for layers in (2, 3):
        problem = actuator(lattice_body(element, layers), law)
        rest, nothing = problem.rest(), np.zeros(3)
        K = problem.tangent(rest, nothing, problem.forces(rest, nothing)).whole().toarray()
        own = problem.support.unknowns
        felt = K[:own, own:].T @ np.linalg.solve(K[:own, :own], K[:own, own:])
        nearly = problem.with_law(NeoHookean(300.0, 0.4999))
        compliance = nearly.law.volumetric_compliance
        forces = nearly.forces(rest, nothing)
        mass = -nearly.tangent(rest, nothing, forces).whole().toarray()[own:, own:]
        L = np.linalg.inv(np.linalg.cholesky(mass / compliance / law.shear_modulus))
        least.append(np.linalg.eigvalsh(L @ felt @ L.T)[0])
    assert min(least) > 0.1
    assert least[1] > least[0]


@pytest.mark.parametrize("law", list(LAWS.values()), ids=list(LAWS))
def test_the_linear_tetrahedron_is_refused(law: Law) -> None:
    with pytest.raises(ValueError, match="element: has no stable pair"):
        actuator(lattice_body("tet4"), law)
    compressible = actuator(lattice_body("tet4"), NeoHookean(300.0, 0.4))
    with pytest.raises(ValueError, match="element: has no stable pair"):
        compressible.with_law(law)


def test_a_rigid_motion_gives_no_forces(problem: Equilibrium) -> None:
    """No stress without hydrostatic pressure; with it, stress p everywhere, as in a fluid."""
    body = problem.body
    Q, shift = rotation(np.array([0.9, -1.4, 0.6])), np.array([3.0, -8.0, 5.0])
    zero = np.zeros(problem.hydrostatic_unknowns)
    state = State(body.nodes @ Q.T + shift, Q @ body.tip_centre + shift, Q, zero)
    forces = problem.forces(state, np.zeros(3))
    assert np.abs(forces.S).max() < 1e-11 * MU
    assert np.abs(forces.reduced).max() < 1e-11 * MU * body.extrusion.section.moments.area
    assert abs(problem.strain_energy(state)) < 1e-11 * MU * body.weights.sum()
    p = problem.forces(replace(state, hydrostatic=zero + 7.0), np.zeros(3)).S
    np.testing.assert_allclose(p[..., :3], 7.0, atol=1e-11 * MU)
    np.testing.assert_allclose(p[..., 3:], 0.0, atol=1e-11 * MU)


def test_stress_has_no_net_force_and_no_net_moment(problem: Equilibrium) -> None:
    """Whatever the hydrostatic pressures, on a deformed body whose ends are let go."""
    state = anywhere(problem)
    nodal = problem.forces(state, np.zeros(3)).nodal
    scale = float(np.abs(nodal).sum())
    np.testing.assert_allclose(nodal.sum(axis=0), 0, atol=1e-14 * scale)
    moment = np.cross(state.x, nodal).sum(axis=0)
    np.testing.assert_allclose(moment, 0, atol=1e-14 * scale * LENGTH)


def test_chamber_pressure_works_as_in_the_displacement_form(body: Body) -> None:
    """On nodes and plate; walls and caps of closed cavities balance there. No part in ln J."""
    problem = actuator(body, LAWS["incompressible"])
    plain = problem.with_law(NeoHookean(300.0, 0.4))
    state = anywhere(problem)
    loads = [
        each.forces(state, PRESSURES).reduced - each.forces(state, np.zeros(3)).reduced
        for each in (problem, plain)
    ]
    own = problem.support.unknowns
    np.testing.assert_allclose(loads[0][:own], loads[1], atol=1e-13 * MU * LENGTH**2)
    np.testing.assert_array_equal(loads[0][own:], 0)


def solved(problem: Equilibrium, pressures: FloatArray) -> State:
    tight = Newton(tolerance=1e-8)
    outcome = tight.solve(problem, problem.rest(), pressures, direct_solver())
    assert outcome.status is Status.CONVERGED
    assert outcome.state is not None
    assert outcome.negative_eigenvalues in (0, None)
    return outcome.state


@pytest.mark.parametrize("element", PAIRS)
def test_incompressible_material_keeps_its_volume(element: str) -> None:
    """∫ N ln J dV = 0 for the linear function N of every corner [mm³], to the solver's rounding.

    In each point ln J is not zero. By hand, from F and the corners' functions.
    """
    problem = actuator(lattice_body(element, LAYERS[element]), LAWS["incompressible"])
    body = problem.body
    state = solved(problem, LOAD)
    assert np.abs(state.x - body.nodes).max() > 0.1
    F, _, _ = problem.deformation(state)
    log_J = np.log(np.linalg.det(F))
    gaps = np.zeros(len(body.nodes))
    corners = body.connectivity[:, : body.corner_values.shape[1]]
    np.add.at(gaps, corners, np.einsum("eq,eq,qc->ec", body.weights, log_J, body.corner_values))
    assert np.abs(gaps).max() < 1e-8
    assert np.abs(log_J).max() > 1e-4
    assert abs(float((body.weights * log_J).sum())) < 1e-8


def test_nearly_incompressible_material_tends_to_incompressible() -> None:
    """The mixed form's tip moves by O(1 − 2ν): a tenth of the gap, a tenth of the way."""
    problem = actuator(lattice_body("wedge18"), LAWS["incompressible"])
    exact = solved(problem, LOAD).tip
    off = [
        np.linalg.norm(solved(problem.with_law(NeoHookean(300.0, nu)), LOAD).tip - exact)
        for nu in (0.499, 0.4999)
    ]
    assert off[0] / off[1] == pytest.approx(10, rel=0.01)


@pytest.mark.parametrize(
    ("element", "measured"),
    [("wedge18", (0.145, 0.057)), ("hex27", (0.146, 0.059)), ("tet10", (0.157, 0.074))],
)
def test_both_forms_tend_to_the_same_equilibrium(
    element: str, measured: tuple[float, float]
) -> None:
    """ν = 0.45, mixed and displacement form, on an eccentric tube of few elements and of more.

    Distance of the tips over the tip's way: as measured, to a tenth of that. It is that large
    because the tip's linear response is proportional to 1 − 2ν, a tenth: the mesh's error in
    volume comes in tenfold.
    """
    off = []
    for around, layers in ((8, 2), (12, 3)):
        body = tube(3.0, 5.0, 15.0, around, layers, element, shift=0.5)
        problem = actuator(body, NeoHookean(300.0, 0.45, mixed=False))
        mixed = problem.with_law(NeoHookean(300.0, 0.45, mixed=True))
        tips = [solved(each, np.array([20.0, 0.0, 0.0])).tip for each in (problem, mixed)]
        way = np.linalg.norm(tips[0] - body.tip_centre)
        off.append(float(np.linalg.norm(tips[1] - tips[0]) / way))
    np.testing.assert_allclose(off, measured, rtol=0.1)


def block(element: str, layers: int = 2) -> Equilibrium:
    """A block of distorted elements without chambers."""
    section = lattice_section(chambers={})
    whole = extrude(section, stations(LENGTH, layers, 1.3))
    moved = replace(whole, points=whole.points.copy())
    inner = (whole.points[:, 2] > 0) & (whole.points[:, 2] < LENGTH)
    side = np.zeros(len(section.points), dtype=bool)
    side[section.edges] = True
    free = inner & ~np.tile(side, layers + 1)
    step = np.random.default_rng(6).uniform(-0.15, 0.15, whole.points.shape)
    moved.points[free] += step[free]
    return actuator(discretise(moved, element), LAWS["incompressible"])


STRETCH = 1.2
UNIAXIAL = np.diag([STRETCH**-0.5, STRETCH**-0.5, STRETCH])
"""Isochoric; S11 = μ (1 − 1/C11) + p/C11 is zero at p = μ (1 − C11) = μ (1 − 1/λ)."""


@pytest.mark.parametrize("element", PAIRS)
def test_isochoric_stretch_leaves_nothing_on_the_inside_and_the_sides(element: str) -> None:
    """Affine nodes and one pressure: forces only where the ends are held, and no volume gap."""
    problem = block(element, LAYERS[element])
    body = problem.body
    p = np.full(problem.hydrostatic_unknowns, MU * (1 - 1 / STRETCH))
    state = State(body.nodes @ UNIAXIAL, UNIAXIAL @ body.tip_centre, np.eye(3), p)
    forces = problem.forces(state, np.zeros(3))
    axial = MU * (1 - STRETCH**-2) + p[0] * STRETCH**-2
    expected = np.array([0, 0, axial, 0, 0, 0])
    np.testing.assert_allclose(forces.S, np.broadcast_to(expected, forces.S.shape), atol=1e-10)
    assert np.abs(forces.nodal[problem.support.free]).max() < 1e-10
    assert np.abs(forces.nodal[body.tip]).max() > 1
    assert np.abs(forces.reduced[problem.support.unknowns :]).max() < 1e-10


@pytest.mark.parametrize("element", PAIRS)
def test_the_isochoric_stretch_is_found(element: str) -> None:
    """Ends moved affinely; nodes between them and pressures start elsewhere and arrive to 1e-10.

    This is the patch test of the tangent too.
    """
    problem = block(element, LAYERS[element])
    body, free = problem.body, problem.support.free
    exact, p = body.nodes @ UNIAXIAL, MU * (1 - 1 / STRETCH)
    count, own = 3 * free.size, problem.support.unknowns
    rows = np.concatenate([np.arange(count), np.arange(own, problem.unknowns)])
    x = exact.copy()
    x[free] += np.random.default_rng(3).uniform(-0.01, 0.01, (free.size, 3))
    pressures = 20 * random_direction(problem.hydrostatic_unknowns, 5)
    solver = direct_solver("superlu")  # a row of nothing but zeros on the diagonal is left out
    for _ in range(7):
        state = State(x, UNIAXIAL @ body.tip_centre, np.eye(3), pressures)
        forces = problem.forces(state, np.zeros(3))
        K = triu(problem.tangent(state, np.zeros(3), forces).whole()[rows][:, rows], format="csr")
        K.sort_indices()
        solver.factor(UpperMatrix(K.indptr.astype(np.int64), K.indices.astype(np.int64), K.data))
        step = solver.solve(forces.reduced[rows])
        x, pressures = x.copy(), pressures - step[count:]
        x[free] -= step[:count].reshape(-1, 3)
    np.testing.assert_allclose(x, exact, atol=1e-10)
    np.testing.assert_allclose(pressures, p, atol=1e-10 * MU)


def test_any_isochoric_affine_motion_leaves_nothing_on_the_inside(body: Body) -> None:
    """A lattice with its chambers: nodes inside get no force whatever the one pressure is."""
    problem = actuator(body, LAWS["mooney-rivlin"])
    A = np.array([[1.02, 0.03, 0.01], [-0.01, 0.97, 0.04], [0.05, -0.02, 1.06]])
    A /= np.linalg.det(A) ** (1 / 3)
    p = np.full(problem.hydrostatic_unknowns, 37.0)
    state = State(body.nodes @ A.T, A @ body.tip_centre, np.eye(3), p)
    forces = problem.forces(state, np.zeros(3))
    inner = inner_nodes(body)
    assert inner.size >= 4
    assert np.abs(forces.nodal[inner]).max() < 1e-10
    assert np.abs(forces.reduced[problem.support.unknowns :]).max() < 1e-10


def test_one_pattern_for_all_states(body: Body) -> None:
    """Direct solvers analyse once: the tangent's pattern is that of rest, at any state and law."""
    problem = actuator(body, LAWS["incompressible"])
    first = problem.tangent(
        problem.rest(), np.zeros(3), problem.forces(problem.rest(), np.zeros(3))
    )
    other = problem.with_law(LAWS["nearly incompressible"])
    state = anywhere(other)
    second = other.tangent(state, PRESSURES, other.forces(state, PRESSURES))
    np.testing.assert_array_equal(first.starts, second.starts)
    np.testing.assert_array_equal(first.indices, second.indices)
    for row in np.split(second.indices, second.starts[1:-1]):
        assert (np.diff(row) > 0).all()


def test_strain_energy_is_that_of_the_displacement_form_where_the_mix_is_met() -> None:
    """P = Λ ln J uniform: p ln J − p²/(2Λ) is Λ/2 (ln J)²."""
    whole = NeoHookean(300.0, 0.45, mixed=False)
    body = discretise(lattice_extrusion(), "wedge18")
    A = np.array([[1.05, 0.03, 0.01], [-0.01, 0.97, 0.04], [0.05, -0.02, 1.06]])
    problem = actuator(body, whole)
    mixed = problem.with_law(NeoHookean(300.0, 0.45, mixed=True))
    p = whole.volumetric_modulus * np.log(np.linalg.det(A))
    state = State(body.nodes @ A.T, A @ body.tip_centre, np.eye(3))
    met = replace(state, hydrostatic=np.full(mixed.hydrostatic_unknowns, p))
    assert mixed.strain_energy(met) == pytest.approx(problem.strain_energy(state), rel=1e-12)
    np.testing.assert_allclose(
        mixed.forces(met, PRESSURES).nodal, problem.forces(state, PRESSURES).nodal, atol=1e-9
    )
