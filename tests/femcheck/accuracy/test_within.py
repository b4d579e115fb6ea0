"""Answers to an accuracy, of made-up solids whose error is known, and of real rods."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beamopt.base.errors import InputError
from beamopt.scene.named import named_design
from femcheck.accuracy import within
from femcheck.accuracy.ending import Ending, Source, Within
from femcheck.accuracy.knowledge import MATERIAL, ORDERS, RIGID, Level, levels_for, scale_of
from femcheck.accuracy.within import SAFETY, answer_within
from femcheck.chart.lineup import STIFFER
from femcheck.continuation.ended import Ended
from femcheck.continuation.outcome import Status
from femcheck.mesh.gmsh_section import MeshProblem
from femcheck.models.beam import RodOnOutline
from femcheck.models.question import Question
from femcheck.models.solid import SolidModel
from femcheck.prediction.options import PredictionOptions
from tests.femcheck import made_up
from tests.femcheck.check.small import design_of, three_circles
from tests.femcheck.made_up import AT, NEO, MadeUp, Off, of_penalty, powers, question_of

LAYERS = {RIGID: (2, 3, 4, 6, 8, 12, 16), MATERIAL: (3, 4, 6, 8, 12, 16, 24)}
LAWS = {RIGID: made_up.RIGID, MATERIAL: NEO}
WIDEST = 1.5  # of the ratios between neighbouring levels
ROUNDING = 1e-9
USUAL = SolidModel().penalties


def levels(question: Question) -> tuple[Level, ...]:
    """Charts that promised the error of theory, C = 1 mm a scale."""
    kind = RIGID if question.is_of_the_beam else MATERIAL
    return tuple(Level(SolidModel(layers=n), n ** -ORDERS[kind], 10.0 * n) for n in LAYERS[kind])


@pytest.fixture(autouse=True, scope="module")
def taught() -> Iterator[None]:
    """By charts whose numbers stand here."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(within, "levels_for", levels)
        patch.setattr(within, "scale_of", lambda question: 1.0)
        yield


def answered(
    off: Off, accuracy: float, kind: str = MATERIAL, *, made: MadeUp | None = None, **changes: Any
) -> tuple[Within, MadeUp]:
    solids = MadeUp(off) if made is None else made
    with solids.instead():
        found = answer_within(question_of(LAWS[kind]), accuracy, rung=_rung(kind), **changes)
    return found, solids


def refined(made: MadeUp) -> list[int]:
    """Layers of what was asked, without the finer triangles that the first is held against."""
    return [model.layers for model in made.asked if model.size == SolidModel().size]


def _rung(kind: str) -> Any:
    return "solid" if kind == RIGID else "auto"


def error(found: Within) -> float:
    assert found.reply is not None
    return float(found.reply.away(made_up.DESIGN.tips(AT)).max())


def least_order(kind: str, ratio: float = WIDEST) -> float:
    """Below it `SAFETY` does not make up for an order lower than that of theory.

    Of C N⁻ᵖ the change between N and rN tells SAFETY (rᵖ − 1)/(r^q − 1) times the error left.
    """
    return float(np.log(1 + (ratio ** ORDERS[kind] - 1) / SAFETY) / np.log(ratio))


kinds = st.sampled_from([RIGID, MATERIAL])


def test_the_least_orders_that_estimates_cover() -> None:
    assert least_order(RIGID) == pytest.approx(2.735, abs=1e-3)
    assert least_order(MATERIAL) == pytest.approx(1.198, abs=1e-3)
    ratios = [b / a for layers in LAYERS.values() for a, b in pairwise(layers)]
    assert max(ratios) == WIDEST


@given(kinds, st.floats(0.001, 0.999), st.floats(0.01, 100.0), st.floats(1e-4, 1.0))
def test_the_estimate_is_no_less_than_the_error(
    kind: str, share: float, constant: float, accuracy: float
) -> None:
    """For orders from theory down to the least one; what is called reached is reached."""
    order = least_order(kind) + share * (ORDERS[kind] - least_order(kind))
    found, _ = answered(powers(constant, order), accuracy, kind)
    assert error(found) <= found.worst + ROUNDING
    if found.ending is Ending.REACHED:
        assert error(found) <= accuracy
    else:
        assert found.ending is Ending.NOT_REACHED
        assert found.worst > accuracy


@pytest.mark.parametrize(("kind", "coarse", "fine"), [(RIGID, 2, 3), (MATERIAL, 4, 6)])
def test_below_the_least_order_the_estimate_is_too_small(kind: str, coarse: int, fine: int) -> None:
    """The bound is what it is said to be: nothing promises orders that no element here has."""
    sides = []
    for order in (least_order(kind) - 0.02, least_order(kind) + 0.02):
        found, solids = answered(powers(1.0, order), 1e3, kind)
        assert [model.layers for model in solids.asked][-1] == fine
        assert coarse in [model.layers for model in solids.asked]
        sides.append(found.worst > error(found))
    assert sides == [False, True]


@given(st.floats(0.5, 20.0), st.sampled_from([(4, 6), (6, 8), (8, 12)]), st.floats(0.1, 1.0))
def test_a_change_that_vanishes_by_chance_does_not_fool(
    constant: float, pair: tuple[int, int], share: float
) -> None:
    """Errors of two orders and signs that are alike at two neighbouring levels."""
    few, many = pair
    against = (few**-2 - many**-2) / (few**-4 - many**-4)

    def off(model: SolidModel) -> float:
        n = model.layers
        return float(constant * (n**-2 - against * n**-4))

    accuracy = share * abs(off(SolidModel(layers=many)))
    assert off(SolidModel(layers=few)) == pytest.approx(off(SolidModel(layers=many)))
    found, _ = answered(off, accuracy)
    assert found.ending is not Ending.REACHED or error(found) <= accuracy


@given(st.floats(0.1, 20.0), st.floats(-1e3, 1e3), st.floats(1e-4, 1.0))
def test_how_far_errors_of_two_orders_can_fool(
    constant: float, against: float, accuracy: float
) -> None:
    """Of a material: a quarter, where neither of two changes shows how large the error is."""

    def off(model: SolidModel) -> float:
        n = model.layers
        return float(constant * (n**-2 + against * n**-4))

    found, _ = answered(off, accuracy)
    assert error(found) <= 1.26 * found.worst + ROUNDING


@given(kinds, st.floats(0.5, 20.0), st.floats(1e-3, 1.0), st.integers(0, 99))
def test_every_combination_counts(kind: str, constant: float, accuracy: float, seed: int) -> None:
    """In any direction, and of any size, none too."""
    random = np.random.default_rng(seed)
    shares = random.standard_normal((3, 3)) * np.array([[1.0], [0.01], [0.0]])
    random.shuffle(shares)
    made = MadeUp(powers(constant, ORDERS[kind]), shares)
    found, _ = answered(made.off, accuracy, kind, made=made)
    assert found.reply is not None
    away = found.reply.away(made_up.DESIGN.tips(AT))
    assert (away <= found.estimate + ROUNDING).all()
    assert (found.ending is Ending.REACHED) == (found.estimate <= accuracy).all()


def test_it_begins_below_what_charts_promise_and_stops_when_told() -> None:
    """And asks nothing finer than it needs; of a material three levels, of the beam's law two."""
    found, solids = answered(powers(1.0, 2), 0.05)
    assert refined(solids) == [4, 6, 8]
    assert [model.layers for model in solids.asked if model.size < 1] == [4]
    assert found.ending is Ending.REACHED
    assert found.chosen == "wedge18 8 layers, size 2"
    assert found.worst == pytest.approx(2 / 64)
    assert found.seconds == 22.0
    assert [one.seconds for one in found.tried] == [4.0, 4.0, 6.0, 8.0]
    assert "charts promise 0.016 mm of wedge18 8 layers" in found.reason
    found, solids = answered(powers(1.0, 4), 0.05, RIGID)
    assert refined(solids) == [2, 2, 3]
    assert found.worst == pytest.approx(2 / 81)


def test_it_goes_on_where_charts_promised_too_much() -> None:
    found, solids = answered(powers(10.0, 2), 0.5)
    assert refined(solids) == [3, 4, 6, 8]
    assert found.ending is Ending.REACHED
    assert error(found) == pytest.approx(10 / 64)


@pytest.mark.parametrize("kind", [RIGID, MATERIAL])
def test_what_can_not_be_reached_is_said(kind: str) -> None:
    found, solids = answered(powers(1e4, ORDERS[kind]), 1e-3, kind)
    assert found.ending is Ending.NOT_REACHED
    assert found.worst > 1e-3
    assert solids.asked[-1].layers == LAYERS[kind][-1]
    assert found.reply is not None


def test_what_is_too_dear_is_said() -> None:
    """With the tips that there are; the costs are those of the solids asked here."""
    made = MadeUp(powers(10.0, 2), seconds=lambda model: float(model.layers) ** 2)
    found, _ = answered(made.off, 0.05, made=made, most_seconds=70.0)
    assert found.ending is Ending.TOO_DEAR
    assert refined(made) == [4, 6, 8]
    assert found.worst == pytest.approx(20 / 64)
    assert found.reply is not None


def test_nothing_is_too_dear_unless_a_budget_is_given() -> None:
    slow = MadeUp(powers(10.0, 2), seconds=lambda model: 1e7 * model.layers**3)
    found, _ = answered(slow.off, 0.05, made=slow)
    quick = MadeUp(powers(10.0, 2))
    same, _ = answered(quick.off, 0.05, made=quick)
    assert slow.asked == quick.asked
    assert (found.ending, found.worst) == (same.ending, same.worst)
    assert found.ending is not Ending.TOO_DEAR


def test_too_dear_before_there_is_an_estimate() -> None:
    """A level that only serves to compare is no excuse for what the next one takes."""
    made = MadeUp(powers(10.0, 2), seconds=lambda model: 1000.0)
    found, _ = answered(made.off, 0.05, made=made, most_seconds=70.0)
    assert found.ending is Ending.TOO_DEAR
    assert refined(made) == [4]
    assert np.isnan(found.estimate).all()
    assert np.isnan(found.worst)
    assert found.chosen == "wedge18 4 layers, size 2"


def test_no_tip_at_all() -> None:
    made = MadeUp(powers(1.0, 2), missing=lambda model: range(3))
    for kind in (RIGID, MATERIAL):
        found, _ = answered(made.off, 0.05, kind, made=made)
        assert found.ending is Ending.NO_TIP
        assert found.reason.endswith("limit point at P = 3 kPa")
        assert np.isnan(found.estimate).all()


def test_a_tip_that_no_model_has_is_not_asked_for() -> None:
    """The others reach the accuracy."""
    for kind in (RIGID, MATERIAL):
        made = MadeUp(powers(1.0, ORDERS[kind]), missing=lambda model: [1])
        found, _ = answered(made.off, 0.05, kind, made=made)
        assert found.ending is Ending.REACHED
        assert np.isnan(found.estimate).tolist() == [False, True, False]


@pytest.mark.parametrize("layers", [3, 4, 6, 8])
def test_a_tip_that_one_model_lacks_is_not_sure(layers: int) -> None:
    """Where it has no estimate from enough levels the accuracy is not reached there."""
    made = MadeUp(powers(1.0, 2), missing=lambda model: [1] if model.layers == layers else [])
    found, _ = answered(made.off, 0.15, made=made)
    if found.ending is Ending.REACHED:
        assert found.estimate.max() <= 0.15
        assert found.reply is not None
        assert found.reply.is_whole
    assert refined(made)[:3] == [3, 4, 6]
    assert (len(refined(made)) > 3) == (layers < 8)


@pytest.mark.parametrize("rows", [range(3), [1]], ids=["all", "one"])
def test_what_could_not_be_computed_is_not_reached(rows: list[int]) -> None:
    """No mesh and no time say nothing of the actuator, other than a limit point."""
    for ended in (Ended(MeshProblem.CRASHED), Ended(Status.TIME_OUT, 3.0)):
        made = MadeUp(powers(1.0, 2), missing=lambda model: rows, ended=ended)
        found, _ = answered(made.off, 0.05, made=made)
        assert found.ending is Ending.NOT_REACHED
        assert np.isnan(found.estimate[1])


@given(st.floats(0.0, 2.0), st.floats(1.0, 4.0), st.floats(1e-3, 1.0), kinds)
def test_triangles_do_not_fool(constant: float, order: float, accuracy: float, kind: str) -> None:
    """Their error is the same in all levels, and no change between those shows it."""

    def off(model: SolidModel) -> float:
        return powers(0.1, ORDERS[kind])(model) + constant * (model.size / 2.0) ** order

    found, _ = answered(off, accuracy, kind)
    assert error(found) <= found.worst + ROUNDING
    assert found.ending is not Ending.REACHED or error(found) <= accuracy


def test_what_penalties_leave_is_added() -> None:
    """Small: it is the change that stiffer ones make. Large: the stiffer ones are taken."""
    small = 0.01

    def off(model: SolidModel) -> float:
        return powers(1.0, 4)(model) + of_penalty(small)(model)

    found, solids = answered(off, 0.2, RIGID)
    assert [m.penalties for m in solids.asked if m.size == 2] == [USUAL, STIFFER, USUAL]
    of_layers = 2 * 3.0**-4
    assert found.worst == pytest.approx(of_layers + 1.5 * small * 15 / 16)
    assert error(found) <= found.worst

    def far(model: SolidModel) -> float:
        return powers(1.0, 4)(model) + of_penalty(0.1)(model)

    found, solids = answered(far, 0.2, RIGID)
    assert [m.penalties for m in solids.asked if m.size == 2] == [USUAL, STIFFER, STIFFER]
    assert found.worst == pytest.approx(of_layers + 0.1 * 15 / 16 / 8)
    assert error(found) == pytest.approx(3.0**-4 + 0.1 / 16)
    assert found.chosen.endswith("c to 40000")


@given(st.floats(0.0, 5.0), st.floats(0.1, 5.0), st.floats(1e-3, 1.0))
def test_penalties_do_not_fool(left: float, constant: float, accuracy: float) -> None:
    """Of the same sign as the layers' error."""

    def off(model: SolidModel) -> float:
        return powers(constant, 4)(model) + of_penalty(left)(model)

    found, _ = answered(off, accuracy, RIGID)
    assert error(found) <= found.worst + ROUNDING
    assert found.ending is not Ending.REACHED or error(found) <= accuracy


def test_a_material_has_no_penalties() -> None:
    _, solids = answered(powers(1.0, 2), 0.05)
    assert {model.penalties for model in solids.asked} == {SolidModel().penalties}


def test_the_beams_own_law_is_a_closed_form() -> None:
    found = answer_within(question_of(made_up.RIGID), 1e-9)
    assert found.ending is Ending.REACHED
    assert found.chosen == "beam"
    assert (found.source, found.compared_with) == (Source.CLOSED_FORM, ())
    assert np.isnan(found.estimate).all()
    assert len(found.tried) == 1


def test_what_was_compared_with_what() -> None:
    """A rod under loads with itself less tight, a solid with other solids; without two, nothing."""
    name, design = named_design("gravity")
    rod = answer_within(Question.of(name, design, made_up.RIGID, AT), 0.1)
    assert (rod.source, rod.is_beam) == (Source.TIGHTER, True)
    assert (rod.chosen, rod.compared_with) == ("beam 0.001 mm", ("beam 0.1 mm",))
    solid, made = answered(powers(1.0, 2), 0.05)
    assert (solid.source, solid.is_beam) == (Source.COARSER, False)
    others = {f"wedge18 {model.resolution}" for model in made.asked} - {solid.chosen}
    assert set(solid.compared_with) == others
    assert len(others) >= 3
    dear = MadeUp(powers(10.0, 2), seconds=lambda model: 1000.0)
    found, _ = answered(dear.off, 0.05, made=dear, most_seconds=70.0)
    assert (found.source, found.compared_with) == (Source.NOTHING, ())


@pytest.mark.parametrize("scene", ["gravity", "tool-at-the-tip", "upright-column"])
@pytest.mark.parametrize("accuracy", [1.0, 0.1, 1e-5])
def test_loaded_rods_are_as_near_as_they_say(scene: str, accuracy: float) -> None:
    """Against the tightest rod, which has an error of its own."""
    name, design = named_design(scene)
    question = Question.of(name, design, made_up.RIGID, np.array([[0.0, 20, 30], [30, 0, 0]]))
    found = answer_within(question, accuracy)
    tightest = 1e-9 * design.actuator.length
    reference = RodOnOutline(tightest).reply(question)
    assert found.ending is Ending.REACHED
    assert found.reply is not None
    away = found.reply.away(reference.tips)
    assert (away <= found.estimate + tightest).all()
    assert (found.estimate <= accuracy).all()


def test_a_rod_below_rounding_is_not_promised() -> None:
    """Less than rods are solved to: the closest there is, and the status says so."""
    name, design = named_design("gravity")
    question = Question.of(name, design, made_up.RIGID, np.array([[50.0, 0, 0]]))
    for accuracy in (1e-8, 1e-12):
        found = answer_within(question, accuracy)
        assert found.ending is Ending.NOT_REACHED
        assert found.worst >= 1e-9 * design.actuator.length
        assert found.worst < 1e-5


def test_a_rod_that_was_solved_too_coarsely_is_solved_again() -> None:
    """The first two of this column are farther apart than was asked; the second was fine."""
    name, design = named_design("upright-column")
    question = Question.of(name, design, made_up.RIGID)
    found = answer_within(question, 0.1)
    assert found.ending is Ending.REACHED
    assert len(found.tried) == 3


def test_what_no_model_answers() -> None:
    """Loads under another law, an open section; nothing is asked, nothing fails."""
    touching = [{"supply": 1, "center": [12, 0], "radius": 4}, *three_circles()[1:]]
    seal = {"skin": 0, "wall": 0, "rounding": 0, "smallest_chamber": 0}
    opened = Question.of("open", design_of(touching, seal=seal), NEO)
    loaded = Question.of(*named_design("gravity"), NEO)
    for question, word in ((opened, "not sealed"), (loaded, "has loads")):
        found = answer_within(question, 0.1)
        assert found.ending is Ending.NO_MODEL
        assert word in found.reason
        assert found.reply is None
        assert found.chosen == "none"
        assert found.tried == ()
        assert found.seconds == 0


@pytest.mark.parametrize("accuracy", [0.0, -1.0, np.nan, np.inf])
def test_an_accuracy_is_above_zero(accuracy: float) -> None:
    with pytest.raises(InputError, match="above 0 mm"):
        answer_within(question_of(), accuracy)


def test_a_beam_has_no_material() -> None:
    with pytest.raises(InputError, match="a beam has no gent"):
        answer_within(question_of(PredictionOptions(law="gent")), 0.1, rung="beam")


def test_progress_says_what_is_asked() -> None:
    seen: list[tuple[int, int, str]] = []
    answered(powers(1.0, 2), 0.05, progress=lambda *said: seen.append(said))
    assert [done for done, _, _ in seen] == [0, 1, 2, 3]
    assert all(done < total for done, total, _ in seen)
    assert seen[0][2] == "wedge18 4 layers, size 2"


def test_one_combination_without_pressure() -> None:
    made = MadeUp(lambda model: 0.0)
    question = question_of(NEO, np.zeros((1, 3)))
    with made.instead():
        found = answer_within(question, 1e-6)
    assert found.ending is Ending.REACHED
    assert found.worst == 0.0
    assert found.reply is not None
    assert all(one.is_found for one in found.reply.endings)


def test_scales_are_of_the_beam() -> None:
    """L θ⁴ in mm, and the displacement in mm; a straight one is not nothing."""
    length = made_up.DESIGN.actuator.length
    rigid, material = question_of(made_up.RIGID), question_of(NEO)
    turned = rigid.subject.largest_turn
    whole = replace(rigid, pressures=rigid.subject.pressures)
    assert scale_of(whole) == pytest.approx(length * turned**4)
    tips = made_up.DESIGN.tips(AT)
    moved = np.linalg.norm(tips - [0, 0, length], axis=1).max()
    assert scale_of(material) == pytest.approx(moved)
    assert scale_of(question_of(NEO, np.zeros((1, 3)))) == 1e-3
    assert scale_of(question_of(made_up.RIGID, np.zeros((1, 3)))) == 1e-3


def test_packaged_levels_get_finer() -> None:
    for kind, law in LAWS.items():
        found = levels_for(question_of(law))
        layers = [level.model.layers for level in found]
        assert layers == sorted(set(layers))
        assert len(layers) >= 4
        assert all(level.error > 0 and level.seconds > 0 for level in found)
        ratios = [b / a for a, b in pairwise(layers)]
        assert max(ratios) <= WIDEST, kind  # what estimates cover goes with it
        assert {level.model.size for level in found} == {2.0}
