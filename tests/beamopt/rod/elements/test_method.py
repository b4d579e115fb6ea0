"""Two-node elements against closed forms, published rods and shooting."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import root
from scipy.spatial.transform import Rotation

from beamopt.base.arrays import FloatArray
from beamopt.rod.arc import arc_tips
from beamopt.rod.elements.method import Elements
from beamopt.rod.law import SectionLaw, cross
from beamopt.rod.rod import STRAIGHT, Base, LineLoad, PointLoad, Rod, Segment, Tip
from beamopt.rod.solution import Method
from beamopt.rod.status import RodStatus
from tests.beamopt.rod.elements.rods import (
    BENDS,
    METHOD,
    PLANE,
    RIGID,
    SPACE,
    cantilever,
    general,
    solved,
    tip,
)


def order(coarse: FloatArray, middle: FloatArray, fine: FloatArray) -> float:
    return float(np.log2(np.linalg.norm(middle - coarse) / np.linalg.norm(fine - middle)))


def test_it_is_a_method() -> None:
    method: Method = METHOD
    assert method.name == "elements"


def test_an_endless_stiffness_is_not_representable() -> None:
    """No case has a tip; the axis has its two ends, as other methods answer."""
    law = replace(BENDS, bending=np.diag([np.inf, 1.0, 1.0]))
    found = METHOD.solve(Rod((Segment(2.0, law),)), np.zeros((3, 1, 6)), 4)
    assert found.status == (RodStatus.NOT_REPRESENTABLE,) * 3
    assert np.isnan(found.tips).all()
    assert (found.factor == 0).all()
    assert found.stations.tolist() == [0.0, 2.0]
    assert found.centrelines.shape == (3, 2, 3)


@pytest.mark.parametrize("angle", [0.0, 0.5, 3.0, 5.0])
def test_pressure_alone_is_one_element(angle: float) -> None:
    strains = np.array([0.13, angle * 0.8, angle * 0.6])
    rest = np.array([angle * 0.8, angle * 0.6, 0, 0, 0, 1.13])
    rod = Rod((Segment(1.0, BENDS),))
    found = METHOD.solve(rod, rest[None, None], 1)
    np.testing.assert_allclose(found.tips[0], arc_tips(strains, 1.0), rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    ("load", "side", "shortening", "angle"),
    [(1.0, 0.30172, 0.05643, 0.46135), (10.0, 0.81061, 0.55500, 1.43029)],
)
def test_cantilever(load: float, side: float, shortening: float, angle: float) -> None:
    """Elastica with PL²/EI = 1 and 10: w/L, u/L, θ to five digits (Bisshopp & Drucker 1945).

    The penalty of 1e8 stretches it by 1e-7 at most.
    """
    coarse, middle, fine = (solved(cantilever(load), n) for n in (16, 32, 64))
    assert order(coarse.tips[0], middle.tips[0], fine.tips[0]) == pytest.approx(2, abs=0.02)
    limit = (4 * fine.tips[0] - middle.tips[0]) / 3
    np.testing.assert_allclose(limit, [side, 0, 1 - shortening], rtol=0, atol=1.2e-5)
    angles = [np.arctan2(one.rotations[0, 0, 2], one.rotations[0, 2, 2]) for one in (middle, fine)]
    assert (4 * angles[1] - angles[0]) / 3 == pytest.approx(angle, abs=1.2e-5)


def test_error_is_estimated_with_half_the_elements() -> None:
    estimate = solved(cantilever(10.0), 32, Elements(estimates=True))
    best = (4 * tip(cantilever(10.0), 128) - tip(cantilever(10.0), 64)) / 3
    assert estimate.error[0] == pytest.approx(np.linalg.norm(estimate.tips[0] - best), rel=0.02)
    assert np.isnan(solved(cantilever(10.0), 32).error[0])


@pytest.mark.parametrize("law", [PLANE, BENDS, SPACE], ids=["plane", "bends", "space"])
def test_roll_up(law: SectionLaw) -> None:
    """A tip moment 2π EI/L makes a full circle, with any number of elements."""
    moment = PointLoad(moment=np.array([2 * np.pi, 0, 0]))
    rod = Rod((Segment(1.0, law, end=moment),))
    np.testing.assert_allclose(tip(rod, 5), np.zeros(3), atol=1e-9)


@pytest.mark.parametrize(
    ("load", "expected"),
    [(300.0, (58.778897, 22.244679, 40.192392)), (600.0, (47.150096, 15.684689, 53.475478))],
)
def test_bend_of_45_degrees(load: float, expected: tuple[float, float, float]) -> None:
    """Bathe & Bolourchi 1979; with 8 elements Simo & Vu-Quoc 1986. z to x, load in y."""
    law = SectionLaw(
        np.diag([1e7 / 12, 1e7 / 12, 5e6 / 6]),
        np.diag([6 / 5 / 5e6, 6 / 5 / 5e6, 1e-7]),
        RIGID,
        (0, 1, 2),
    )
    rest = STRAIGHT + np.array([0, 0.01, 0, 0, 0, 0])
    end = PointLoad(force=np.array([0, load, 0]))
    rod = Rod((Segment(25 * np.pi, law, rest, end=end),))
    coarse, middle, fine = (tip(rod, n)[[2, 0, 1]] for n in (8, 16, 32))
    assert order(coarse, middle, fine) == pytest.approx(2, abs=0.02)
    np.testing.assert_allclose((4 * fine - middle) / 3, expected, rtol=0, atol=1e-4)
    if load == 300:
        np.testing.assert_allclose(coarse, [58.84, 22.33, 40.08], rtol=0, atol=0.3)


def test_base_and_space_turn_together() -> None:
    turn = Rotation.from_rotvec([0.4, -1.1, 2.0]).as_matrix()
    rod = general(conservative=True)
    segments = []
    for one in rod.segments:
        line = replace(one.line, force=turn @ one.line.force)
        segments.append(replace(one, line=line, end=replace(one.end, force=turn @ one.end.force)))
    base = Base(turn @ rod.base.position, turn @ rod.base.rotation)
    turned = replace(rod, segments=tuple(segments), base=base)
    np.testing.assert_allclose(tip(turned, 6), turn @ tip(rod, 6), rtol=0, atol=1e-9)


def test_the_way_to_a_case_does_not_matter() -> None:
    rod = Rod((Segment(1.0, SPACE, end=PointLoad(force=np.array([2.0, 1.0, -1.0]))),))
    rest = STRAIGHT + np.zeros((9, 1, 6))
    rest[:, 0, :2] = np.stack(np.meshgrid([-1, 0, 1], [-1, 0, 1]), axis=-1).reshape(9, 2)
    there = METHOD.solve(rod, rest, 8)
    back = METHOD.solve(rod, rest[::-1], 8)
    alone = np.array([METHOD.solve(rod, one[None], 8).tips[0] for one in rest])
    np.testing.assert_allclose(there.tips, back.tips[::-1], rtol=0, atol=1e-9)
    np.testing.assert_allclose(there.tips, alone, rtol=0, atol=1e-9)


def missed(rod: Rod, wrench: FloatArray) -> tuple[FloatArray, FloatArray]:
    """What is left at the tip of force and moment (in space) that begin as `wrench`; the tip.

    F' = −f, M' = −h' × F − (R a) × f, R' = R [u]×, h' = R v, by the law and the loads as given.
    """

    def rate(_: float, state: FloatArray, one: Segment) -> FloatArray:
        R, F, M = state[:9].reshape(3, 3), state[12:15], state[15:]
        n, m = R.T @ F, R.T @ M
        bend = np.linalg.solve(one.law.bending, m - one.law.coupling @ n)
        u = one.rest[:3] + bend
        v = one.rest[3:] + one.law.compliance @ n - one.law.coupling.T @ bend
        f = one.line.force + R @ one.line.follower_force
        arm = R @ one.line.at
        moments = -np.cross(R @ v, F) - np.cross(arm, f)
        return np.concatenate([(R @ cross(u)).ravel(), R @ v, -f, moments])

    R, state = rod.base.rotation, np.concatenate([rod.base.position, wrench])
    for one in rod.segments:
        start = np.concatenate([(R @ one.kink).ravel(), state])
        result = solve_ivp(
            *(rate, (0, one.length), start, "DOP853"), args=(one,), rtol=1e-10, atol=1e-10
        )
        R, state = result.y[:9, -1].reshape(3, 3), result.y[9:, -1]
        force = one.end.force + R @ one.end.follower_force
        moment = one.end.moment + R @ one.end.follower_moment + np.cross(R @ one.end.at, force)
        state = state - np.concatenate([np.zeros(3), force, moment])
    return state[3:], state[:3]


@pytest.mark.parametrize("conservative", [True, False], ids=["dead", "all"])
def test_every_kind_of_load_against_shooting(conservative: bool) -> None:
    rod = general(conservative)

    def left(wrench: FloatArray) -> FloatArray:
        return missed(rod, wrench)[0]

    found = root(left, np.zeros(6), tol=1e-10)
    assert found.success
    middle, fine = tip(rod, 64), tip(rod, 128)
    _, expected = missed(rod, found.x)
    np.testing.assert_allclose((4 * fine - middle) / 3, expected, rtol=0, atol=1e-6)


def test_a_held_tip() -> None:
    """Turned by a right angle and otherwise free it is a quarter of a circle."""
    rotation = Rotation.from_rotvec([0, np.pi / 2, 0]).as_matrix()
    rod = Rod((Segment(1.0, SPACE),), tip=Tip(rotation=rotation))
    np.testing.assert_allclose(tip(rod, 3), [2 / np.pi, 0, 2 / np.pi], atol=1e-9)
    place = np.array([0.3, 0.1, 0.7])
    held = solved(replace(rod, tip=Tip(position=place, rotation=rotation)), 8)
    assert held.converged.all()
    np.testing.assert_array_equal(held.tips[0], place)
    np.testing.assert_allclose(held.rotations[0], rotation, atol=1e-12)


def test_a_hinge() -> None:
    """A beam on two supports sags by 5 q L⁴/(384 EI) where the load is small."""
    law = replace(SPACE, compliance=np.diag([0, 0, 1e-3]))
    line = LineLoad(force=np.array([1e-3, 0, 0]))
    rod = Rod(
        (Segment(1.0, law, line=line),),
        Base(hinges=np.array([[0, 1.0, 0]])),
        Tip(position=np.array([0, 0, 1.0])),
    )
    found = solved(rod, 32)
    assert found.converged.all()
    middle = found.centrelines[0, 16, 0]
    assert middle == pytest.approx(5 * 1e-3 / 384 / law.bending[1, 1], rel=5e-3)
