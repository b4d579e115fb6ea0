"""What charts measure errors from: limits of made-up families, whose truth is known."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beamopt.base.arrays import FloatArray
from beamopt.scene.named import named_design
from femcheck.chart.lineup import Series
from femcheck.chart.measure import Measured, key_of
from femcheck.chart.reference import Limit, Reference, limits_of, reference_of
from femcheck.models.beam import RodOnOutline
from femcheck.models.question import Question
from femcheck.models.reply import FOUND, Reply
from femcheck.models.solid import SolidModel
from tests.femcheck.made_up import AT, DESIGN, NEO, RIGID, MadeUp, Off, powers, question_of

LAYERS = {"wedge18": (3, 4, 6, 8), "hex27": (2, 3, 4), "tet10": (4, 6, 8, 12)}
THEORY = {"wedge18": 4.0, "hex27": 4.0, "tet10": 2.0}
NEAR = 1e-9


def family(element: str, layers: Sequence[int] | None = None) -> Series:
    found = LAYERS[element] if layers is None else layers
    return Series(element, tuple(SolidModel(element, n) for n in found))


def refined(element: str) -> Series:
    """A family that is refined in its triangles too, which a reference has to be."""
    return replace(family(element), sized=SolidModel(element, 4, 0.5))


def replies(made: MadeUp, question: Question, *series: Series) -> dict[str, Measured]:
    models = [model for one in series for model in one.all if isinstance(model, SolidModel)]
    return {
        key_of(model): Measured(
            model.family, model.resolution, made.reply(model, question), float(model.layers)
        )
        for model in models
    }


def limit_of(series: Series, off: Off, shares: FloatArray | None = None) -> Limit | None:
    question = question_of(NEO)
    measured = replies(MadeUp(off, shares), question, series)
    found = limits_of([series], measured)
    return found[0] if found else None


def truth() -> FloatArray:
    return DESIGN.tips(AT)


def error(limit: Limit) -> FloatArray:
    return np.asarray(np.linalg.norm(limit.tips - truth(), axis=1))


orders = st.floats(1.02, 4.0)
constants = st.floats(-50.0, 50.0).filter(lambda c: abs(c) > 1e-3)


@given(orders, constants, st.sampled_from(["wedge18", "hex27", "tet10"]), st.integers(0, 99))
def test_a_known_order_is_extrapolated_to_its_limit(
    order: float, constant: float, element: str, seed: int
) -> None:
    """Three or more solutions show an order up to the theoretical one, in any direction."""
    order = min(order, THEORY[element])
    shares = np.random.default_rng(seed).standard_normal((3, 3))
    limit = limit_of(family(element), powers(constant, order), shares)
    assert limit is not None
    assert error(limit).max() < 1e-7 * max(1, abs(constant))
    assert (error(limit) <= limit.band + NEAR).all()


@given(
    st.floats(1.001, 7.0),
    constants,
    st.sampled_from(["wedge18", "hex27", "tet10"]),
    st.integers(2, 4),
)
def test_the_band_covers_the_truth(
    order: float, constant: float, element: str, solved: int
) -> None:
    """For orders from the least one to beyond theory; with two solutions the order is not known."""
    series = family(element, LAYERS[element][:solved])
    limit = limit_of(series, powers(constant, order))
    assert limit is not None
    assert (error(limit) <= limit.band + NEAR).all()


def test_an_order_beyond_theory_is_not_believed() -> None:
    """Three that come closer faster than they should narrow no band."""
    limit = limit_of(family("tet10"), powers(5.0, 4))
    assert limit is not None
    change = 5.0 * (8.0**-4 - 12.0**-4)
    np.testing.assert_allclose(limit.band, change / (1.5**2 - 1))


@given(st.floats(0.01, 0.98), constants)
def test_too_low_an_order_gives_no_limit(order: float, constant: float) -> None:
    assert limit_of(family("wedge18"), powers(constant, order)) is None


@pytest.mark.parametrize(
    "off",
    [
        lambda model: 0.1 * model.layers,
        lambda model: 0.1 * (-1) ** (model.layers // 2),
        lambda model: 0.5 / model.layers if model.layers < 8 else -1.0,
        lambda model: float(model.layers == 8),
    ],
    ids=["diverges", "alternates", "jumps", "moves at last"],
)
def test_what_does_not_converge_has_no_limit(off: Off) -> None:
    assert limit_of(family("wedge18"), off) is None


def test_one_solution_is_no_family() -> None:
    assert limit_of(family("wedge18", (4,)), powers(1.0, 4)) is None
    assert limit_of(family("wedge18", ()), powers(1.0, 4)) is None


def test_an_element_that_locks_has_no_limit() -> None:
    assert limit_of(Series("tet4", tuple(SolidModel("tet4", n) for n in (4, 8))), powers(1, 2)) is (
        None
    )


def test_triangles_and_penalties_are_added() -> None:
    """Their changes move the limit, and all of them count in the band."""
    models = family("wedge18").models
    sized = SolidModel("wedge18", 4, 0.5)
    stiffer = SolidModel("wedge18", 4, penalties=(10_000.0, 40_000.0))
    series = Series("wedge18", models, sized, stiffer)

    def off(model: SolidModel) -> float:
        of_size = 0.02 * (model.size == 2.0)
        return powers(5.0, 4)(model) + of_size + 0.03 * (model.penalties[1] == 10_000.0)

    limit, plain = limit_of(series, off), limit_of(family("wedge18"), off)
    assert limit is not None
    assert plain is not None
    assert error(limit).max() < 1e-9
    np.testing.assert_allclose(error(plain), 0.05, atol=1e-9)
    np.testing.assert_allclose(limit.band, plain.band + 0.05, atol=1e-9)


def test_what_was_left_out_is_as_if_it_was_not_asked() -> None:
    """The limit is the same whether a correction is not there, or there without tips."""
    question = question_of(NEO)
    series = replace(family("wedge18"), sized=SolidModel("wedge18", 4, 0.5))
    made = MadeUp(powers(5.0, 4), missing=lambda model: range(3) if model.size < 1 else ())
    measured = replies(made, question, series)
    (with_it,) = limits_of([series], measured)
    measured.pop("wedge18 4 layers, size 0.5")
    (without,) = limits_of([series], measured)
    np.testing.assert_array_equal(with_it.tips, without.tips)
    np.testing.assert_array_equal(with_it.band, without.band)


def test_a_tip_that_coarse_solids_lack_does_not_spoil_the_others() -> None:
    """Orders are of the tips that all three have; the one of the finest two has a limit too."""
    question, series = question_of(NEO), family("wedge18", (4, 6, 8))
    shares = np.array([[1.0, 0, 0], [1.0, 0, 0], [50.0, 0, 0]])
    made = MadeUp(powers(10.0, 3), shares, lambda model: [2] if model.layers == 4 else [])
    (limit,) = limits_of([series], replies(made, question, series))
    assert error(limit).max() < 1e-8
    lacking = MadeUp(powers(10.0, 3), None, lambda model: [2] if model.layers == 8 else [])
    (limit,) = limits_of([series], replies(lacking, question, series))
    assert np.isfinite(limit.band).tolist() == [True, True, False]
    assert np.isfinite(limit.uncertainty)


def test_solids_without_tips_count_for_nothing() -> None:
    question, series = question_of(NEO), family("wedge18", (3, 4, 6, 8))
    made = MadeUp(powers(10.0, 3), None, lambda model: range(3) if model.layers == 3 else ())
    (limit,) = limits_of([series], replies(made, question, series))
    assert error(limit).max() < 1e-8
    none = MadeUp(powers(10.0, 3), None, lambda model: range(3))
    assert limits_of([series], replies(none, question, series)) == []
    assert reference_of(question, [series], replies(none, question, series)) is None


@given(st.floats(1.05, 4.0), st.floats(1.05, 4.0), constants, constants)
def test_two_families_agree_within_their_bands(
    one: float, other: float, first: float, second: float
) -> None:
    question = question_of(NEO)
    prisms, bricks = refined("wedge18"), family("hex27")

    def off(model: SolidModel) -> float:
        return powers(*((first, one) if model.element == "wedge18" else (second, other)))(model)

    measured = replies(MadeUp(off), question, prisms, bricks)
    reference = reference_of(question, [prisms, bricks], measured)
    assert reference is not None
    assert reference.is_confirmed
    assert reference.family == "wedge18"
    assert [limit.family for limit in reference.others] == ["hex27"]


def test_the_reference_was_refined_in_all_respects() -> None:
    """However narrow the band of another family is: its triangles count in no band."""
    question = question_of(NEO)
    prisms, bricks = refined("wedge18"), family("hex27")

    def off(model: SolidModel) -> float:
        return powers(5.0 if model.element == "wedge18" else 0.001, 4)(model)

    measured = replies(MadeUp(off), question, prisms, bricks)
    reference = reference_of(question, [prisms, bricks], measured)
    assert reference is not None
    assert reference.family == "wedge18"
    assert reference.uncertainty > reference.others[0].uncertainty
    lost = MadeUp(off, missing=lambda model: range(3) if model.size < 1 else ())
    assert reference_of(question, [prisms, bricks], replies(lost, question, prisms, bricks)) is None
    measured.pop("wedge18 4 layers, size 0.5")
    assert reference_of(question, [prisms, bricks], measured) is None


def test_families_that_lead_elsewhere_disagree() -> None:
    question = question_of(NEO)
    prisms, bricks = refined("wedge18"), family("hex27")

    def off(model: SolidModel) -> float:
        return powers(5.0, 4)(model) + 1.0 * (model.element == "hex27")

    reference = reference_of(
        question, [prisms, bricks], replies(MadeUp(off), question, prisms, bricks)
    )
    assert reference is not None
    assert not reference.is_confirmed
    assert [other.family for other in reference.others] == ["hex27"]


def test_one_combination_apart_is_enough_to_disagree() -> None:
    tips, band = np.zeros((3, 3)), np.full(3, 0.1)
    moved = tips.copy()
    moved[1, 0] = 0.21
    assert not Limit("a", tips, band).agrees(Limit("b", moved, band))
    moved[1, 0] = 0.19
    assert Limit("a", tips, band).agrees(Limit("b", moved, band))
    moved[1] = np.nan
    assert Limit("a", tips, band).agrees(Limit("b", moved, np.where([0, 1, 0], np.nan, band)))
    nowhere = Limit("b", np.full((3, 3), np.nan), np.full(3, np.nan))
    assert not Limit("a", tips, band).agrees(nowhere)
    assert np.isnan(nowhere.uncertainty)
    assert not Reference("a", tips, band).is_confirmed


def test_under_the_beams_law_the_closed_form_is_the_reference() -> None:
    """Whatever solids say; they are held against it."""
    question, series = question_of(RIGID), family("wedge18")
    measured = replies(MadeUp(powers(5.0, 4)), question, series)
    reference = reference_of(question, [series], measured)
    assert reference is not None
    assert reference.family == "closed form"
    np.testing.assert_allclose(reference.tips, truth(), atol=1e-12)
    assert reference.uncertainty == 1e-10 * question.design.actuator.length
    assert reference.is_confirmed
    wrong = replies(MadeUp(lambda model: 0.3 + powers(5.0, 4)(model)), question, series)
    other = reference_of(question, [series], wrong)
    assert other is not None
    assert other.family == "closed form"
    assert not other.is_confirmed


def test_under_loads_the_tightest_rod_is_the_reference() -> None:
    name, design = named_design("gravity")
    question = Question.of(name, design, RIGID, np.array([[50.0, 0, 0]]))
    reference = reference_of(question, [], {})
    assert reference is not None
    assert reference.family == "beam"
    assert reference.uncertainty == 1e-9 * design.actuator.length
    assert not reference.is_confirmed


def test_a_materials_tips_without_solids_are_not_known() -> None:
    rod = Measured("beam", "", Reply(truth(), (FOUND,) * 3), 1.0)
    series = [Series("beam", (RodOnOutline(),))]
    assert reference_of(question_of(NEO), series, {"beam ": rod}) is None
