"""Windings: which facets, how they stretch, and what their tension does."""

from dataclasses import replace

import numpy as np
import pytest

from beamopt.base.arrays import FloatArray
from femcheck.assembly.pattern import make_pattern
from femcheck.assembly.reduction import UpperMatrix
from femcheck.continuation.direct import direct_solver
from femcheck.continuation.newton import Newton
from femcheck.continuation.outcome import Status
from femcheck.material.fibre import Thread
from femcheck.material.neo_hookean import NeoHookean
from femcheck.solid.body import Body
from femcheck.solid.elements import ELEMENTS
from femcheck.solid.equilibrium import actuator
from femcheck.solid.plate import rotation
from femcheck.solid.state import State
from femcheck.solid.winding import Winding, Wound, wind
from tests.femcheck.lattice import LENGTH, bent_state, lattice_body, random_direction
from tests.femcheck.solid.tubes import tube

THREAD = Thread(500.0, 0.05)
"""A toe so long that strains of a deformed lattice are slack, within it and beyond it."""
TURN = (0.5, -0.7, 0.3)
EVERY = [(element, where) for element in ELEMENTS for where in Wound]


@pytest.fixture(params=EVERY, ids=lambda pair: f"{pair[0]}-{pair[1].value}", scope="module")
def wound(request: pytest.FixtureRequest) -> tuple[Body, Winding, Wound]:
    element, where = request.param
    body = lattice_body(element)
    return body, wind(body, where, THREAD), where


def chosen_edges(body: Body, where: Wound) -> FloatArray:
    """(k,) lengths of the section's edges that are wound [mm]; outside are those on the hull."""
    section = body.extrusion.section
    lengths = np.linalg.norm(np.diff(section.points[section.edges], axis=1)[:, 0], axis=1)
    of_chambers = section.supply > 0
    return {
        Wound.CHAMBERS: lengths[of_chambers],
        Wound.OUTER: lengths[~of_chambers],
        Wound.BOTH: lengths,
    }[where]


def test_wound_surfaces_are_the_contours_times_the_length(
    wound: tuple[Body, Winding, Wound],
) -> None:
    body, winding, where = wound
    area = chosen_edges(body, where).sum() * LENGTH
    assert winding.areas.sum() == pytest.approx(area, rel=1e-12)
    assert winding.areas.min() > 0
    on_wall = set(body.walls.ravel())
    found = set(winding.facets.ravel())
    if where is Wound.CHAMBERS:
        assert found == on_wall
    if where is Wound.OUTER:
        assert not found & on_wall
    if where is Wound.BOTH:
        assert found > on_wall


@pytest.mark.parametrize("shift", [0.0, 0.6])
def test_a_hole_that_is_no_chamber_is_not_wound(shift: float) -> None:
    """A tube's bore without a supply lies on the free surface, but not outside."""
    body = tube(3.0, 5.0, 10.0, 12, 1, shift=shift)
    extrusion = body.extrusion
    bare = replace(body, extrusion=replace(extrusion, supply=np.zeros_like(extrusion.supply)))
    outer = 2 * 5.0 * np.sin(np.pi / 12) * 12 * 10.0
    assert wind(bare, Wound.OUTER, THREAD).areas.sum() == pytest.approx(outer, rel=1e-12)
    assert wind(bare, Wound.BOTH, THREAD).areas.sum() == pytest.approx(outer, rel=1e-12)
    assert wind(bare, Wound.CHAMBERS, THREAD).areas.sum() == 0


def test_undeformed_fibres_are_level_unit_vectors_along_the_contour(
    wound: tuple[Body, Winding, Wound],
) -> None:
    body, winding, _ = wound
    vectors = winding.vectors(body.nodes)
    np.testing.assert_allclose(np.linalg.norm(vectors, axis=2), 1, atol=1e-12)
    np.testing.assert_allclose(vectors[..., 2], 0, atol=1e-12)
    # in the facet's plane: across the direction in which its nodes have no extent
    at = body.nodes[winding.facets]
    normal = np.linalg.svd(at - at.mean(axis=1, keepdims=True))[2][:, 2]
    np.testing.assert_allclose(np.einsum("fgx,fx->fg", vectors, normal), 0, atol=1e-9)
    assert winding.energy(body.nodes) < 1e-20


def test_stretch_of_uniform_motions(wound: tuple[Body, Winding, Wound]) -> None:
    """In the plane by 1.1: 1.1 everywhere; along the axis, or rigid, or sheared by it: none."""
    body, winding, _ = wound
    X, Q = body.nodes, rotation(np.array([0.9, -1.4, 0.6]))
    np.testing.assert_allclose(winding.strains(X * [1.1, 1.1, 1.0]), 0.1, atol=1e-12)
    sheared = X + np.outer(X[:, 2], [0.3, -0.2, 0.0])
    for still in (X * [1.0, 1.0, 1.3], X * [1.0, 1.0, 0.7], X @ Q.T + 5.0, sheared):
        np.testing.assert_allclose(winding.strains(still), 0, atol=1e-12)


def test_energy_of_a_uniform_stretch(wound: tuple[Body, Winding, Wound]) -> None:
    """ψ(0.1) times the surface."""
    body, winding, where = wound
    area = chosen_edges(body, where).sum() * LENGTH
    expected = area * float(THREAD.energy(np.array([0.1]))[0])
    found = winding.energy(body.nodes * [1.1, 1.1, 1.0])
    assert found == pytest.approx(expected, rel=1e-11)


def test_slack_in_compression_gives_no_force(wound: tuple[Body, Winding, Wound]) -> None:
    body, winding, _ = wound
    x, forces = body.nodes * [0.9, 0.95, 1.2], np.zeros_like(body.nodes)
    winding.add_forces(x, forces)
    assert winding.energy(x) == 0
    assert not forces.any()


def test_forces_are_the_derivative_of_the_energy(wound: tuple[Body, Winding, Wound]) -> None:
    body, winding, _ = wound
    x, h = bent_state(body, TURN, 0.05).x, 1e-6
    strains = winding.strains(x)
    assert strains.min() < -0.01
    assert strains.max() > THREAD.toe
    forces = np.zeros_like(x)
    winding.add_forces(x, forces)
    for seed in (1, 2):
        d = random_direction(x.size, seed).reshape(x.shape)
        slope = (winding.energy(x + h * d) - winding.energy(x - h * d)) / (2 * h)
        assert (forces * d).sum() == pytest.approx(slope, abs=1e-8 * np.abs(forces * d).sum())


def test_stiffness_is_the_derivative_of_the_forces(wound: tuple[Body, Winding, Wound]) -> None:
    """All nodes but those of the base free; the law's slope has a kink at the toe's ends."""
    body, winding, _ = wound
    x, h = bent_state(body, TURN, 0.05).x, 1e-7
    free = np.setdiff1d(np.arange(len(x)), body.base)
    blocks = np.full(len(x), -1)
    blocks[free] = np.arange(free.size)
    pattern = make_pattern(body.connectivity, blocks)
    data = np.zeros(pattern.indices.size)
    winding.add_stiffness(x, pattern, data)
    K = UpperMatrix(pattern.starts, pattern.indices, data).whole()
    d = np.zeros_like(x)
    d[free] = random_direction(3 * free.size, 3).reshape(-1, 3)
    ends = np.zeros((2, *x.shape))
    for sign, out in zip((1, -1), ends, strict=True):
        winding.add_forces(x + sign * h * d, out)
    measured = ((ends[0] - ends[1]) / (2 * h))[free].ravel()
    expected = K @ d[free].ravel()
    np.testing.assert_allclose(measured, expected, atol=1e-5 * np.abs(expected).max())


def test_no_net_force_and_no_net_moment(wound: tuple[Body, Winding, Wound]) -> None:
    body, winding, _ = wound
    x = bent_state(body, TURN, 0.05).x
    forces = np.zeros_like(x)
    winding.add_forces(x, forces)
    scale = float(np.abs(forces).sum())
    np.testing.assert_allclose(forces.sum(axis=0), 0, atol=1e-13 * scale)
    np.testing.assert_allclose(np.cross(x, forces).sum(axis=0), 0, atol=1e-13 * scale * LENGTH)


@pytest.mark.parametrize("element", list(ELEMENTS))
def test_the_equilibrium_has_the_winding_s_energy_forces_and_stiffness(element: str) -> None:
    """A wound problem less a bare one; along a direction that moves the plate too."""
    body = lattice_body(element, 1)
    law, pressures = NeoHookean(300.0, 0.4), np.array([30.0, -12.0, 55.0])
    bare = actuator(body, law)
    problem = actuator(body, law, wind(body, Wound.BOTH, THREAD))
    state = bent_state(body, TURN, 0.02)
    assert problem.winding is not None
    more = problem.potential(state, pressures) - bare.potential(state, pressures)
    assert more == pytest.approx(problem.winding.energy(state.x), rel=1e-9)
    d, h = random_direction(body.unknowns, 1), 1e-6

    def moved(share: float) -> State:
        return problem.moved(state, share * d)

    forces = problem.forces(state, pressures)
    slope = (problem.potential(moved(h), pressures) - problem.potential(moved(-h), pressures)) / (
        2 * h
    )
    assert forces.reduced @ d == pytest.approx(slope, rel=1e-6)
    K = problem.tangent(state, pressures, forces).whole()
    ends = [problem.forces(moved(s * h), pressures).reduced for s in (1, -1)]
    expected = K @ d
    expected[-3:] += np.cross(d[-3:], forces.reduced[-3:]) / 2
    atol = 1e-5 * np.abs(expected).max()  # a point may pass the toe's end
    np.testing.assert_allclose((ends[0] - ends[1]) / (2 * h), expected, atol=atol)


def test_a_wound_tube_keeps_its_girth_and_grows_longer() -> None:
    """A bare tube widens and hardly grows; wound on both sides it grows longer instead.

    Its girth grows by no more than the toe and what the hoop force P r [mN/mm] stretches.
    """
    body, pressures = tube(4.0, 5.0, 40.0, 12, 4), np.array([8.0, 0.0, 0.0])
    law, widened, longer = NeoHookean(300.0), [], []
    for winding in (None, wind(body, Wound.BOTH, Thread(1e4, 4e-3))):
        problem = actuator(body, law, winding)
        outcome = Newton().solve(problem, problem.rest(), pressures, direct_solver())
        assert outcome.status is Status.CONVERGED
        assert outcome.state is not None
        girth = wind(body, Wound.OUTER, THREAD).strains(outcome.state.x)
        widened.append(float(girth.max()))
        longer.append(float(outcome.state.tip[2] / 40.0 - 1))
    assert widened[0] > 10 * abs(widened[1])
    assert widened[1] < 4e-3 + 8.0 * 5.0 / 1e4  # the toe, and what the hoop force P r stretches
    assert longer[1] > 0.01
