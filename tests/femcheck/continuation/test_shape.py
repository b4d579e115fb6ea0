"""States taken apart into strains and warping, and put together again."""

from dataclasses import replace

import numpy as np
import pytest

from femcheck.continuation.shape import Shapes
from femcheck.solid.body import Body
from femcheck.solid.elements import ELEMENTS
from femcheck.solid.plate import rotation
from femcheck.solid.state import State, placed, rest_state
from tests.femcheck.lattice import LENGTH, bent_state, lattice_body, random_direction


@pytest.fixture(scope="module")
def body() -> Body:
    return lattice_body("wedge18", layers=3, distortion=0.0)


@pytest.mark.parametrize("element", list(ELEMENTS))
def test_there_and_back(element: str) -> None:
    """Planes of nodes that are not flat, or have one node, too."""
    body = lattice_body(element)
    shapes = Shapes(body)
    for turn, noise in (((0.0, 0.0, 0.0), 0.0), ((0.5, -0.7, 0.3), 0.05), ((0, 2.5, 0), 0.02)):
        state = bent_state(body, turn, noise)
        back = shapes.state(shapes.of(state))
        np.testing.assert_allclose(back.x, state.x, atol=1e-10)
        np.testing.assert_allclose(back.tip, state.tip, atol=1e-10)
        np.testing.assert_allclose(back.turn, state.turn, atol=1e-10)


@pytest.mark.parametrize("element", ["wedge18", "hex27", "tet10"])
def test_hydrostatic_pressures_are_carried_as_they_are(element: str) -> None:
    """There and back without rounding, and combined linearly with everything else."""
    body = lattice_body(element)
    shapes, pressures = Shapes(body), random_direction(body.corner_nodes.size, 4)
    bent = replace(bent_state(body, (0.5, -0.7, 0.3), 0.05), hydrostatic=pressures)
    without = replace(bent, hydrostatic=np.zeros(0))
    back = shapes.state(shapes.of(bent))
    np.testing.assert_array_equal(back.hydrostatic, pressures)
    np.testing.assert_array_equal(back.x, shapes.state(shapes.of(without)).x)
    assert shapes.of(bent).size == shapes.of(without).size + pressures.size
    rest = replace(rest_state(body), hydrostatic=np.ones(pressures.size))
    twice = shapes.state(2 * shapes.of(bent) - shapes.of(rest))
    np.testing.assert_array_equal(twice.hydrostatic, 2 * pressures - 1)


def test_nothing_at_rest(body: Body) -> None:
    np.testing.assert_allclose(Shapes(body).of(rest_state(body)), 0, atol=1e-12)


def test_rigid_planes_do_not_warp(body: Body) -> None:
    shape = Shapes(body).of(arc(body, 0.9, 0.05))
    planes = np.unique(np.round(body.nodes[:, 2], 6)).size
    np.testing.assert_allclose(shape[6 * (planes - 1) :], 0, atol=1e-12)
    assert shape[: 6 * (planes - 1)].any()


def arc(body: Body, angle: float, stretch: float) -> State:
    """Every plane rigid, on a circle through the reference axis by `angle` [rad]."""
    centre = np.append(body.tip_centre[:2], 0)
    kappa = angle / LENGTH
    grown = 1 + stretch

    def at(z: float) -> tuple[np.ndarray, np.ndarray]:
        turn = rotation(np.array([0, kappa * z, 0]))
        if angle == 0:
            return turn, centre + np.array([0, 0, grown * z])
        t = kappa * z
        return turn, centre + grown / kappa * np.array([1 - np.cos(t), 0, np.sin(t)])

    x = np.empty_like(body.nodes)
    for node, place in enumerate(body.nodes):
        R, h = at(place[2])
        x[node] = h + R @ ([*place[:2], 0] - centre)
    R, h = at(LENGTH)
    return placed(body, x, h, R)


def test_a_linear_combination_of_strains_is_an_arc(body: Body) -> None:
    """Twice the strains of an arc: an arc of twice the angle.

    Chords between planes shorten by the square of the angle, which does not add up; positions
    that are extrapolated are ten times farther off.
    """
    shapes = Shapes(body)
    half, whole = arc(body, 0.6, 0.02), arc(body, 1.2, 0.04)
    rest = rest_state(body)
    found = shapes.state(2 * shapes.of(half) - shapes.of(rest))
    straight = 2 * half.tip - rest.tip
    off = np.linalg.norm(found.tip - whole.tip)
    assert off < 0.01 * np.linalg.norm(whole.tip - rest.tip)
    assert off < 0.1 * np.linalg.norm(straight - whole.tip)
    np.testing.assert_allclose(found.turn, whole.turn, atol=1e-12)


def test_whatever_is_added_keeps_the_base_and_the_plate() -> None:
    body = lattice_body("wedge18")
    shapes = Shapes(body)
    state = shapes.state(
        np.random.default_rng(1).uniform(-0.01, 0.01, shapes.of(rest_state(body)).size)
    )
    np.testing.assert_array_equal(state.x[body.base], body.nodes[body.base])
    arms = body.nodes[body.tip] - body.tip_centre
    np.testing.assert_allclose(state.x[body.tip], state.tip + arms @ state.turn.T, atol=1e-12)
    np.testing.assert_allclose(state.turn @ state.turn.T, np.eye(3), atol=1e-12)
