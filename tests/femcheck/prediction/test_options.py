"""What may be asked of a prediction, and what is refused in one line."""

import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from beamopt.base.errors import InputError
from beamopt.scene.actuator import Actuator
from femcheck.material.fibre import Thread
from femcheck.material.gent import Gent
from femcheck.prediction.options import PredictionOptions
from femcheck.solid.winding import Wound
from tests.femcheck.prediction.small import options_of


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"element": "tet4"}, ["element", "tet4", "no stable pair", "ν = 0.5", "wedge18"]),
        ({"element": "tet4", "law": "gent"}, ["element", "no stable pair"]),
        ({"element": "hex8"}, ["element", "hex8", "one of wedge18"]),
        ({"law": "steel"}, ["law", "steel", "neo-hookean, gent, mooney-rivlin, yeoh"]),
        ({"law": "rigid-section"}, ["law", "rigid-section", "a material is one of"]),
        ({"constants": {"Jm": 30.0}}, ["Jm = 30", "neo-hookean takes no constants"]),
        ({"law": "gent", "constants": {"K": 3.0}}, ["K = 3", "gent takes Jm"]),
        ({"law": "gent", "constants": {"Jm": -1.0}}, ["Jm = -1"]),
        ({"law": "gent", "constants": {"Jm": float("nan")}}, ["Jm = nan"]),
        ({"poisson_ratio": 0.51}, ["poisson_ratio = 0.51", "0"]),
        ({"poisson_ratio": -0.1}, ["poisson_ratio = -0.1"]),
        ({"poisson_ratio": float("nan")}, ["poisson_ratio = nan"]),
        ({"agree": 0.0}, ["agree"]),
        ({"layers": 1}, ["layers", "2…64"]),
    ],
    ids=str,
)
def test_refused(changes: dict[str, Any], words: list[str]) -> None:
    with pytest.raises(InputError) as refusal:
        options_of(**changes)
    said = str(refusal.value)
    assert "\n" not in said
    for word in words:
        assert word in said


def test_an_element_without_a_pair_is_enough_where_none_is_needed() -> None:
    """Compressible far enough, the law is solved in displacements alone."""
    options = options_of(element="tet4", poisson_ratio=0.3)
    assert options.law_for(Actuator()).volumetric_compliance is None


@pytest.mark.parametrize(
    ("nu", "modulus", "is_taken"),
    [
        (0.5, 100.0, True),
        (0.5, 100.4, True),  # a file's rounding
        (0.5, 101.0, False),
        (0.3, 300 / 2.6, True),
        (0.3, 100.0, True),  # the design's own default: E/3
        (0.3, 110.0, False),
    ],
)
def test_a_shear_modulus_that_contradicts_is_refused(
    nu: float, modulus: float, is_taken: bool
) -> None:
    options, actuator = options_of(poisson_ratio=nu), Actuator(shear_modulus=modulus)
    if is_taken:
        options.law_for(actuator)
        return
    with pytest.raises(InputError) as refusal:
        options.law_for(actuator)
    said = str(refusal.value)
    assert said.startswith(f"actuator.shear_modulus = {modulus:g}")
    assert f"contradicts E = 300 kPa and ν = {nu:g}" in said
    assert f"{300 / (2 * (1 + nu)):.4g} kPa" in said


@given(E=st.floats(5, 50_000), nu=st.floats(0, 0.5))
def test_a_shear_modulus_that_was_not_given_contradicts_nothing(E: float, nu: float) -> None:
    law = options_of(poisson_ratio=nu).law_for(Actuator(youngs_modulus=E))
    assert law.shear_modulus == pytest.approx(E / (2 * (1 + nu)), rel=1e-12)


def test_the_law_is_the_design_s_material() -> None:
    """E from the design, the curve's shape from the options."""
    options = options_of(law="gent", constants={"Jm": 30.0}, poisson_ratio=0.4)
    law = options.law_for(Actuator(youngs_modulus=280.0, shear_modulus=100.0))
    assert law == Gent(280.0, 0.4, Jm=30.0)
    assert options_of().law_for(Actuator()).volumetric_compliance is not None


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"law": "yeoh", "constants": {"C2_ratio": 0.1}, "poisson_ratio": 0.45},
        {"wound": Wound.BOTH, "thread": Thread(2e4, 1e-2)},
        {"layers": None, "element": "hex27"},
    ],
    ids=str,
)
def test_the_question_survives_a_file(changes: dict[str, Any]) -> None:
    question = options_of(**changes).question
    assert json.loads(json.dumps(question)) == question


def test_every_change_of_the_material_is_another_question() -> None:
    """The time limit, the solver and what is asked of the beam are none of it."""
    asked = [
        options_of(),
        options_of(law="gent"),
        options_of(law="gent", constants={"Jm": 30.0}),
        options_of(poisson_ratio=0.49),
        options_of(wound=Wound.CHAMBERS),
        options_of(wound=Wound.OUTER),
        options_of(wound=Wound.CHAMBERS, thread=Thread(1e4)),
        options_of(wound=Wound.CHAMBERS, thread=Thread(1e5, 1e-3)),
        options_of(layers=3),
        options_of(element="tet10"),
    ]
    questions = [json.dumps(options.question, sort_keys=True) for options in asked]
    assert len(set(questions)) == len(asked)
    same = options_of(seconds=1.0, agree=0.5, solver="superlu")
    assert same.question == options_of().question
    # a thread that is not wound is no difference
    assert options_of(thread=Thread(1.0)).question == options_of().question


@pytest.mark.parametrize(
    ("wound", "said"),
    [
        (None, "neo-hookean, ν = 0.5, unreinforced"),
        (Wound.CHAMBERS, "neo-hookean, ν = 0.5, chambers wound"),
        (Wound.OUTER, "neo-hookean, ν = 0.5, wound outside"),
        (Wound.BOTH, "neo-hookean, ν = 0.5, chambers and outside wound"),
    ],
)
def test_title(wound: Wound | None, said: str) -> None:
    assert PredictionOptions(wound=wound).title == said
