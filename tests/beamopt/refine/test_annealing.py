"""Annealing on a model, judged on the true section."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beamopt.base.arrays import FloatArray, LabelArray
from beamopt.judge.judge import Judge
from beamopt.refine import annealing
from beamopt.refine.annealing import Cooling, anneal
from beamopt.refine.arc_loss import arc_loss
from beamopt.refine.fragments import Fragments
from beamopt.refine.orbits import orbits_of
from beamopt.refine.truth import Judged, View, judged_on
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.symmetry import mirror_symmetry
from tests.beamopt.refine.cases import judge_of, judged, random_points

SCHEDULE = Cooling(400, 8, 300.0, 3.0)


class Spy:
    """The truth, with a list of all that it was asked."""

    def __init__(self, judge: Judge) -> None:
        self.truth, self.seen = judged_on(judge, View.RASTER), list[Judged]()

    def __call__(self, points: FeaturePoints) -> Judged:
        self.seen.append(self.truth(points))
        return self.seen[-1]


def annealed(
    judge: Judge, points: FeaturePoints, schedule: Cooling = SCHEDULE, seed: int = 0
) -> tuple[Judged, Judged, Spy]:
    """The start, what comes out, and what was judged for it."""
    spy, start = Spy(judge), judged(judge, points)
    rng = np.random.default_rng(seed)
    best, count = anneal(judge, spy, start, orbits_of(len(points), None), schedule, rng)
    assert count == len(spy.seen) <= schedule.walks
    return start, best, spy


@given(st.integers(0, 10**9), st.integers(1, 10**6))
def test_all_flips_are_shared_out(flips: int, walks: int) -> None:
    schedule = Cooling(flips, walks, 10.0, 1.0)
    few = Cooling(flips % 1000, 1 + walks % 50, 10.0, 1.0)
    assert sum(map(few.flips_of, range(few.walks))) == few.flips
    assert abs(schedule.flips_of(walks // 2) - flips / walks) < 1


def test_no_flip_is_lost_in_rounding(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ten flips in four chains are ten draws, and three in fifty are three."""
    drawn = list[int]()
    monkeypatch.setattr(annealing, "walk", lambda *given: float(drawn.append(len(given[-1])) or 0))
    for flips, walks in ((10, 4), (3, 50)):
        drawn.clear()
        annealed(judge_of(), random_points(0), Cooling(flips, walks, 10.0, 1.0))
        assert sum(drawn) == flips
        assert len(drawn) <= walks


def test_it_cools_geometrically() -> None:
    schedule = Cooling(100, 5, 160.0, 10.0)
    np.testing.assert_allclose(list(map(schedule.temperature, range(5))), [160, 80, 40, 20, 10])
    assert Cooling(100, 1, 160.0, 10.0).temperature(0) == 160


@pytest.mark.parametrize("name", ["random-section", "pairs", "sealed-section"])
def test_what_comes_out_was_judged(name: str) -> None:
    judge = judge_of(name)
    start, best, spy = annealed(judge, random_points(1))
    assert any(best is one for one in spy.seen)
    assert best.verdict == judge([best.points])[0]
    assert best.verdict.T < start.verdict.T


def test_on_an_exact_model_every_chain_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    judge, said = judge_of(), list[float]()

    def spied(*given: object) -> float:
        said.append(walk(*given))  # type: ignore[arg-type]
        return said[-1]

    walk = annealing.walk
    monkeypatch.setattr(annealing, "walk", spied)
    _, best, spy = annealed(judge, random_points(2), Cooling(400, 8, 1e4, 1e4))
    assert len(said) == len(spy.seen) == 8
    np.testing.assert_allclose(said, [one.verdict.T for one in spy.seen], rtol=1e-9)
    assert min(one.verdict.T for one in spy.seen) == best.verdict.T


@pytest.mark.parametrize("seed", range(3))
def test_a_wrong_model_is_found_out(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Garbage in the moments: chains go astray, what is kept has the T that was judged."""
    judge, left_out = judge_of(), annealing._left_out

    def wrong(fragments: Fragments, of: Judged) -> FloatArray:
        noise = np.random.default_rng(seed).normal(0, 0.05, (4, 6))
        return left_out(fragments, of) + noise * np.abs(of.section.moments.raw).max(axis=0)

    monkeypatch.setattr(annealing, "_left_out", wrong)
    start, best, spy = annealed(judge, random_points(seed), seed=seed)
    assert any(best is one for one in [*spy.seen, start])
    assert best.verdict == judge([best.points])[0]


def scripted(
    monkeypatch: pytest.MonkeyPatch, ends: list[LabelArray], said: Callable[[int], float]
) -> list[LabelArray]:
    """Chains that end in given types with a T of one's choice; where each began is returned."""
    began = list[LabelArray]()

    def walk(types: LabelArray, *_: object) -> float:
        began.append(types.copy())
        types[:] = ends[len(began) - 1]
        return said(len(began) - 1)

    monkeypatch.setattr(annealing, "walk", walk)
    return began


def two_sections(judge: Judge) -> tuple[FeaturePoints, FeaturePoints]:
    """The same places with types of a low and of a high T."""
    one, other = random_points(0), random_points(0).with_types(random_points(1).type)
    low, high = sorted((one, other), key=lambda points: judge([points])[0].T)
    return low, high


def test_what_is_truly_better_is_taken_whatever_the_model_said(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    judge = judge_of()
    low, high = two_sections(judge)
    began = scripted(monkeypatch, [low.type, high.type], lambda chain: 0.0)
    _, best, _ = annealed(judge, high, Cooling(2, 2, 1e-9, 1e-9))
    np.testing.assert_array_equal(best.points.type, low.type)
    np.testing.assert_array_equal(began[1], low.type)


def test_a_rise_that_the_model_did_not_see_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    judge = judge_of()
    low, high = two_sections(judge)
    began = scripted(monkeypatch, [high.type, high.type], lambda chain: judge([low])[0].T)
    start, best, _ = annealed(judge, low, Cooling(2, 2, 1e-3, 1e-3))
    np.testing.assert_array_equal(began[1], low.type)
    assert best is start


def test_a_rise_that_the_model_saw_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    """It has been let pass by the chain already."""
    judge = judge_of()
    low, high = two_sections(judge)
    began = scripted(monkeypatch, [high.type, high.type], lambda chain: judge([high])[0].T + 1e-6)
    _, best, _ = annealed(judge, low, Cooling(2, 2, 1e-3, 1e-3))
    np.testing.assert_array_equal(began[1], high.type)
    np.testing.assert_array_equal(best.points.type, high.type)


def test_what_can_not_be_judged_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    judge, points = judge_of(), random_points(0)
    holes = np.ones(25, dtype=np.uint8)
    began = scripted(monkeypatch, [holes, holes], lambda chain: 0.0)
    start, best, spy = annealed(judge, points, Cooling(2, 2, 1e9, 1e9))
    assert [one.found for one in spy.seen] == [False, False]
    assert best is start
    np.testing.assert_array_equal(began[1], points.type)


def test_without_flips_nothing_is_judged() -> None:
    start, best, spy = annealed(judge_of(), random_points(0), Cooling(0, 5, 10.0, 1.0))
    assert best is start
    assert spy.seen == []


def test_the_same_luck_the_same_section() -> None:
    one, again, other = (annealed(judge_of(), random_points(3), seed=s)[1] for s in (1, 1, 2))
    assert one.points.digest == again.points.digest != other.points.digest


def test_symmetric_sections_stay_so() -> None:
    judge, symmetry = judge_of(), mirror_symmetry()
    points = symmetry.symmetrised(random_points(4))
    start, rng = judged(judge, points), np.random.default_rng(0)
    orbits = orbits_of(len(points), symmetry)
    best, _ = anneal(judge, judged_on(judge, View.RASTER), start, orbits, SCHEDULE, rng)
    assert best.points.digest == symmetry.symmetrised(best.points).digest != points.digest


def test_on_a_higher_rung_the_model_starts_where_the_rod_is() -> None:
    """What the loads add to an arc is taken off the wanted tips, so that L is right at first."""
    judge = judge_of("gravity", "section.feature_points=25", "grid.radial=32", "grid.angular=90")
    start = judged(judge, random_points(8))
    aim = annealing._arc_aim(judge, start)
    raw = start.section.moments.raw
    assert arc_loss(raw, aim) == pytest.approx(start.verdict.L, rel=1e-9)
    assert not np.allclose(aim.tips, judge.aim.tips)
