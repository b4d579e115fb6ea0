"""Derivatives of tips by moments, against differences."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beamopt.base.arrays import FloatArray
from beamopt.judge.answers import Answers
from beamopt.judge.judge import Judge
from beamopt.refine import sensitivity
from beamopt.refine.sensitivity import (
    COUNTED,
    moment_sizes,
    residual_of,
    residual_slopes,
    response_slopes,
)
from beamopt.refine.truth import Judged, answers_to
from beamopt.rod.ladder import SectionValues
from beamopt.rod.response import linear_response
from beamopt.section.moments import Moments
from tests.beamopt.refine.cases import judge_of, judged, random_points

LOADED = ("section.feature_points=25", "grid.radial=32", "grid.angular=90")


def stiff(seed: int) -> Moments:
    return Moments(judge_of().measured([random_points(seed)]).moments.raw[0])


def at(judge: Judge, here: Judged, raw: FloatArray) -> FloatArray:
    """The residual of a section with other moments."""
    section = replace(here.section, moments=Moments(raw))
    return residual_of(here.aim, answers_to(judge, here.aim, section))


def by_central_differences(judge: Judge, here: Judged, share: float) -> FloatArray:
    raw, parts = here.section.moments.raw, []
    sizes = moment_sizes(judge.grid, here.section.moments)
    for kind in range(4):
        for m in range(6):
            step = np.zeros((4, 6))
            step[kind, m] = share * sizes[m]
            ahead, behind = at(judge, here, raw + step), at(judge, here, raw - step)
            parts.append((ahead - behind) / (2 * step[kind, m]))
    return np.stack(parts, axis=1).reshape(-1, 4, 6)


def assert_close(found: FloatArray, expected: FloatArray, sizes: FloatArray, share: float) -> None:
    """To a share of the largest change of the residual by any moment's size."""
    unit = np.abs(expected * sizes).max()
    np.testing.assert_allclose(found * sizes / unit, expected * sizes / unit, atol=share)


@given(st.integers(0, 60))
def test_response_slopes(seed: int) -> None:
    moments = stiff(seed)
    slopes = response_slopes(moments, 300.0)
    sizes = np.abs(moments.raw).max(axis=0)
    for kind in range(4):
        for m in range(6):
            step = np.zeros((4, 6))
            step[kind, m] = 1e-6 * sizes[m]
            ahead, behind = (
                linear_response(Moments(moments.raw + s * step), 300.0).matrix for s in (1, -1)
            )
            expected = (ahead - behind) / 2e-6
            found = slopes[:, :, kind, m] * sizes[m]
            unit = np.abs(linear_response(moments, 300.0).matrix).max(axis=1, keepdims=True)
            np.testing.assert_allclose(found / unit, expected / unit, rtol=1e-6, atol=2e-6)


def test_a_rod_looks_at_no_other_moments() -> None:
    """Second moments of the supplies say nothing: their slopes are left out in differences."""
    slopes = response_slopes(stiff(1), 300.0)
    counted = {(kind, m) for kind in range(4) for m in range(6) if slopes[:, :, kind, m].any()}
    assert counted == set(COUNTED)


@pytest.mark.parametrize("name", ["random-section", "pairs", "spiral", "hand-drawn-workspace"])
@pytest.mark.parametrize("seed", range(3))
def test_residual_slopes_of_arcs(name: str, seed: int) -> None:
    judge = judge_of(name)
    here = judged(judge, random_points(seed))
    found = residual_slopes(judge, here)
    sizes = moment_sizes(judge.grid, here.section.moments)
    assert_close(found, by_central_differences(judge, here, 1e-5), sizes, 1e-6)


def test_residual_slopes_of_a_bent_arc() -> None:
    """Its curvature at rest is not from pressure; pairs also count directions."""
    plain = judge_of("pairs")
    judge = replace(plain, rod=replace(plain.rod, curvature=np.array([0.004, -0.002, 0.0])))
    here = judged(judge, random_points(4))
    assert here.aim.turns
    sizes = moment_sizes(judge.grid, here.section.moments)
    expected = by_central_differences(judge, here, 1e-5)
    assert_close(residual_slopes(judge, here), expected, sizes, 1e-6)


@pytest.mark.parametrize("seed", range(3))
def test_paths_need_no_slopes_of_their_pressures(seed: int) -> None:
    """The gradient of L, whose pressures are found anew at each section, is 2 rᵀ ∂r."""
    judge = judge_of("spiral")
    here = judged(judge, random_points(seed))
    assert judge.aim.has_paths
    assert not here.aim.has_paths
    residual = residual_of(here.aim, here.answers)
    gradient = 2 * np.einsum("r,rtm->tm", residual, residual_slopes(judge, here))
    raw, sizes = here.section.moments.raw, moment_sizes(judge.grid, here.section.moments)
    direction = np.random.default_rng(seed).normal(size=(4, 6)) * sizes
    ahead, behind = (
        judge.loss_of(SectionValues(Moments(raw + s * direction))) for s in (1e-5, -1e-5)
    )
    # pressures are found to about 10⁻⁶ of themselves, which L feels squared
    assert (gradient * direction).sum() == pytest.approx((ahead - behind) / 2e-5, rel=1e-4)


@pytest.mark.parametrize("name", ["random-section", "pairs", "spiral"])
def test_the_residuals_square_is_the_loss(name: str) -> None:
    judge = judge_of(name)
    for seed in range(3):
        here = judged(judge, random_points(seed))
        residual = residual_of(here.aim, here.answers)
        assert residual @ residual == pytest.approx(here.verdict.L, rel=1e-9)


def test_slopes_of_a_loaded_rod() -> None:
    """By differences to one side, against those to both."""
    judge = judge_of("gravity", *LOADED)
    here = judged(judge, random_points(8))
    found = residual_slopes(judge, here)
    sizes = moment_sizes(judge.grid, here.section.moments)
    expected = by_central_differences(judge, here, 1e-4)
    assert_close(found, expected, sizes, 2e-3)
    assert np.abs(found).max() > 0


@pytest.mark.parametrize("bad", ["ahead", "both"])
def test_a_rod_at_the_edge_of_equilibrium(bad: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without tips to one side of a moment the other is taken; without any, nothing is known."""
    judge = judge_of("gravity", *LOADED)
    here = judged(judge, random_points(8))
    plain, calls = residual_slopes(judge, here), list[int]()

    def answers(*given: object) -> Answers:
        calls.append(1)
        found = answers_to(*given)  # type: ignore[arg-type]
        lost = bad == "both" or len(calls) % 2
        return replace(found, tips=np.full_like(found.tips, np.nan)) if lost else found

    monkeypatch.setattr(sensitivity, "answers_to", answers)
    slopes = residual_slopes(judge, here)
    assert len(calls) == 2 * len(COUNTED)
    if bad == "both":
        assert not slopes.any()
    else:
        sizes = moment_sizes(judge.grid, here.section.moments)
        assert_close(slopes, plain, sizes, 2e-3)


def test_sizes_are_never_zero() -> None:
    """A plain ring has no first moments, and one without chambers no others to compare."""
    grid = judge_of().grid
    sizes = moment_sizes(grid, Moments(np.zeros((4, 6))))
    np.testing.assert_allclose(sizes / grid.area / 1e-3, [1, 25, 25, 625, 625, 625])
    moments = stiff(0)
    np.testing.assert_array_equal(moment_sizes(grid, moments)[3], moments.raw[:, 3].max())
