"""Steps on positions: each the least squares that it says, each judged."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from beamopt.judge.judge import Judge
from beamopt.refine.gauss_newton import SLACK, DescentLimits, Linearised, descend, linearised
from beamopt.refine.orbits import orbits_of
from beamopt.refine.sensitivity import residual_of
from beamopt.refine.truth import Judged, Truth, View, judged_on
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.symmetry import threefold_symmetry
from tests.beamopt.refine.cases import judge_of, judged, points_of, random_points


def made_up(seed: int, points: int = 15, rows: int = 30) -> Linearised:
    rng = np.random.default_rng(seed)
    slopes, shape = rng.normal(size=(rows, 24)), rng.normal(size=(2 * points, 24))
    return Linearised(rng.normal(size=rows), slopes, shape)


def dense(model: Linearised) -> np.ndarray:
    return np.asarray(model.slopes @ model.shape.T)


def of_section(seed: int, name: str = "random-section") -> Linearised:
    judge = judge_of(name)
    here = judged(judge, random_points(seed))
    return linearised(judge, here, orbits_of(len(here.points), None))


@pytest.mark.parametrize("damping", [1e-6, 1e-4, 1e-2, 1.0, 100.0])
@pytest.mark.parametrize("points", [3, 15, 40])
def test_a_step_is_the_damped_least_squares(damping: float, points: int) -> None:
    """min |r + J d|² + μ |d|² with μ = damping · tr JᵀJ, solved with all of J at once."""
    model = made_up(1, points)
    jacobian = dense(model)
    weight = np.sqrt(damping * (jacobian**2).sum())
    rows = np.concatenate([jacobian, weight * np.eye(2 * points)])
    wanted = np.concatenate([-model.residual, np.zeros(2 * points)])
    expected = np.linalg.lstsq(rows, wanted, rcond=None)[0]
    np.testing.assert_allclose(model.step(damping).ravel(), expected, rtol=1e-7, atol=1e-10)


def test_a_step_of_a_section_is_the_damped_least_squares() -> None:
    model = of_section(1)
    jacobian = dense(model)
    rows = np.concatenate([jacobian, np.sqrt(1e-3 * (jacobian**2).sum()) * np.eye(50)])
    wanted = np.concatenate([-model.residual, np.zeros(50)])
    expected = np.linalg.lstsq(rows, wanted, rcond=None)[0]
    size = np.abs(expected).max()
    np.testing.assert_allclose(model.step(1e-3).ravel() / size, expected / size, atol=1e-8)


@given(st.integers(0, 10_000))
def test_no_step_does_better_than_the_least(seed: int) -> None:
    model = made_up(seed, 1 + seed % 20)
    loss, least = float(model.residual @ model.residual), model.least()
    assert 0 <= least <= loss
    for damping in (1e-9, 1e-4, 1.0):
        there = model.residual + dense(model) @ model.step(damping).ravel()
        assert least * (1 - 1e-9) - 1e-9 <= there @ there <= loss
    exact = np.linalg.lstsq(dense(model), model.residual, rcond=None)[1]
    if exact.size:
        assert least == pytest.approx(float(exact[0]), rel=1e-6)


@pytest.mark.parametrize("seed", range(3))
def test_unfelt_steps_leave_the_moments(seed: int) -> None:
    for model in (made_up(seed, 40), of_section(seed)):
        noise = np.random.default_rng(seed).normal(size=(len(model.shape) // 2, 2))
        kept = model.unfelt(noise)
        before, after = (np.abs(model.shape.T @ step.ravel()).max() for step in (noise, kept))
        assert after < 1e-7 * before
        assert np.abs(kept).max() > 0.1
        np.testing.assert_allclose(model.unfelt(kept), kept, atol=1e-7)


@pytest.mark.parametrize("points", [points_of((15, 0, 0)), points_of((15, 0, 0), (-15, 0, 0))])
def test_where_nothing_changes_there_is_no_step(points: FeaturePoints) -> None:
    judge = judge_of()
    here = judged(judge, points)
    model = linearised(judge, here, orbits_of(len(points), None))
    assert not model.step(1e-4).any()
    assert model.least() == pytest.approx(here.verdict.L)
    noise = np.ones((len(points), 2))
    np.testing.assert_array_equal(model.unfelt(noise), noise)


@pytest.mark.parametrize("which", ["each alone", "threefold"])
def test_the_model_is_the_outlines_slope(which: str) -> None:
    """The whole chain, places → moments → response → tips, against exact sections nearby."""
    judge = judge_of("random-section", "section.wall_elements=0", "section.feature_points=25")
    symmetry = None if which == "each alone" else threefold_symmetry(judge.grid)
    points = random_points(2) if symmetry is None else symmetry.symmetrised(random_points(2))
    truth, orbits = judged_on(judge, View.OUTLINE), orbits_of(len(points), symmetry)
    model = linearised(judge, truth(points), orbits)
    step = np.random.default_rng(2).normal(size=(len(orbits.members), 2))
    ahead, behind = (truth(orbits.moved(points, s * step)) for s in (1e-3, -1e-3))
    ends = (residual_of(one.aim, one.answers) for one in (ahead, behind))
    expected = np.subtract(*ends) / 2e-3
    unit = np.abs(expected).max()
    np.testing.assert_allclose(dense(model) @ step.ravel() / unit, expected / unit, atol=2e-3)


class Spy:
    """A truth, maybe bent, with a list of all that it was asked."""

    def __init__(self, truth: Truth, bend: Callable[[Judged], Judged] = lambda one: one) -> None:
        self.truth, self.bend, self.seen = truth, bend, list[Judged]()

    def __call__(self, points: FeaturePoints) -> Judged:
        self.seen.append(self.bend(self.truth(points)))
        return self.seen[-1]


def descended(
    judge: Judge,
    start: Judged,
    limits: DescentLimits,
    bend: Callable[[Judged], Judged] = lambda one: one,
) -> tuple[Judged, bool, Spy]:
    spy = Spy(judged_on(judge, View.RASTER), bend)
    orbits, rng = orbits_of(len(start.points), None), np.random.default_rng(0)
    best, count, settled = descend(judge, spy, start, orbits, limits, rng)
    assert count == len(spy.seen)
    assert any(best is one for one in [start, *spy.seen])
    return best, settled, spy


@settings(max_examples=12)
@given(st.integers(0, 10_000), st.sampled_from(["random-section", "sealed-section", "spiral"]))
def test_never_a_higher_loss_nor_a_k_above_the_limit(seed: int, name: str) -> None:
    judge = judge_of(name)
    start = judged(judge, random_points(seed))
    second = start.verdict.K * (1 + 0.1 * (seed % 3))
    best, _, spy = descended(judge, start, DescentLimits(25, second))
    assert best.loss <= start.loss
    assert second >= best.verdict.K
    assert best.verdict == judge([best.points])[0]
    assert len(spy.seen) <= 25


@pytest.mark.parametrize("most", [0, 1, 2, 5, 9, 14])
def test_the_limit_of_evaluations_is_kept(most: int) -> None:
    """From a start that goes on for longer every one is used."""
    judge = judge_of()
    start = judged(judge, random_points(1))
    best, _, spy = descended(judge, start, DescentLimits(most, 1e9))
    assert len(spy.seen) == most
    assert best.loss < start.loss or most < 3


def test_good_enough_is_where_it_ends() -> None:
    judge = judge_of()
    start = judged(judge, random_points(1))
    best, settled, spy = descended(judge, start, DescentLimits(500, 1e9, start.loss))
    assert (best, settled, spy.seen) == (start, True, [])
    best, settled, spy = descended(judge, start, DescentLimits(500, 1e9, start.loss / 2))
    assert settled
    assert best is spy.seen[-1]
    assert best.loss <= start.loss / 2


def above(start: Judged, more: float) -> Callable[[Judged], Judged]:
    """Every other section has a K that is higher by `more`."""

    def bend(one: Judged) -> Judged:
        return replace(one, verdict=replace(one.verdict, K=start.verdict.K + more))

    return bend


@pytest.mark.parametrize("slacks", [1.0, 2.5, 3.0, 1e9])
def test_a_higher_k_is_given_only_where_it_alone_is_in_the_way(slacks: float) -> None:
    """2.5 slacks more: after two rounds of tries that it alone held up; 1: never."""
    judge = judge_of()
    start, slack = judged(judge, random_points(1)), SLACK * judge.neighbour_weight
    bend = above(start, 2.5 * slack)
    limits = DescentLimits(60, start.verdict.K + slacks * slack)
    best, _, spy = descended(judge, start, limits, bend)
    if slacks < 2.5:
        assert best is start
    else:
        assert best.loss < start.loss
        lower = [one.loss < start.loss for one in spy.seen]
        assert lower.index(True) < [one is best for one in spy.seen].index(True)


def test_a_k_above_the_limit_is_blocked() -> None:
    judge = judge_of()
    start = judged(judge, random_points(1))
    bend = above(start, 1.0)
    best, settled, spy = descended(judge, start, DescentLimits(500, start.verdict.K), bend)
    assert best is start
    assert not settled
    assert len(spy.seen) == 13  # all tries of one model


def test_where_nothing_can_be_judged_the_start_is_left() -> None:
    judge = judge_of()
    start = judged(judge, random_points(1))

    def lost(one: Judged) -> Judged:
        return judged(judge, FeaturePoints([], [], []))

    best, _, spy = descended(judge, start, DescentLimits(500, 1e9), lost)
    assert best is start
    assert len(spy.seen) == 13


def test_steps_are_short() -> None:
    """At most 4 % of the outer radius at a time."""
    judge = judge_of()
    start = judged(judge, random_points(1))
    _, _, spy = descended(judge, start, DescentLimits(1, 1e9))
    moved = spy.seen[0].points
    far = max(np.abs(moved.x - start.points.x).max(), np.abs(moved.y - start.points.y).max())
    assert 0 < far <= 0.04 * judge.grid.outer_radius * (1 + 1e-9)


@pytest.mark.parametrize("seed", [0, 2, 5])
def test_a_reachable_target_is_reached(seed: int) -> None:
    """From types that fit, moved by a little: back to a loss of nothing, and settled."""
    judge = judge_of("random-section", "section.feature_points=25")
    points, rng = random_points(seed), np.random.default_rng(seed)
    wanted = replace(judge.aim, tips=judge.tips([points])[0])
    judge = replace(judge, aim=wanted)
    x, y = np.stack([points.x, points.y]) + rng.normal(0, 0.3, (2, len(points)))
    start = judged(judge, FeaturePoints(x, y, points.type))
    best, settled, _ = descended(judge, start, DescentLimits(150, 1e9, 0.05))
    assert settled
    assert best.loss <= 0.05 < 1e-3 * start.loss
