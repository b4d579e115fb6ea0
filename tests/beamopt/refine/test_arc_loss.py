"""The loss of an arc, against the three rooms that it stands for."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beamopt.base.arrays import FloatArray
from beamopt.refine.arc_loss import ArcAim, arc_loss
from beamopt.rod.arc import arc_tip_directions, arc_tips
from beamopt.rod.response import linear_response
from beamopt.section.moments import Moments
from beamopt.target.aim import Aim
from tests.beamopt.refine.cases import judge_of, random_points

LENGTH, YOUNG = 100.0, 300.0


def raw_of(seed: int) -> FloatArray:
    return np.array(judge_of().measured([random_points(seed)]).moments.raw[0])


def aim_of(seed: int, turns: bool, count: int = 9) -> Aim:
    rng = np.random.default_rng(seed)
    ways = rng.normal(size=(count, 3))
    return Aim(
        rng.uniform(0, 100, (count, 3)),
        rng.normal(0, 60, (count, 3)),
        rng.uniform(0, 3, count),
        ways / np.linalg.norm(ways, axis=1, keepdims=True),
        rng.uniform(0, 500, count) if turns else np.zeros(count),
    )


def arc_aim(aim: Aim, curvature: FloatArray) -> ArcAim:
    tips, ways = (aim.tips, aim.weights), (aim.directions, aim.direction_weights)
    return ArcAim(LENGTH, YOUNG, curvature, aim.pressures, *tips, *ways, aim.turns)


def expected(raw: FloatArray, aim: Aim, curvature: FloatArray) -> float:
    strains = linear_response(Moments(raw), YOUNG).strains(aim.pressures)
    strains = strains + np.append(0.0, curvature)
    return float(aim.loss(arc_tips(strains, LENGTH), arc_tip_directions(strains, LENGTH)))


@given(st.integers(0, 10_000), st.booleans(), st.sampled_from([0.0, 1e-9, 0.004, 0.05]))
def test_as_the_rooms_that_it_stands_for(seed: int, turns: bool, rest: float) -> None:
    raw, aim = raw_of(seed % 50), aim_of(seed, turns)
    curvature = rest * np.random.default_rng(seed).normal(size=2)
    assert arc_loss(raw, arc_aim(aim, curvature)) == pytest.approx(
        expected(raw, aim, curvature), rel=1e-12
    )


@given(st.integers(0, 10_000), st.floats(0.0, 2.0))
def test_a_sum_that_ends_early_is_above_what_is_enough(seed: int, share: float) -> None:
    raw, aim = raw_of(seed % 50), arc_aim(aim_of(seed, bool(seed % 2)), np.zeros(2))
    loss = arc_loss(raw, aim)
    enough = share * loss
    found = arc_loss(raw, aim, enough)
    if loss <= enough:
        assert found == loss
    else:
        assert enough < found <= loss


@pytest.mark.parametrize("pressure", [0.0, 1e-12, 1e-6, 1e-3, 0.01])
def test_the_straight_limit(pressure: float) -> None:
    raw, plain = raw_of(1), aim_of(1, True)
    ways = plain.directions, plain.direction_weights
    aim = Aim(np.full((9, 3), pressure), plain.tips, plain.weights, *ways)
    loss = arc_loss(raw, arc_aim(aim, np.zeros(2)))
    assert loss == pytest.approx(expected(raw, aim, np.zeros(2)), rel=1e-12)


def test_at_no_pressure_the_tip_is_at_the_rods_length() -> None:
    nowhere = np.zeros((1, 3)), np.zeros(1)
    aim = Aim(np.zeros((1, 3)), np.array([[0.0, 0.0, 97.0]]), np.ones(1), *nowhere)
    assert arc_loss(raw_of(1), arc_aim(aim, np.zeros(2))) == pytest.approx(9.0, rel=1e-12)


def no_material(raw: FloatArray) -> None:
    raw[0] = 0


def no_width(raw: FloatArray) -> None:
    raw[0, 3:] = 0


def less_than_nothing(raw: FloatArray) -> None:
    raw[0, 0] = -1.0


def not_a_number(raw: FloatArray) -> None:
    raw[0] = np.nan


@pytest.mark.parametrize("spoil", [no_material, no_width, less_than_nothing, not_a_number])
def test_infinite_where_there_is_nothing_to_bend(spoil: Callable[[FloatArray], None]) -> None:
    raw = raw_of(1)
    spoil(raw)
    assert arc_loss(raw, arc_aim(aim_of(1, False), np.zeros(2))) == np.inf
