"""Gradient and Hessian of the elements against finite differences; their mesh."""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.rod.elements.energy import (
    ElementState,
    Mesh,
    assemble,
    measure,
    potential,
    pushes,
)
from beamopt.rod.elements.group import exponential
from beamopt.rod.elements.mesh import (
    at_rest,
    elements_by_segment,
    meshed,
    stiffness,
)
from beamopt.rod.elements.newton import workspace
from beamopt.rod.rod import Rod, Segment
from tests.beamopt.rod.elements.rods import (
    BENDS,
    general,
)

FACTOR = 0.7


def away_from_rest(mesh: Mesh, rod: Rod) -> ElementState:
    """Not in equilibrium, with the wrenches of its strains."""
    rng = np.random.default_rng(2)
    state = at_rest(rod, mesh)
    state = moved(state, 0.2 * rng.normal(size=(mesh.lengths.size + 1, 6)))
    measure(mesh, state)
    for e in range(mesh.lengths.size):
        pushes(mesh, e, state.phi[e], state.wrench[e])
    return state


def moved(state: ElementState, x: FloatArray) -> ElementState:
    """Frames times exp x; wrenches and φ as they were."""
    state = ElementState(*(part.copy() for part in state))
    R, h = np.empty((3, 3)), np.empty(3)
    for node in range(len(x)):
        exponential(x[node], R, h)
        state.h[node] += state.R[node] @ h
        state.R[node] = state.R[node] @ R
    return state


def gradient_of(mesh: Mesh, state: ElementState) -> FloatArray:
    gradient = np.empty((mesh.lengths.size + 1, 6))
    measure(mesh, state)
    assemble(mesh, state, FACTOR, gradient, workspace(len(gradient)))
    return gradient.ravel()


def matrix_of(mesh: Mesh, state: ElementState) -> FloatArray:
    """The derivative, assembled."""
    nodes = mesh.lengths.size + 1
    blocks = workspace(nodes)
    assemble(mesh, state, FACTOR, np.empty((nodes, 6)), blocks)
    matrix = np.zeros((nodes, 6, nodes, 6))
    for i in range(nodes):
        matrix[i, :, i] = blocks.diagonal[i]
    for i in range(nodes - 1):
        matrix[i + 1, :, i], matrix[i, :, i + 1] = blocks.below[i], blocks.above[i].T
    return matrix.reshape(6 * nodes, 6 * nodes)


def differences(mesh: Mesh, state: ElementState, step: float = 1e-5) -> FloatArray:
    """Central differences of the gradient along increments of the frames."""
    size = 6 * (mesh.lengths.size + 1)
    columns = []
    for unit in step * np.eye(size):
        ahead = gradient_of(mesh, moved(state, unit.reshape(-1, 6)))
        behind = gradient_of(mesh, moved(state, -unit.reshape(-1, 6)))
        columns.append((ahead - behind) / (2 * step))
    return np.array(columns).T


def test_gradient_is_that_of_the_energy() -> None:
    rod = general(conservative=True)
    mesh = meshed(rod, 4, 1e4)
    state = away_from_rest(mesh, rod)
    found = gradient_of(mesh, state)
    step = 1e-5
    expected = []
    for unit in step * np.eye(found.size):
        ahead = moved(state, unit.reshape(-1, 6))
        behind = moved(state, -unit.reshape(-1, 6))
        measure(mesh, ahead)
        measure(mesh, behind)
        energies = potential(mesh, ahead, FACTOR), potential(mesh, behind, FACTOR)
        expected.append((energies[0] - energies[1]) / (2 * step))
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-6 * np.abs(found).max())


def test_hessian_is_symmetric_and_the_gradients_derivative() -> None:
    """Increments do not commute: off equilibrium the derivative's symmetric part is the Hessian."""
    rod = general(conservative=True)
    mesh = meshed(rod, 4, 1e4)
    assert mesh.symmetric
    state = away_from_rest(mesh, rod)
    found, expected = matrix_of(mesh, state), differences(mesh, state)
    np.testing.assert_allclose(found, found.T, rtol=0, atol=1e-12 * np.abs(found).max())
    scale = np.abs(found).max()
    np.testing.assert_allclose(found, (expected + expected.T) / 2, rtol=0, atol=1e-6 * scale)


def test_tangent_of_all_loads_is_the_gradients_derivative() -> None:
    rod = general(conservative=False)
    mesh = meshed(rod, 4, 1e4)
    assert not mesh.symmetric
    state = away_from_rest(mesh, rod)
    found, expected = matrix_of(mesh, state), differences(mesh, state)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-6 * np.abs(found).max())


def test_stiffness_is_the_law_half_inverted_again() -> None:
    law = general(conservative=True).segments[0].law
    D = stiffness(law, 1e7, 1.0, 1.0)
    strain = np.array([0.3, -0.2, 0.5, 0.1, 0.4, -0.3])
    moment, force = np.split(D @ strain, 2)
    np.testing.assert_allclose(moment, law.bending @ strain[:3] + law.coupling @ force)
    np.testing.assert_allclose(strain[3:], law.compliance @ force - law.coupling.T @ strain[:3])


def test_elements_are_shared_by_length() -> None:
    rod = Rod(tuple(Segment(length, BENDS) for length in (1.0, 4.0, 2.0)))
    np.testing.assert_array_equal(elements_by_segment(rod, 7), [1, 4, 2])
    np.testing.assert_array_equal(elements_by_segment(rod, 1), [1, 1, 1])
