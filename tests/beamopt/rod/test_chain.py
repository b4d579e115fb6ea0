"""Products of exponentials against the arc, against themselves and against scipy's exponential."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import expm

from beamopt.base.arrays import FloatArray
from beamopt.rod.arc import arc_tips
from beamopt.rod.chain import SERIES_BELOW, chain_tips
from beamopt.rod.law import cross
from beamopt.rod.rod import STRAIGHT, Base, Rod, Segment
from tests.beamopt.rod.samples import plain_law, random_rod, rotation, solved

SWITCH = float(np.sqrt(SERIES_BELOW))


def chain(lengths: tuple[float, ...], strains: FloatArray) -> Rod:
    law = plain_law()
    return Rod(tuple(Segment(x, law, rest) for x, rest in zip(lengths, strains, strict=True)))


def exponentials(rod: Rod, rest: FloatArray) -> FloatArray:
    """(4, 4) pose of the tip: base · Π kink · exp(L [[û, v], [0, 0]])."""
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = rod.base.rotation, rod.base.position
    for segment, strains in zip(rod.segments, rest, strict=True):
        kink, twist = np.eye(4), np.zeros((4, 4))
        kink[:3, :3] = segment.kink
        twist[:3, :3], twist[:3, 3] = cross(strains[:3]), strains[3:]
        pose = pose @ kink @ expm(segment.length * twist)
    return pose


@pytest.mark.parametrize("angle", [0.0, 1e-12, 0.99 * SWITCH, 1.01 * SWITCH, 0.5, 3.0, 7.0, 20.0])
def test_one_segment_is_an_arc(angle: float) -> None:
    length = 100.0
    strains = np.array([[0.13, angle * np.cos(0.7) / length, angle * np.sin(0.7) / length]])
    rest = np.array([[[strains[0, 1], strains[0, 2], 0, 0, 0, 1 + strains[0, 0]]]])
    found, _ = chain_tips(chain((length,), rest[0]), rest)
    np.testing.assert_allclose(found, arc_tips(strains, length), rtol=0, atol=1e-13 * length)


@given(st.integers(0, 2**32), st.floats(-12, 1))
def test_any_chain_is_a_product_of_exponentials(seed: int, power: float) -> None:
    """Curved by 10^power; kinks, shear at rest and a base somewhere."""
    rng = np.random.default_rng(seed)
    rod = random_rod(rng)
    rest = rod.rest * np.array([10.0**power] * 3 + [1.0] * 3)
    position, turn = chain_tips(rod, rest[None])
    expected = exponentials(rod, rest)
    np.testing.assert_allclose(position[0], expected[:3, 3], rtol=0, atol=1e-13)
    np.testing.assert_allclose(turn[0], expected[:3, :3], rtol=0, atol=1e-13)


@given(st.integers(0, 2**32), st.floats(0.01, 0.99))
def test_a_segment_cut_in_two_is_the_same(seed: int, share: float) -> None:
    rng = np.random.default_rng(seed)
    strains = STRAIGHT + rng.normal(size=6)
    once, turned_once = chain_tips(chain((2.0,), strains[None]), strains[None, None])
    both = np.stack([strains, strains])
    twice, turned_twice = chain_tips(chain((2 * share, 2 - 2 * share), both), both[None])
    np.testing.assert_allclose(twice, once, rtol=0, atol=1e-14 * 30)
    np.testing.assert_allclose(turned_twice, turned_once, rtol=0, atol=1e-14 * 30)


def test_cases_do_not_touch_each_other() -> None:
    rng = np.random.default_rng(3)
    rod = random_rod(rng)
    rest = rng.normal(size=(5, 2, 6))
    together = chain_tips(rod, rest)
    for k in range(5):
        for all_, one in zip(together, chain_tips(rod, rest[k : k + 1]), strict=True):
            np.testing.assert_allclose(all_[k], one[0], rtol=0, atol=1e-13)


def test_the_base_carries_the_tip_along() -> None:
    rng = np.random.default_rng(4)
    R, x = rotation(rng), rng.normal(size=3)
    rod = chain((1.0,), STRAIGHT[None] + 0.3)
    moved = Rod(rod.segments, Base(x, R))
    here, turn = chain_tips(rod, rod.rest[None])
    there, turned = chain_tips(moved, rod.rest[None])
    np.testing.assert_allclose(there[0], x + R @ here[0], atol=1e-14)
    np.testing.assert_allclose(turned[0], R @ turn[0], atol=1e-14)


def test_modes_find_the_chain_without_loads() -> None:
    """Points and weights are exact for polynomials: an arc of 0.4 rad is resolved to 1e-13."""
    rod = random_rod(np.random.default_rng(5), load=0.0)
    found, (position, turn) = solved(rod), chain_tips(rod, rod.rest[None])
    np.testing.assert_allclose(found.tips, position, rtol=0, atol=1e-13)
    np.testing.assert_allclose(found.rotations, turn, rtol=0, atol=1e-13)
