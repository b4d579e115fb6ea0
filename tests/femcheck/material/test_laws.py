"""Every law: stress and stiffness are the derivatives of its energy."""

import dataclasses
import pickle

import numpy as np
import pytest

from femcheck.material.catalogue import MATERIALS, law_by_name
from femcheck.material.differentiate import Differentiable, differences, random_deformations
from femcheck.material.gent import Gent
from femcheck.material.law import Law
from femcheck.material.mooney_rivlin import MooneyRivlin
from femcheck.material.neo_hookean import NeoHookean
from femcheck.material.rigid_section import RigidSection
from femcheck.material.yeoh import Yeoh

INSTANCES: list[Law] = [
    RigidSection(300.0, 1000.0),
    RigidSection(50.0, 10.0, 100.0),
    *(law_by_name(name, 300.0, nu) for name in MATERIALS for nu in (0.5, 0.49, 0.45, 0.3)),
    NeoHookean(300.0, 0.0),
    NeoHookean(300.0, 0.3, mixed=True),
    NeoHookean(300.0, 0.499, mixed=False),
    Gent(20.0, 0.4, Jm=1.5),
    MooneyRivlin(300.0, 0.4, C2_share=1.0),
    Yeoh(300.0, C2_ratio=-0.02, C3_ratio=0.001),
]


def test_every_law_is_here() -> None:
    assert {law.name for law in INSTANCES} == {*MATERIALS, "rigid-section"}


@pytest.mark.parametrize("law", INSTANCES, ids=repr)
def test_energy_stress_stiffness(law: Law) -> None:
    """δW = S : δE with doubled shears, δS = D δE."""
    C = random_deformations(30, 7)
    C = C[np.isfinite(law.energy(C))]
    assert len(C) > 20
    by_energy, by_stress = differences(law, C)
    assert by_energy < 1e-7  # Gent close to its limit; 1e-9 elsewhere
    assert by_stress < 1e-7
    D = law.stiffness(C)
    np.testing.assert_array_equal(D, np.swapaxes(D, 1, 2))


@pytest.mark.parametrize("law", INSTANCES, ids=repr)
def test_nothing_at_rest_and_stable_there(law: Law) -> None:
    rest = np.array([[1.0, 1, 1, 0, 0, 0]])
    assert law.energy(rest)[0] == 0
    assert not law.stress(rest).any()
    assert (np.linalg.eigvalsh(law.stiffness(rest)[0]) > 0).all()
    assert (law.energy(random_deformations(50, 7)) > 0).all()


@pytest.mark.parametrize("law", INSTANCES, ids=repr)
def test_processes_can_share_it(law: Law) -> None:
    assert pickle.loads(pickle.dumps(law)) == law
    assert dataclasses.is_dataclass(law)
    hash(law)


@pytest.mark.parametrize(("wrong", "which"), [("energy", 0), ("stress", 1), ("stiffness", 1)])
def test_differences_find_what_is_wrong(wrong: str, which: int) -> None:
    class Wrong:
        def __getattr__(self, name: str) -> object:
            right = getattr(NeoHookean(300.0), name)
            return (lambda C: 1.00001 * right(C)) if name == wrong else right

    law: Differentiable = Wrong()  # type: ignore[assignment]
    assert differences(law, random_deformations(30, 7))[which] > 1e-6


def test_fibres_follow_hookes_law() -> None:
    """Under pressure alone the beam's own: nominal stress E (λ − 1), no Poisson coupling."""
    law, stretch = RigidSection(300.0, 1000.0), 1.2
    C = np.array([[1.0, 1.0, stretch**2, 0, 0, 0]])
    np.testing.assert_allclose(law.stress(C), [[0, 0, 300 * 0.2 / stretch, 0, 0, 0]], atol=1e-10)
    assert law.energy(C)[0] == pytest.approx(150 * 0.2**2)
    sheared = np.array([[1.0, 1, 1, 0, 0.01, 0]])
    assert law.stress(sheared)[0, 4] == pytest.approx(1000 * 300 / 2 * 0.01)
    assert RigidSection(300.0, 1000.0, 7.0).stress(sheared)[0, 4] == pytest.approx(0.07)
    assert law.volumetric_compliance is None
    assert "E = 300 kPa, G = 150000 kPa, c = 1000" in law.text


@pytest.mark.parametrize("name", ["youngs_modulus", "penalty", "shear_modulus"])
@pytest.mark.parametrize("value", [0.0, -1.0, float("nan"), float("inf")])
def test_refused(name: str, value: float) -> None:
    with pytest.raises(ValueError, match=f"{name} = {value}: must be above 0"):
        RigidSection(**({"youngs_modulus": 300.0, "penalty": 1000.0} | {name: value}))
