"""The least loss over all response matrices."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beamopt.bound.fit import ArcFit
from beamopt.bound.response import arc_strains, response_bound
from beamopt.bound.wanted import Wanted
from beamopt.rod.arc import arc_tips
from tests.beamopt.bound.cases import LENGTH, PRESSURES, bowl, random_response, wanted


@pytest.mark.parametrize("seed", range(6))
def test_the_workspace_of_a_section_has_no_bound_and_gives_its_response_back(seed: int) -> None:
    response = random_response(seed)
    found = response_bound(wanted(response))
    assert found.loss < 1e-12 * 27 * LENGTH**2 * 1e-6
    np.testing.assert_allclose(found.matrix, response, rtol=1e-9, atol=1e-14)
    assert found.agreeing >= 6


def test_rows_weights_and_a_rest_shape_of_any_kind() -> None:
    rng = np.random.default_rng(4)
    pressures = rng.uniform(-30, 80, (11, 3))
    weights = rng.uniform(0.1, 3.0, 11)
    response = random_response(3)
    asked = wanted(response, pressures=pressures, weights=weights, rest=(0.008, -0.004))
    found = response_bound(asked)
    assert found.loss < 1e-18
    np.testing.assert_allclose(found.matrix, response, rtol=1e-8, atol=1e-13)


def test_fewer_rows_than_unknowns_are_met_exactly() -> None:
    asked = wanted(random_response(1), 5.0, pressures=PRESSURES[[1, 9]])
    assert response_bound(asked).loss < 1e-18


@given(st.integers(0, 10_000), st.floats(-np.pi, np.pi), st.floats(0.2, 6.0))
def test_turns_leave_the_bound_and_lengths_square_it(seed: int, turn: float, scale: float) -> None:
    asked = wanted(random_response(seed % 5), 4.0, seed)
    least = response_bound(asked).loss
    c, s = np.cos(turn), np.sin(turn)
    turned = replace(asked, tips=asked.tips @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]))
    assert response_bound(turned).loss == pytest.approx(least, rel=1e-7)
    larger = replace(asked, tips=scale * asked.tips, length=scale * LENGTH)
    assert response_bound(larger).loss == pytest.approx(scale**2 * least, rel=1e-7)
    other = replace(asked, pressures=scale * asked.pressures, weights=2 * asked.weights)
    assert response_bound(other).loss == pytest.approx(2 * least, rel=1e-7)


@pytest.mark.parametrize("asked", [bowl(), wanted(random_response(2), 6.0)])
def test_no_response_nearby_or_anywhere_tried_is_lower(asked: Wanted) -> None:
    found = response_bound(asked)
    assert found.loss > 1.0
    assert found.loss == pytest.approx(asked.loss_of(found.matrix), rel=1e-12)
    assert found.loss == pytest.approx((found.distances**2).sum(), rel=1e-12)
    assert found.loss == found.starts.min()
    rng = np.random.default_rng(0)
    for size in (1e-4, 1e-2, 1.0):
        for _ in range(60):
            changed = found.matrix + size * rng.standard_normal((3, 3)) * [[1e-3], [1e-4], [1e-4]]
            assert asked.loss_of(changed) >= found.loss


def test_the_same_question_has_the_same_answer() -> None:
    asked = wanted(random_response(2), 6.0)
    first, second = response_bound(asked), response_bound(asked)
    assert first.loss == second.loss
    np.testing.assert_array_equal(first.starts, second.starts)


def test_strains_of_a_tip() -> None:
    rng = np.random.default_rng(1)
    angle, around = rng.uniform(0, 1.8 * np.pi, 50), rng.uniform(-np.pi, np.pi, 50)
    strains = np.column_stack(
        [rng.uniform(-0.3, 1.0, 50), angle * np.cos(around), angle * np.sin(around)]
    )
    np.testing.assert_allclose(arc_strains(arc_tips(strains, 1.0)), strains, atol=1e-9)
    np.testing.assert_allclose(arc_strains(np.array([0.0, 0.0, 1.2])), [0.2, 0, 0], atol=1e-15)


def test_a_step_that_leads_nowhere_finite_is_not_taken() -> None:
    fit = ArcFit(np.ones((1, 1)), np.array([[0.0, 0.0, 1e150]]), np.ones(1), np.zeros(2))
    found, losses = fit.solve(np.zeros((1, 3, 1)))
    assert np.isfinite(found).all()
    assert losses[0] <= fit.loss(np.zeros((1, 3, 1)))[0]


@pytest.mark.parametrize(
    "change",
    [
        {"pressures": PRESSURES[:5]},
        {"weights": -np.ones(27)},
        {"weights": np.zeros(27)},
        {"tips": np.full((27, 3), np.nan)},
        {"length": 0.0},
    ],
)
def test_nonsense_is_refused(change: dict[str, object]) -> None:
    with pytest.raises(ValueError, match="weights"):
        replace(bowl(), **change)  # type: ignore[arg-type]
