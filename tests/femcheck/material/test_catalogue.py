"""Materials by name, their constants and where those are from."""

import math

import pytest

from beamopt.base.errors import InputError
from femcheck.material.catalogue import (
    LAWS,
    MATERIALS,
    Constant,
    constants_of,
    law_by_name,
    modulus_of,
)
from femcheck.material.isotropic import Isotropic
from femcheck.material.rigid_section import RigidSection


def sources(name: str, constants: dict[str, float]) -> dict[str, tuple[float, str]]:
    law = law_by_name(name, 300.0, 0.4, constants)
    return {constant.name: (constant.value, constant.source) for constant in constants_of(law)}


@pytest.mark.parametrize("name", MATERIALS)
def test_every_constant_has_a_source(name: str) -> None:
    law = law_by_name(name, 300.0)
    assert law.name == name
    assert law.volumetric_compliance == 0
    constants = constants_of(law)
    assert [constant.name for constant in constants[:3]] == ["E", "ν", "μ"]
    assert [constant.value for constant in constants[:3]] == [300, 0.5, 100]
    assert constants[3:] == LAWS[name].shape
    for constant in constants:
        assert constant.source
        assert math.isfinite(constant.value)


def test_published_and_given() -> None:
    value, source = sources("gent", {})["Jm"]
    assert value == pytest.approx(10**2 + 2 / 10 - 3)  # I1 − 3 at stretch 10
    assert "Gent" in source
    assert sources("gent", {"Jm": 30.0})["Jm"] == (30.0, "given")
    share, source = sources("mooney-rivlin", {})["C2_share"]
    assert share == 0.0625 / (0.4375 + 0.0625)
    assert "Holzapfel" in source
    yeoh = sources("yeoh", {"C3_ratio": 0.01})
    assert yeoh["C2_ratio"][0] == 0.02 / 0.11
    assert "Elastosil" in yeoh["C2_ratio"][1]
    assert yeoh["C3_ratio"] == (0.01, "given")


def test_moduli() -> None:
    """Λ stands beside λ where it is another."""
    assert set(sources("neo-hookean", {})) == {"E", "ν", "μ", "λ"}
    gent = sources("gent", {"Jm": 20.0})
    mu = 300 / 2.8
    assert gent["λ"][0] == pytest.approx(2 * mu * 0.4 / 0.2)
    assert gent["Λ"][0] == pytest.approx(gent["λ"][0] - 2 * mu / 20)
    assert gent["Λ"][1] == "of E and ν"
    assert gent["E"][1] == "the design"
    assert gent["ν"][1] == "given"


def test_rigid_section() -> None:
    assert constants_of(RigidSection(300.0, 100.0)) == (
        Constant("E", 300.0, "kPa", "the design"),
        Constant("G", 15000.0, "kPa", "cE/2"),
        Constant("c", 100.0, "", "given"),
    )
    assert constants_of(RigidSection(300.0, 100.0, 7.0))[1].source == "given"


@pytest.mark.parametrize("nu", [0.5, 0.4])
@pytest.mark.parametrize(
    ("name", "fitted", "shape"),
    [
        ("yeoh", {"C1": 7.83, "C2": 0.103, "C3": -0.0008}, {"C2_ratio": 0.103 / 7.83}),
        ("yeoh", {"C1": 110.0, "C2": 20.0}, {"C2_ratio": 2 / 11, "C3_ratio": 0.0}),
        ("mooney-rivlin", {"C1": 60.0, "C2": -10.0}, {"C2_share": -0.2}),
        ("mooney-rivlin", {"C1": 43.75, "C2": 6.25}, {"C2_share": 0.125}),
    ],
)
def test_constants_of_a_test_curve(
    name: str, fitted: dict[str, float], shape: dict[str, float], nu: float
) -> None:
    """In kPa, with the E that they have; the same law as by E and shape."""
    E = modulus_of(name, nu, fitted)
    both = fitted["C1"] + (fitted["C2"] if name == "mooney-rivlin" else 0.0)
    assert pytest.approx(4 * (1 + nu) * both) == E
    law = law_by_name(name, E, nu, fitted)
    assert modulus_of(name, nu, shape) is None
    ratios = {one.name: one.value for one in constants_of(law) if one.name not in "EνμλΛ"}
    assert law == law_by_name(name, E, nu, ratios)
    for key, value in shape.items():
        assert ratios[key] == pytest.approx(value)
    assert isinstance(law, Isotropic)
    assert pytest.approx(fitted["C1"]) == law.moduli.C1
    assert law_by_name(name, E * 1.001, nu, fitted) != law  # as designs round it
    with pytest.raises(InputError, match="give it that E"):
        law_by_name(name, E * 1.01, nu, fitted)


@pytest.mark.parametrize(
    ("name", "constants", "said"),
    [
        ("steel", {}, "law = 'steel': a material is one of neo-hookean, gent, mooney-rivlin, yeoh"),
        ("gent", {"jm": 1.0}, "jm = 1.0: gent takes Jm"),
        ("neo-hookean", {"C2": 1.0}, "C2 = 1.0: neo-hookean takes no constants beside E and ν"),
        ("yeoh", {"C4": 1.0}, "C4 = 1.0: yeoh takes C2_ratio and C3_ratio, or C1, C2, C3 in kPa"),
        ("yeoh", {"C2": 1.0}, "C1: must be given with C2"),
        ("yeoh", {"C1": 50.0, "C2_ratio": 1.0}, "C2_ratio = 1.0: a number of C1, C2, C3 in kPa"),
        ("yeoh", {"C1": math.nan}, "C1 = nan: a number of C1, C2, C3 in kPa"),
        (
            "yeoh",
            {"C1": -1.0, "C2": 2.0},
            "C1 = -1.0: with C1 = -1, C2 = 2 kPa the shear modulus at rest is -2 kPa: "
            "must be above 0",
        ),
        (
            "mooney-rivlin",
            {"C1": 20.0, "C2": -20.0},
            "C1 = 20.0: with C1 = 20, C2 = -20 kPa the shear modulus at rest is 0 kPa: "
            "must be above 0",
        ),
        (
            "mooney-rivlin",
            {"C1": 20.0, "C2": -5.0},
            "C1 = 20.0: these constants have E = 90 kPa, and the design 300 kPa: give it that E, "
            "or C2_share=-0.333333 for a curve of this shape at its own",
        ),
        ("gent", {"Jm": math.nan}, "Jm = nan: above 0"),
        ("gent", {"Jm": -1.0}, "Jm = -1.0: above 0"),
        ("mooney-rivlin", {"C2_share": math.inf}, "C2_share = inf: a finite number"),
        ("gent", {"poisson_ratio": 0.3}, "poisson_ratio = 0.3: gent takes Jm"),
    ],
)
def test_refused(name: str, constants: dict[str, float], said: str) -> None:
    with pytest.raises(InputError) as caught:
        law_by_name(name, 300.0, constants=constants)
    assert str(caught.value) == said
