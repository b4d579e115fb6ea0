"""The isotropic laws against closed forms of incompressible rubber and small strains."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from beamopt.base.errors import InputError
from femcheck.material.gent import Gent
from femcheck.material.isotropic import Isotropic
from femcheck.material.mooney_rivlin import MooneyRivlin
from femcheck.material.neo_hookean import NeoHookean
from femcheck.material.volumetric import add_pressure, add_pressure_stiffness, volume_ratio_log
from femcheck.material.yeoh import Yeoh

E, JM, SHARE, SECOND, THIRD = 300.0, 30.0, 0.2, 0.15, 0.004
MU = E / 3  # incompressible
PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))

Derivatives = Callable[[float], tuple[float, float]]


def laws(nu: float = 0.5, mixed: bool | None = None) -> list[Isotropic]:
    return [
        NeoHookean(E, nu, mixed=mixed),
        Gent(E, nu, mixed=mixed, Jm=JM),
        MooneyRivlin(E, nu, mixed=mixed, C2_share=SHARE),
        Yeoh(E, nu, mixed=mixed, C2_ratio=SECOND, C3_ratio=THIRD),
    ]


# ∂W/∂I1 and ∂W/∂I2 by I1, written down here once more
BY_INVARIANTS: list[Derivatives] = [
    lambda I1: (MU / 2, 0.0),
    lambda I1: (MU / 2 * JM / (JM - (I1 - 3)), 0.0),
    lambda I1: (MU / 2 * (1 - SHARE), MU / 2 * SHARE),
    lambda I1: (MU / 2 * (1 + 2 * SECOND * (I1 - 3) + 3 * THIRD * (I1 - 3) ** 2), 0.0),
]
EACH = pytest.mark.parametrize(
    ("law", "derivatives"),
    list(zip(laws(), BY_INVARIANTS, strict=True)),
    ids=[law.name for law in laws()],
)


def stored(C: np.ndarray) -> np.ndarray:
    return np.array([[C[i, j] for i, j in PAIRS]])


def whole_stress(law: Isotropic, F: np.ndarray, free: int) -> np.ndarray:
    """Cauchy stress (3, 3) with the pressure that leaves no stress normal to axis `free`."""
    C = stored(F.T @ F)
    S = law.stress(C)
    inverse = np.zeros((1, 6))
    add_pressure(C, np.ones(1), inverse)
    pressure = -S[:, free] / inverse[:, free]
    add_pressure(C, pressure, S)
    full = S[0][[[0, 3, 5], [3, 1, 4], [5, 4, 2]]]
    return np.asarray(F @ full @ F.T)


@EACH
@pytest.mark.parametrize("stretch", [0.6, 0.95, 1.05, 1.5, 2.5])
def test_uniaxial(law: Isotropic, derivatives: Derivatives, stretch: float) -> None:
    """σ = 2 (λ² − 1/λ) (∂W/∂I1 + ∂W/∂I2/λ); Treloar 1975, chapter 5."""
    F = np.diag([stretch**-0.5, stretch**-0.5, stretch])
    by_1, by_2 = derivatives(stretch**2 + 2 / stretch)
    expected = 2 * (stretch**2 - 1 / stretch) * (by_1 + by_2 / stretch)
    stress = whole_stress(law, F, free=0)
    np.testing.assert_allclose(stress, np.diag([0, 0, expected]), atol=1e-10 * MU)


@EACH
@pytest.mark.parametrize("stretch", [0.8, 1.1, 1.8])
def test_equibiaxial(law: Isotropic, derivatives: Derivatives, stretch: float) -> None:
    """σ = 2 (λ² − λ⁻⁴) (∂W/∂I1 + λ² ∂W/∂I2) in both directions."""
    F = np.diag([stretch, stretch, stretch**-2])
    by_1, by_2 = derivatives(2 * stretch**2 + stretch**-4)
    expected = 2 * (stretch**2 - stretch**-4) * (by_1 + stretch**2 * by_2)
    stress = whole_stress(law, F, free=2)
    np.testing.assert_allclose(stress, np.diag([expected, expected, 0]), atol=1e-10 * MU)


@EACH
@pytest.mark.parametrize("shear", [0.01, 0.5, 2.0])
@pytest.mark.parametrize(("along", "across"), [(0, 1), (1, 2), (2, 0)])
def test_simple_shear(
    law: Isotropic, derivatives: Derivatives, shear: float, along: int, across: int
) -> None:
    """τ = 2 γ (∂W/∂I1 + ∂W/∂I2); normal stresses differ by γ τ, whatever the law (Rivlin)."""
    F = np.eye(3)
    F[along, across] = shear
    expected = 2 * shear * sum(derivatives(3 + shear**2))
    stress = whole_stress(law, F, free=3 - along - across)
    assert stress[along, across] == pytest.approx(expected, rel=1e-12)
    difference = stress[along, along] - stress[across, across]
    assert difference == pytest.approx(shear * expected, rel=1e-10)


@pytest.mark.parametrize("nu", [0.25, 0.3, 0.45])
@pytest.mark.parametrize("place", range(4))
def test_small_strains_give_back_what_the_design_says(nu: float, place: int) -> None:
    """D at rest is Hooke's, λ 1⊗1 + 2 μ I; its inverse has 1/E and −ν/E."""
    law = laws(nu)[place]
    D = law.stiffness(np.array([[1.0, 1, 1, 0, 0, 0]]))[0]
    compliance = np.linalg.inv(D)
    np.testing.assert_allclose(np.diag(compliance)[:3], 1 / E, rtol=1e-12)
    np.testing.assert_allclose(compliance[0, 1:3], -nu / E, rtol=1e-12)
    np.testing.assert_allclose(np.diag(D)[3:], law.shear_modulus, rtol=1e-12)
    np.testing.assert_allclose(D[0, 1], law.lame_modulus, rtol=1e-12)
    assert law.shear_modulus == E / (2 * (1 + nu))
    assert law.lame_modulus == pytest.approx(E * nu / ((1 + nu) * (1 - 2 * nu)))


@pytest.mark.parametrize("nu", [0.25, 0.4, 0.5])
@pytest.mark.parametrize("place", range(4))
def test_no_direction_is_special(nu: float, place: int) -> None:
    """C → QᵀCQ leaves the energy."""
    random = np.random.default_rng(3)
    law = laws(nu)[place]
    for _ in range(10):
        F = np.eye(3) + random.uniform(-0.25, 0.25, (3, 3))
        Q, _ = np.linalg.qr(random.normal(size=(3, 3)))
        C = F.T @ F
        turned = law.energy(stored(Q.T @ C @ Q))
        np.testing.assert_allclose(turned, law.energy(stored(C)), rtol=1e-12)


@pytest.mark.parametrize("place", range(4))
def test_mixed_is_displacement_at_its_pressure(place: int) -> None:
    """With p = Λ ln J the two-field energy, stress and stiffness are those of displacements."""
    whole, mixed = laws(0.4, mixed=False)[place], laws(0.4, mixed=True)[place]
    compliance = mixed.volumetric_compliance
    assert compliance == 1 / whole.volumetric_modulus
    assert whole.volumetric_compliance is None
    random = np.random.default_rng(5)
    F = np.eye(3) + random.uniform(-0.2, 0.2, (20, 3, 3))
    C = np.concatenate([stored(f.T @ f) for f in F])
    log_ratio = volume_ratio_log(C)
    p = log_ratio / compliance
    energy = mixed.energy(C) + p * log_ratio - compliance / 2 * p**2
    np.testing.assert_allclose(energy, whole.energy(C), rtol=1e-12)
    S, D = mixed.stress(C), mixed.stiffness(C)
    add_pressure(C, p, S)
    np.testing.assert_allclose(S, whole.stress(C), atol=1e-10 * MU)
    inverse = np.zeros_like(C)
    add_pressure(C, np.ones(20), inverse)
    add_pressure_stiffness(C, p, D)
    D += inverse[:, :, None] * inverse[:, None, :] / compliance  # what p's own change adds
    np.testing.assert_allclose(D, whole.stiffness(C), atol=1e-10 * MU)


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.49])
def test_mixed_is_displacement_with_negative_constants(nu: float) -> None:
    """What Λ has more than λ stays in the law: a dilation costs energy at any fixed pressure."""
    for shape in ({"C2_ratio": -1.0, "C3_ratio": 0.0}, {"C2_ratio": -0.2, "C3_ratio": 0.1}):
        whole = Yeoh(E, nu, mixed=False, **shape)
        if nu == 0:
            with pytest.raises(InputError, match="no volumetric term to mix"):
                Yeoh(E, nu, mixed=True, **shape)
            continue
        mixed = Yeoh(E, nu, mixed=True, **shape)
        compliance = mixed.volumetric_compliance
        assert compliance == pytest.approx(1 / mixed.lame_modulus)
        F = np.eye(3) + np.random.default_rng(7).uniform(-0.2, 0.2, (20, 3, 3))
        C = np.concatenate([stored(f.T @ f) for f in F])
        p = volume_ratio_log(C) / compliance
        energy = mixed.energy(C) + p * volume_ratio_log(C) - compliance / 2 * p**2
        np.testing.assert_allclose(energy, whole.energy(C), rtol=1e-10, atol=1e-10 * MU)
        S = mixed.stress(C)
        add_pressure(C, p, S)
        np.testing.assert_allclose(S, whole.stress(C), atol=1e-10 * MU)
        swollen = np.exp(2e-3) * np.array([[1.0, 1, 1, 0, 0, 0]])
        assert mixed.energy(swollen)[0] > 0


entry = st.floats(-0.6, 0.6)


@given(
    F=st.lists(entry, min_size=9, max_size=9),
    place=st.integers(0, 3),
    nu=st.sampled_from([0.25, 0.3, 0.45, 0.5]),
)
@settings(max_examples=200, deadline=None)
def test_energy_is_least_at_rest(F: list[float], place: int, nu: float) -> None:
    """Above 0 away from rest, for whatever deformation the law admits."""
    gradient = np.eye(3) + np.reshape(F, (3, 3))
    law = laws(nu)[place]
    C = stored(gradient.T @ gradient)
    strain = np.abs(C - [[1, 1, 1, 0, 0, 0]]).max()
    floor = 1e-3 * MU * min(strain, 1) ** 2
    assert law.energy(C)[0] >= (floor if strain > 1e-6 else 0)


def test_which_form() -> None:
    assert NeoHookean(E).volumetric_compliance == 0
    nearly = NeoHookean(E, 0.49)
    assert nearly.volumetric_compliance == 1 / nearly.lame_modulus
    assert NeoHookean(E, 0.45).volumetric_compliance is None
    assert NeoHookean(E, 0.49, mixed=False).volumetric_compliance is None
    assert "incompressible, mixed displacement–pressure" in NeoHookean(E).text
    assert "displacements only" in NeoHookean(E, 0.3).text
    assert "kPa, mixed displacement–pressure" in nearly.text


def test_constants_in_the_text() -> None:
    neo, gent, mooney, yeoh = (law.text for law in laws())
    assert "μ = 100 kPa" in neo
    assert "μ = 100 kPa, Jm = 30" in gent
    assert "C1 = 40 kPa, C2 = 10 kPa" in mooney
    assert "C1 = 50 kPa, C2 = 7.5 kPa, C3 = 0.2 kPa" in yeoh


@pytest.mark.parametrize("nu", [0.3, 0.5])
@pytest.mark.parametrize("place", range(4))
def test_outside_there_is_no_energy(nu: float, place: int) -> None:
    """+∞ and no warnings; stress and stiffness are finite or NaN."""
    law = laws(nu)[place]
    flat, inside_out = [1.0, 1, 0, 0, 0, 0], [1.0, 1, 1, 2, 0, 0]
    C = np.array([flat, inside_out, [np.nan] * 6])
    assert (law.energy(C) == np.inf).all()
    assert not np.isinf(law.stress(C)).any()
    assert not np.isinf(law.stiffness(C)).any()


@pytest.mark.parametrize("beyond", [0.0, 1e-9, 70.0])
def test_chains_have_a_limit(beyond: float) -> None:
    law = Gent(E, Jm=JM)
    C = np.array([[1.0, 1.0, 1 + JM + beyond, 0, 0, 0]])
    assert law.energy(C)[0] == np.inf
    assert not np.isinf(law.stress(C)).any()
    assert not np.isinf(law.stiffness(C)).any()
    inside = np.array([[1.0, 1.0, 0.999 + JM, 0, 0, 0]])
    assert np.isfinite(law.energy(inside)).all()
    assert np.isfinite(law.stiffness(inside)).all()


def test_volume() -> None:
    """Ln J of known F, to the last digits at small strains."""
    F = np.array([[1.1, 0.2, 0], [0, 0.9, -0.3], [0.1, 0, 1.3]])
    assert volume_ratio_log(stored(F.T @ F))[0] == pytest.approx(math.log(np.linalg.det(F)))
    sheared = volume_ratio_log(np.array([[1.0, 1, 1, 1e-9, 0, 0]]))[0]  # det C = 1 − 10⁻¹⁸
    assert sheared == pytest.approx(-0.5e-18, rel=1e-12)
    assert volume_ratio_log(np.array([[1.0, 1, -1, 0, 0, 0]]))[0] == -np.inf


@pytest.mark.parametrize(
    ("build", "said"),
    [
        (lambda: NeoHookean(0.0), "youngs_modulus = 0.0: above 0 kPa"),
        (lambda: NeoHookean(math.inf), "youngs_modulus = inf: above 0 kPa"),
        (lambda: NeoHookean(E, 0.51), "poisson_ratio = 0.51: 0 … 0.5"),
        (lambda: NeoHookean(E, -0.1), "poisson_ratio = -0.1: 0 … 0.5"),
        (lambda: NeoHookean(E, math.nan), "poisson_ratio = nan: 0 … 0.5"),
        (lambda: NeoHookean(E, mixed=False), "mixed = False: an incompressible law"),
        (lambda: NeoHookean(E, 0.0, mixed=True), "mixed = True: with poisson_ratio = 0 there"),
        (lambda: Gent(E, Jm=0.0), "Jm = 0.0: above 0"),
        (lambda: Gent(E, Jm=math.inf), "Jm = inf: above 0"),
        (lambda: MooneyRivlin(E, C2_share=math.nan), "C2_share = nan: a finite number"),
        (lambda: MooneyRivlin(E, 0.05, C2_share=0.125), "poisson_ratio = 0.05: 0.1 … 0.5"),
        (lambda: Yeoh(E, C2_ratio=0.1, C3_ratio=math.inf), "C3_ratio = inf: a finite number"),
        (lambda: Yeoh(E, C2_ratio=math.nan, C3_ratio=0.0), "C2_ratio = nan: a finite number"),
    ],
)
def test_refused(build: Callable[[], Isotropic], said: str) -> None:
    with pytest.raises(ValueError) as caught:  # noqa: PT011
        build()
    assert said in str(caught.value)
