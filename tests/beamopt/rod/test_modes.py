"""Equilibria in modes: convergence, the error's estimate, statics, energy, invariance."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from beamopt.base.arrays import FloatArray
from beamopt.rod.law import cross
from beamopt.rod.modes import StrainModes
from beamopt.rod.newton import FOUND
from beamopt.rod.rod import STRAIGHT, Base, LineLoad, PointLoad, Rod, Segment, Tip
from tests.beamopt.rod.samples import BEND, SPACE, plain_law, random_rod, rotation, solved
from tests.beamopt.rod.statics import base_from_tip
from tests.beamopt.rod.system import System

seeds = st.integers(0, 2**32)
Y_HINGE = Base(hinges=np.array([[0.0, 1.0, 0.0]]))


def smooth(load: float = 2.0) -> Rod:
    """One segment of length 1, EI = 1, under weight, force and moment in space."""
    line = LineLoad(force=load * np.array([0.5, 1.0, -1.0]))
    end = PointLoad(force=load * np.array([1.0, -0.5, 0.3]), moment=np.array([0.0, 0.2, 0.3]))
    rest = STRAIGHT + np.array([0.5, 0.0, 0.2, 0.0, 0.0, 0.0])
    return Rod((Segment(1.0, plain_law(), rest, line=line, end=end),))


def test_the_tip_converges_spectrally() -> None:
    """Ten times with every two modes, and more.

    The rotation's own steps, of sixth order in the distance of the points, leave 1e-9 at 8 modes.
    """
    exact = solved(smooth(), 24).tips
    errors = [float(np.abs(solved(smooth(), n).tips - exact).max()) for n in (1, 3, 5, 7)]
    ratios = np.array(errors[:-1]) / np.array(errors[1:])
    assert np.all(ratios > 10), errors
    assert np.abs(solved(smooth(), 12).tips - exact).max() < 1e-9


@pytest.mark.parametrize("free", [BEND, SPACE])
@given(seed=seeds, load=st.floats(0.1, 3.0), modes=st.integers(1, 6))
@settings(max_examples=40)
def test_the_error_is_no_flattery(
    free: tuple[int, ...], seed: int, load: float, modes: int
) -> None:
    """Never below a thirtieth of the true error, where that is more than the rotation's steps make.

    One sweep from the moments to the curvatures does not repeat what the loads make of its change.
    """
    rod = random_rod(np.random.default_rng(seed), free=free, load=load)
    coarse, fine = solved(rod, modes), solved(rod, 20)
    assume(coarse.converged[0] and fine.converged[0])
    true = float(np.linalg.norm(coarse.tips - fine.tips))
    assert coarse.error[0] > true / 30 or true < 1e-7


@pytest.mark.parametrize("free", [BEND, SPACE])
@pytest.mark.parametrize("modes", [1, 2, 3])
def test_the_error_is_mostly_right(free: tuple[int, ...], modes: int) -> None:
    """Of 40 rods under small and large loads none is more than 1.3 times as far off."""
    shares = []
    for seed in range(40):
        rod = random_rod(np.random.default_rng(seed), free=free, load=0.2 + seed / 20)
        coarse, fine = solved(rod, modes), solved(rod, 12)
        if coarse.converged[0] and fine.converged[0]:
            shares.append(np.linalg.norm(coarse.tips - fine.tips) / coarse.error[0])
    assert len(shares) > 30
    assert np.max(shares) < 1.3
    assert 0.03 < np.median(shares) < 1.5


@pytest.mark.parametrize("free", [BEND, SPACE])
@given(seed=seeds)
@settings(max_examples=15)
def test_it_balances(free: tuple[int, ...], seed: int) -> None:
    """Integrated from its tip with the loads that are beyond, the rod arrives at its base.

    All kinds of loads; 16 modes resolve it to 1e-9.
    """
    rod = random_rod(np.random.default_rng(seed), free=free)
    found = solved(rod, 16)
    assume(found.converged[0])
    position, turn, _ = base_from_tip(rod, found.tips[0], found.rotations[0])
    np.testing.assert_allclose(position, rod.base.position, rtol=0, atol=1e-7)
    np.testing.assert_allclose(turn, rod.base.rotation, rtol=0, atol=1e-7)


@pytest.mark.parametrize("free", [BEND, SPACE])
def test_a_hinge_bears_no_moment(free: tuple[int, ...]) -> None:
    """A pendulum, bent by a force at its tip: the base's rotation is the hinge's alone."""
    line = LineLoad(force=np.array([0.3, 0.0, 2.0]))
    end = PointLoad(force=np.array([0.5, 0.2, 0.0]), at=np.array([0.0, 0.2, 0.1]))
    rod = Rod((Segment(1.0, plain_law(0.5, free=free), line=line, end=end),), Y_HINGE)
    found = solved(rod, 16)
    assert found.converged[0]
    position, turn, moment = base_from_tip(rod, found.tips[0], found.rotations[0])
    assert moment[1] == pytest.approx(0, abs=1e-7)
    np.testing.assert_allclose(position, 0, atol=1e-8)
    np.testing.assert_allclose(turn[:, 1], [0, 1, 0], atol=1e-8)
    assert abs(turn[0, 2]) > 0.1


def test_a_stiff_pendulum_points_along_its_load() -> None:
    """A line load on it makes no moment anywhere then."""
    line = LineLoad(force=np.array([0.9, 0.0, 1.2]))
    found = solved(Rod((Segment(2.0, plain_law(), line=line),), Y_HINGE))
    np.testing.assert_allclose(found.tips, [[1.2, 0, 1.6]], atol=1e-12)


@given(seeds)
@settings(max_examples=20)
def test_turned_with_its_loads_a_rod_turns_its_tip(seed: int) -> None:
    rng = np.random.default_rng(seed)
    rod, R, shift = random_rod(rng), rotation(rng), rng.normal(size=3)
    here, there = solved(rod), solved(moved(rod, R, shift))
    assume(here.converged[0])
    np.testing.assert_allclose(there.tips[0], shift + R @ here.tips[0], rtol=0, atol=1e-10)
    np.testing.assert_allclose(there.rotations[0], R @ here.rotations[0], rtol=0, atol=1e-10)


@pytest.mark.parametrize("hinge", [False, True])
def test_a_held_tip_turns_along(hinge: bool) -> None:
    rng = np.random.default_rng(11)
    rod = random_rod(rng, load=0.5, hinge=hinge)
    free = solved(replace(rod, base=replace(rod.base, hinges=np.zeros((0, 3)))))
    held = Tip(free.tips[0] + [0.05, -0.03, 0.02], free.rotations[0])
    rod = replace(rod, tip=held)
    R, shift = rotation(rng), rng.normal(size=3)
    here, there = solved(rod), solved(moved(rod, R, shift))
    assert here.converged[0]
    np.testing.assert_allclose(here.tips[0], held.position, rtol=0, atol=1e-9)
    np.testing.assert_allclose(here.rotations[0], held.rotation, rtol=0, atol=1e-9)
    expected = shift + here.centrelines[0] @ R.T
    np.testing.assert_allclose(there.centrelines[0], expected, rtol=0, atol=1e-9)


def moved(rod: Rod, R: FloatArray, shift: FloatArray) -> Rod:
    """The rod with its base, dead loads and what holds its tip."""
    segments = tuple(
        replace(
            one,
            line=replace(one.line, force=R @ one.line.force),
            end=replace(one.end, force=R @ one.end.force, moment=R @ one.end.moment),
        )
        for one in rod.segments
    )
    base = replace(
        rod.base,
        position=shift + R @ rod.base.position,
        rotation=R @ rod.base.rotation,
        hinges=rod.base.hinges @ R.T,
    )
    x, turn = rod.tip.position, rod.tip.rotation
    tip = Tip(None if x is None else shift + R @ x, None if turn is None else R @ turn)
    return replace(rod, segments=segments, base=base, tip=tip)


@pytest.mark.parametrize("free", [BEND, SPACE])
def test_work_is_energy(free: tuple[int, ...]) -> None:
    """∫ F·dx over the load's growth is the energy stored, for a dead force beside the tip's axis.

    ∫ F·dx = F·x(1) − F·∫ x dλ by ten Gauss points; energy ½ ∫ (Δu·bending Δu + n·compliance n).
    """
    rng = np.random.default_rng(6)
    law = random_rod(rng, free=free).segments[0].law
    force, at = 2 * rng.normal(size=3), np.array([0.05, 0.1, 0.0])
    rest = STRAIGHT + np.array([0.5, -0.3, 0.0, 0.1, 0.0, 0.0])
    rod = Rod((Segment(1.0, law, rest, end=PointLoad(force=force, at=at)),))

    def reached(share: float) -> FloatArray:
        found = solved(rod.scaled(share), 16)
        return np.asarray(found.tips[0] + found.rotations[0] @ at)

    x, w = np.polynomial.legendre.leggauss(10)
    mean = np.einsum("k,ki->i", w / 2, np.array([reached(share) for share in (1 + x) / 2]))
    work = float(force @ (reached(1.0) - mean))
    system = System(rod, 16)
    assert system.iterated()[0] == FOUND
    bent = system.shape.bent
    pull = np.einsum("kji,j->ki", system.shape.rotation, force)
    density = np.einsum("ki,ij,kj->k", bent, law.bending, bent)
    density += np.einsum("ki,ij,kj->k", pull, law.compliance, pull)
    assert work == pytest.approx(float(system.at.weight @ density) / 2, rel=1e-8)


def test_the_order_of_loading_does_not_count() -> None:
    """Weight first, then the tip's force; the other way round; half of both; together."""
    weight, force = np.array([0.0, 1.0, -2.0]), np.array([2.0, 0.0, 0.5])

    def system(w: float, f: float) -> System:
        line, end = LineLoad(w * weight), PointLoad(f * force)
        return System(Rod((Segment(1.0, plain_law(1.0, 0.8), line=line, end=end),)), 12)

    _, together = system(1, 1).iterated()
    for first in ((1, 0), (0, 1), (0.5, 0.5), (0, -1), (-0.5, 2)):
        _, between = system(*first).iterated()
        ended, found = system(1, 1).iterated(between)
        assert ended == FOUND
        np.testing.assert_allclose(found, together, rtol=0, atol=1e-11)


def test_parents_do_not_count() -> None:
    """Nine rest curvatures of the loaded rod, each begun from others."""
    rests = np.tile(STRAIGHT, (9, 1, 1))
    bends = np.array([0.0, 0.6, 1.2])
    rests[:, 0, 0], rests[:, 0, 1] = np.repeat(bends, 3), np.tile(bends, 3)
    alone = StrainModes().solve(smooth(), rests, 12)
    assert alone.converged.all()
    by_one, by_other, by_three = (np.full((9, 3), -1) for _ in range(3))
    by_one[1:, 0] = [0, 1, 0, 3, 4, 3, 6, 7]
    by_other[1:, 0] = [0, 1, 0, 1, 2, 3, 4, 5]
    by_three[:, :] = by_one
    by_three[[4, 5, 7, 8]] = [[3, 1, 0], [4, 2, 1], [6, 4, 3], [7, 5, 4]]
    for parents in (by_one, by_other, by_three):
        found = StrainModes(parents=parents).solve(smooth(), rests, 12)
        np.testing.assert_allclose(found.tips, alone.tips, rtol=0, atol=1e-11)
        assert found.iterations[1:].sum() < alone.iterations[1:].sum()


@pytest.mark.parametrize("turned", [False, True])
def test_the_reaction_as_a_load_gives_the_same_shape(turned: bool) -> None:
    """What holds a tip, put on the free rod as dead force and moment."""
    rng = np.random.default_rng(9)
    rod = random_rod(rng, load=0.5, follows=False, moments=False)
    free = solved(rod)
    turn = free.rotations[0] @ rotation_by(0.1) if turned else None
    held = replace(rod, tip=Tip(free.tips[0] + [0.04, 0.05, -0.03], turn))
    found, system = solved(held), System(held, 12)
    assert found.converged[0]
    ended, unknowns = system.iterated()
    assert ended == FOUND
    pull = system.reaction(unknowns)
    assert np.linalg.norm(pull[:3]) > 0.1
    assert np.any(pull[3:]) == turned
    last = rod.segments[-1]
    # it acts on the axis, the end's own force beside it
    arm = cross(found.rotations[0] @ last.end.at) @ pull[:3]
    end = replace(last.end, force=last.end.force + pull[:3], moment=pull[3:] - arm)
    pulled = solved(replace(rod, segments=(*rod.segments[:-1], replace(last, end=end))))
    np.testing.assert_allclose(pulled.centrelines, found.centrelines, rtol=0, atol=1e-9)


def rotation_by(angle: float) -> FloatArray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
