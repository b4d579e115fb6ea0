"""Every law: stress and stiffness are the derivatives of its energy."""

import numpy as np
import pytest

from femcheck.check.options import LAWS
from femcheck.material.law import Law
from femcheck.material.rigid_section import RigidSection

INSTANCES: list[Law] = [RigidSection(300.0, 1000.0), RigidSection(50.0, 10.0, 100.0)]
PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))


def random_C(count: int) -> np.ndarray:
    """(n, 6) of random deformations, some of them large."""
    F = np.eye(3) + np.random.default_rng(7).uniform(-0.25, 0.25, (count, 3, 3))
    C = np.swapaxes(F, 1, 2) @ F
    return np.stack([C[:, i, j] for i, j in PAIRS], axis=1)


def test_every_law_is_here() -> None:
    assert {law.name for law in INSTANCES} == set(LAWS)


@pytest.mark.parametrize("law", INSTANCES, ids=repr)
def test_energy_stress_stiffness(law: Law) -> None:
    """δW = S : δE with doubled shears, δS = D δE; δC = 2 δE for normal components."""
    C, h = random_C(30), 1e-6
    S, D = law.stress(C), law.stiffness(C)
    scale = np.abs(D).max()
    for place in range(6):
        # a doubled shear strain δγ = 2 δE12 = δC12, a normal strain δE11 = δC11/2
        step = h * np.eye(6)[place] * (2 if place < 3 else 1)
        by_energy = (law.energy(C + step) - law.energy(C - step)) / (2 * h)
        np.testing.assert_allclose(S[:, place], by_energy, atol=1e-8 * scale)
        by_stress = (law.stress(C + step) - law.stress(C - step)) / (2 * h)
        np.testing.assert_allclose(D[:, :, place], by_stress, atol=1e-8 * scale)
    np.testing.assert_array_equal(D, np.swapaxes(D, 1, 2))


@pytest.mark.parametrize("law", INSTANCES, ids=repr)
def test_nothing_at_rest_and_stable_there(law: Law) -> None:
    rest = np.array([[1.0, 1, 1, 0, 0, 0]])
    assert law.energy(rest)[0] == 0
    assert not law.stress(rest).any()
    assert (np.linalg.eigvalsh(law.stiffness(rest)[0]) > 0).all()
    assert (law.energy(random_C(50)) > 0).all()


def test_fibres_follow_hookes_law() -> None:
    """Under pressure alone the beam's own: nominal stress E (λ − 1), no Poisson coupling."""
    law, stretch = RigidSection(300.0, 1000.0), 1.2
    C = np.array([[1.0, 1.0, stretch**2, 0, 0, 0]])
    np.testing.assert_allclose(law.stress(C), [[0, 0, 300 * 0.2 / stretch, 0, 0, 0]], atol=1e-10)
    assert law.energy(C)[0] == pytest.approx(150 * 0.2**2)
    sheared = np.array([[1.0, 1, 1, 0, 0.01, 0]])
    assert law.stress(sheared)[0, 4] == pytest.approx(1000 * 300 / 2 * 0.01)
    assert RigidSection(300.0, 1000.0, 7.0).stress(sheared)[0, 4] == pytest.approx(0.07)


@pytest.mark.parametrize("name", ["youngs_modulus", "penalty", "shear_modulus"])
@pytest.mark.parametrize("value", [0.0, -1.0, float("nan"), float("inf")])
def test_refused(name: str, value: float) -> None:
    with pytest.raises(ValueError, match=f"{name} = {value}: must be above 0"):
        RigidSection(**({"youngs_modulus": 300.0, "penalty": 1000.0} | {name: value}))
