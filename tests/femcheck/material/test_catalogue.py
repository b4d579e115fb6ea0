"""Materials by name, their constants and where those are from."""

import math

import pytest

from beamopt.errors import InputError
from femcheck.material.catalogue import LAWS, MATERIALS, Constant, constants_of, law_by_name
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


@pytest.mark.parametrize(
    ("name", "constants", "said"),
    [
        ("steel", {}, "law = 'steel': a material is one of neo-hookean, gent, mooney-rivlin, yeoh"),
        ("gent", {"jm": 1.0}, "jm = 1.0: gent takes Jm"),
        ("neo-hookean", {"C2": 1.0}, "C2 = 1.0: neo-hookean takes no constants beside E and ν"),
        ("yeoh", {"C2": 1.0}, "C2 = 1.0: yeoh takes C2_ratio and C3_ratio"),
        ("gent", {"Jm": math.nan}, "Jm = nan: above 0"),
        ("gent", {"Jm": -1.0}, "Jm = -1.0: above 0"),
        ("mooney-rivlin", {"C2_share": math.inf}, "C2_share = inf: 0 … 1"),
        ("gent", {"poisson_ratio": 0.3}, "poisson_ratio = 0.3: gent takes Jm"),
    ],
)
def test_refused(name: str, constants: dict[str, float], said: str) -> None:
    with pytest.raises(InputError) as caught:
        law_by_name(name, 300.0, constants=constants)
    assert str(caught.value) == said
