"""Chains of flips: what they leave behind is what they say."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from beamopt.judge.judge import Judge
from beamopt.refine.annealing import _arc_aim, _left_out
from beamopt.refine.flips import Flips, walk
from beamopt.refine.fragments import fragments_of
from beamopt.refine.orbits import orbits_of
from beamopt.refine.truth import Judged
from beamopt.section.delaunay import delaunay_edges
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.neighbours import neighbours_of
from beamopt.section.symmetry import Symmetry, mirror_symmetry, threefold_symmetry
from tests.beamopt.refine.cases import judge_of, judged, points_of, random_points


def flips_of(judge: Judge, points: FeaturePoints, symmetry: Symmetry | None = None) -> Flips:
    fragments = fragments_of(judge.grid, points, judge.wall_elements, judge.rules)
    edges = delaunay_edges(points.x, points.y)
    around = neighbours_of(edges, len(points))
    orbits = orbits_of(len(points), symmetry)
    return Flips(fragments, edges, *around, orbits, judge.neighbour_weight)


def walked(
    judge: Judge, start: Judged, flips: Flips, temperature: float, draws: np.ndarray
) -> tuple[FeaturePoints, float]:
    types = start.points.type.copy()
    added, total = _left_out(flips.fragments, start), start.verdict.T
    total = walk(types, added, total, temperature, flips, _arc_aim(judge, start), draws)
    return start.points.with_types(types), total


@settings(max_examples=8)
@pytest.mark.parametrize("name", ["random-section", "pairs"])
@given(seed=st.integers(0, 10_000), temperature=st.sampled_from([1e-3, 100.0, 1e5]))
def test_the_total_is_that_of_the_true_section(name: str, seed: int, temperature: float) -> None:
    judge = judge_of(name)
    start = judged(judge, random_points(seed))
    draws = np.random.default_rng(seed).random((400, 4))
    points, total = walked(judge, start, flips_of(judge, start.points), temperature, draws)
    assert total == pytest.approx(judge([points])[0].T, rel=1e-9)
    assert (points.type != start.points.type).any()


def test_the_total_is_that_of_the_true_section_without_walls() -> None:
    judge = judge_of("random-section", "section.wall_elements=0", "section.feature_points=25")
    start = judged(judge, random_points(3))
    draws = np.random.default_rng(3).random((1000, 4))
    points, total = walked(judge, start, flips_of(judge, start.points), 1e3, draws)
    assert total == pytest.approx(judge([points])[0].T, rel=1e-9)


def test_in_the_cold_nothing_rises() -> None:
    judge = judge_of()
    here = judged(judge, random_points(4))
    flips, rng = flips_of(judge, here.points), np.random.default_rng(4)
    first = here.verdict.T
    for _ in range(100):
        points, total = walked(judge, here, flips, 1e-300, rng.random((3, 4)))
        assert total <= here.verdict.T
        here = judged(judge, points)
        assert total == pytest.approx(here.verdict.T, rel=1e-9)
    assert first / 2 > here.verdict.T


def test_without_draws_nothing_moves() -> None:
    judge = judge_of()
    start = judged(judge, random_points(4))
    flips = flips_of(judge, start.points)
    points, total = walked(judge, start, flips, 1.0, np.zeros((0, 4)))
    assert total == start.verdict.T
    np.testing.assert_array_equal(points.type, start.points.type)


@pytest.mark.parametrize("which", ["mirror", "threefold"])
def test_images_flip_with_their_generators(which: str) -> None:
    judge = judge_of()
    symmetry = mirror_symmetry() if which == "mirror" else threefold_symmetry(judge.grid)
    start = judged(judge, symmetry.symmetrised(random_points(5)))
    flips = flips_of(judge, start.points, symmetry)
    draws = np.random.default_rng(5).random((300, 4))
    points, total = walked(judge, start, flips, 1e4, draws)
    assert (points.type != start.points.type).any()
    np.testing.assert_array_equal(symmetry.symmetrised(points).type, points.type)
    assert total == pytest.approx(judge([points])[0].T, rel=1e-9)


def test_a_neighbours_type_is_proposed_every_other_time() -> None:
    """Between equal types nothing is proposed; the flips that are left are the even ones."""
    judge = judge_of()
    points = random_points(6).with_types(np.zeros(25, dtype=np.uint8))
    start = judged(judge, points)
    flips, draws = flips_of(judge, points), np.random.default_rng(6).random((200, 4))
    draws[:, 0] = 0.75
    assert (walked(judge, start, flips, 1e300, draws)[0].type == 0).all()
    draws[:, 0] = 0.25
    assert (walked(judge, start, flips, 1e300, draws)[0].type != 0).any()


def test_frequencies_are_boltzmanns() -> None:
    """Sixteen states of two cells under even flips: p ∝ exp(−T/temperature)."""
    judge = judge_of("random-section", "grid.radial=4", "grid.angular=12")
    points = points_of((15, 1, 0), (-15, 2, 1))
    flips = flips_of(judge, points)
    states = [np.array(pair, dtype=np.uint8) for pair in itertools.product(range(4), repeat=2)]
    totals = np.array([judge([points.with_types(types)])[0].T for types in states])
    temperature = float(np.ptp(totals[np.isfinite(totals)]) / 3)
    wanted = np.exp(-(totals - totals.min()) / temperature)
    wanted /= wanted.sum()
    start = judged(judge, points)
    added, aim = _left_out(flips.fragments, start), _arc_aim(judge, start)
    rng, types, total = np.random.default_rng(0), points.type.copy(), start.verdict.T
    counted = np.zeros((4, 4))
    for _ in range(20_000):
        draws = rng.random((4, 4))
        draws[:, 0] /= 2
        total = walk(types, added, total, temperature, flips, aim, draws)
        counted[types[0], types[1]] += 1
    assert np.sort(wanted)[-4] > 0.05  # the test sees more than one state
    np.testing.assert_allclose(counted.ravel() / 20_000, wanted, atol=0.02)
