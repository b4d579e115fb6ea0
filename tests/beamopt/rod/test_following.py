"""How loads end that a rod does not bear; and loads that no rod bears."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from beamopt.base.arrays import FloatArray
from beamopt.rod.law import SectionLaw
from beamopt.rod.modes import StrainModes
from beamopt.rod.path import CriticalKind, follow_path
from beamopt.rod.rod import STRAIGHT, Base, LineLoad, PointLoad, Rod, Segment, Tip
from beamopt.rod.solution import RodSolution
from beamopt.rod.status import RodStatus
from tests.beamopt.rod.samples import BEND, PLANE, SPACE, plain_law, random_rod, solved, turned

EULER = np.pi**2 / 4  # of a cantilever, EI = L = 1


def column(force: float, free: tuple[int, ...] = SPACE, curvature: float = 0.0) -> Rod:
    rest = STRAIGHT + np.array([0.0, curvature, 0.0, 0.0, 0.0, 0.0])
    law, end = plain_law(1.0, 0.7, free), PointLoad(np.array([0.0, 0.0, -force]))
    return Rod((Segment(1.0, law, rest, end=end),))


def arch(force: float, rise: float = 3.4) -> Rod:
    """Shallow, hinged at both ends, of radius 1 and ±0.2 rad; pressed down in its middle.

    rise : in radii of gyration. 3.4 is enough to snap and too little to evade sideways.
    """
    half = 0.2
    gyration = (1 - np.cos(half)) / rise
    compliance = np.diag([0.0, 0.0, gyration**2])
    law = SectionLaw(np.eye(3), compliance, np.zeros((3, 3)), PLANE)
    rest = STRAIGHT + np.array([0.0, 1.0, 0.0, 0.0, 0.0, 0.0])
    press = PointLoad(force=np.array([force, 0.0, 0.0]))
    return Rod(
        (Segment(half, law, rest, end=press), Segment(half, law, rest)),
        Base(rotation=turned(1, -half), hinges=np.array([[0.0, 1.0, 0.0]])),
        Tip(position=np.array([0.0, 0.0, 2 * np.sin(half)])),
    )


def assert_no_tip(found: RodSolution) -> None:
    for values in (found.tips, found.rotations, found.centrelines, found.error):
        assert np.isnan(values).all()
    assert not found.converged.any()
    assert 0 <= found.factor[0] < 1


@pytest.mark.parametrize("free", [PLANE, BEND, SPACE])
def test_a_straight_column_buckles(free: tuple[int, ...]) -> None:
    """At Euler's load, to the smallest step of the load, 2e-4 of what is asked for, and a half."""
    found = solved(column(1.5 * EULER, free))
    assert found.status == (RodStatus.BUCKLED,)
    assert found.factor[0] == pytest.approx(1 / 1.5, abs=3e-4)
    assert_no_tip(found)
    below = solved(column(0.999 * EULER, free))
    assert below.status == (RodStatus.CONVERGED,)
    np.testing.assert_allclose(below.tips[0], [0, 0, 1], atol=1e-12)


@pytest.mark.parametrize("share", [1.5, 4.0])
def test_a_curved_one_goes_on(share: float) -> None:
    found = solved(column(share * EULER, PLANE, 0.01), 20)
    assert found.status == (RodStatus.CONVERGED,)
    assert found.tips[0, 0] > 0.3


def test_a_shallow_arch_snaps() -> None:
    """At the first limit of its path, whatever is asked for beyond it."""
    path = follow_path(arch(40.0), step=0.02, steps=250, modes=7)
    limit = 40 * path.limits[0]
    assert limit == pytest.approx(25.29, abs=0.01)
    for force in (30.0, 40.0, 100.0):
        found = solved(arch(force), 7)
        assert found.status == (RodStatus.LIMIT_POINT,)
        assert force * found.factor[0] == pytest.approx(limit, abs=5e-4 * force)
        assert_no_tip(found)
    assert solved(arch(0.999 * limit), 7).converged[0]


@pytest.mark.parametrize("force", [25.0, 30.0, 40.0, 60.0])
def test_a_snap_is_not_jumped_over(force: float) -> None:
    """Its limit is 18.80; the stable shape beyond is another one than that which it came from."""
    found = solved(arch(force, 2.6), 7)
    assert found.status == (RodStatus.LIMIT_POINT,)
    assert force * found.factor[0] == pytest.approx(18.80, abs=0.02)


def test_an_arch_that_is_too_long_for_its_rise_evades_sideways() -> None:
    """A rise of 8 radii of gyration: it buckles before the limit of its symmetric path."""
    found = solved(arch(100.0, 8.0), 7)
    assert found.status == (RodStatus.BUCKLED,)
    path = follow_path(arch(100.0, 8.0), step=0.1, steps=150, modes=7)
    assert [one.kind for one in path.critical] == [CriticalKind.BIFURCATION, CriticalKind.LIMIT]
    assert found.factor[0] == pytest.approx(path.bifurcations[0], abs=3e-4)
    assert path.bifurcations[0] < 0.99 * path.limits[0]


@pytest.mark.parametrize("share", [1.01, 2.0, 100.0])
def test_a_short_rod_is_crushed(share: float) -> None:
    """EA = 100: v3 = 1 − P/EA is nothing at P = EA, far below its buckling load."""
    law = SectionLaw(1e6 * np.eye(3), np.diag([0.02, 0.02, 0.01]), np.zeros((3, 3)))

    def rod(force: float) -> Rod:
        return Rod((Segment(0.1, law, end=PointLoad(np.array([0.0, 0.0, -force]))),))

    found = solved(rod(share * 100))
    assert found.status == (RodStatus.CRUSHED,)
    assert np.isnan(found.tips).all()
    nearly = solved(rod(99.0))
    np.testing.assert_allclose(nearly.tips, [[0, 0, 1e-3]], rtol=1e-9)
    assert found.factor[0] <= 1 / share + 1e-9


@pytest.mark.parametrize("force", [(1.0, 0.0, 0.0), (0.3, 0.0, -1.0), (0.0, 0.0, -1.0)])
def test_a_pendulum_upside_down_has_a_status(force: tuple[float, float, float]) -> None:
    """Held by its hinge alone a rod has no stiffness at rest: it need not be found how it falls."""
    line, base = LineLoad(force=np.array(force)), Base(hinges=np.array([[0.0, 1.0, 0.0]]))
    found = solved(Rod((Segment(1.0, plain_law(10.0), line=line),), base))
    if found.converged[0]:
        expected = np.array(force) / np.linalg.norm(force)
        np.testing.assert_allclose(found.tips[0], expected, atol=1e-9)
    else:
        assert_no_tip(found)


def test_nothing_happens_to_an_unloaded_arch() -> None:
    found = solved(arch(0.0), 6)
    assert found.converged[0]
    np.testing.assert_allclose(found.tips, [[0, 0, 2 * np.sin(0.2)]], atol=1e-12)


def test_only_the_case_that_fails_has_no_tip() -> None:
    """Beside it, the same as alone."""
    rod = column(1.5 * EULER, PLANE)
    rests = np.tile(rod.rest, (3, 1, 1))
    rests[[0, 2], 0, 1] = 0.1, -0.1
    found = StrainModes().solve(rod, rests, 12)
    wanted = (RodStatus.CONVERGED, RodStatus.BUCKLED, RodStatus.CONVERGED)
    assert found.status == wanted
    assert np.isnan(found.tips[1]).all()
    alone = StrainModes().solve(rod, rests[:1], 12)
    np.testing.assert_allclose(found.tips[0], alone.tips[0], atol=1e-12)
    np.testing.assert_allclose(found.tips[2], alone.tips[0] * [-1, 1, 1], atol=1e-10)


@given(
    seed=st.integers(0, 2**32),
    power=st.floats(3, 8),
    free=st.sampled_from([BEND, SPACE]),
    hinge=st.booleans(),
    held=st.booleans(),
    follows=st.booleans(),
)
@settings(max_examples=25)
def test_no_load_is_too_large_to_answer(
    seed: int, power: float, free: tuple[int, ...], hinge: bool, held: bool, follows: bool
) -> None:
    """10³ … 10⁸ times what bends it well: a status, no exception, no warning."""
    rng = np.random.default_rng(seed)
    rod = random_rod(
        rng, free=free, load=10.0**power, hinge=hinge, held=held, follows=follows, moments=follows
    )
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = solved(rod, 4)
    if not found.converged[0]:
        assert_no_tip(found)


def recomputed_tip(rod: Rod, found: RodSolution) -> FloatArray:
    """Tip of a plane, inextensible cantilever bent by what its centreline says the moment is.

    κ = κ* + ((x_tip − h) × F)_y / EI at its Gauss points, integrated twice.
    """
    segment = rod.segments[0]
    count = len(found.stations)
    _, w = np.polynomial.legendre.leggauss(count)
    lever = found.tips[0] - found.centrelines[0]
    force = segment.end.force + found.rotations[0] @ segment.end.follower_force
    moment = np.cross(lever, force)[:, 1]
    bent = np.polynomial.legendre.Legendre.fit(
        found.stations, segment.rest[1] + moment / segment.law.bending[1, 1], count - 1,
        domain=[0, segment.length],
    )  # fmt: skip
    angle = bent.integ(lbnd=0)(found.stations)
    across, along = w @ np.sin(angle) / 2, w @ np.cos(angle) / 2
    return np.array([across, 0.0, along]) * segment.length


@given(
    power=st.floats(-1, 8),
    direction=st.floats(-np.pi, np.pi),
    curvature=st.floats(-1, 1),
    follows=st.booleans(),
)
@settings(max_examples=60)
def test_a_tip_that_is_given_balances(
    power: float, direction: float, curvature: float, follows: bool
) -> None:
    """A cantilever under any force: to five times its estimated error, or 1e-6."""
    force = 10.0**power * np.array([np.sin(direction), 0.0, np.cos(direction)])
    end = PointLoad(follower_force=force) if follows else PointLoad(force=force)
    rest = STRAIGHT + np.array([0.0, curvature, 0.0, 0.0, 0.0, 0.0])
    rod = Rod((Segment(1.0, plain_law(free=PLANE), rest, end=end),))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = solved(rod)
    if not found.converged[0]:
        assert_no_tip(found)
        return
    off = np.abs(recomputed_tip(rod, found) - found.tips[0]).max()
    assert off < 5 * found.error[0] + 1e-6


@pytest.mark.parametrize("turns", [1.9, 2.0])
def test_a_coil_of_two_turns_leaves_its_plane(turns: float) -> None:
    """Rolled up further than a circle by a moment, a rod that twists easily is not stable."""
    law = SectionLaw(np.diag([1.0, 1.0, 0.7]), np.zeros((3, 3)), np.zeros((3, 3)), (0, 1, 2))
    end = PointLoad(moment=np.array([0.0, 2 * np.pi * turns, 0.0]))
    rod = Rod((Segment(1.0, law, end=end),))
    found = StrainModes(direct=False).solve(rod, rod.rest[None], 12)
    assert found.status == (RodStatus.BUCKLED,)
