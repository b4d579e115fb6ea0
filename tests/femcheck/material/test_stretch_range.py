"""Up to which stretch a law's responses rise: against roots, and against its energy."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.polynomial import Polynomial

from femcheck.material.catalogue import law_by_name
from femcheck.material.gent import Gent
from femcheck.material.isotropic import Isotropic
from femcheck.material.mooney_rivlin import MooneyRivlin
from femcheck.material.neo_hookean import NeoHookean
from femcheck.material.rigid_section import RigidSection
from femcheck.material.yeoh import Yeoh

E = 300.0
PUBLISHED = {"C1": 7.83, "C2": 0.103, "C3": -0.0008}
"""A silicone's test curve [kPa]."""

Q = {
    "uniaxial": (Polynomial([2, -3, 0, 1]), 1),
    "planar": (Polynomial([1, 0, -2, 0, 1]), 2),
    "equibiaxial": (Polynomial([1, 0, 0, 0, -3, 0, 2]), 4),
}
"""λᵏ (I1 − 3) as a polynomial in λ, and k."""


def falls_at(constants: tuple[float, float, float], test: str) -> float:
    """Smallest λ > 1 at which the nominal stress of a Yeoh law stops to rise, by roots.

    W = Σ Cᵢ (I1 − 3)ⁱ = N λ^−m, so that λ^(m + 2) W″ = λ² N″ − 2 m λ N′ + m (m + 1) N.
    """
    q, k = Q[test]
    x, m = Polynomial([0, 1]), 3 * k
    N = sum((C * q**i * x ** (m - k * i) for i, C in enumerate(constants, 1)), Polynomial([0]))
    bend = x**2 * N.deriv(2) - 2 * m * x * N.deriv() + m * (m + 1) * N
    roots = bend.roots()
    real = roots.real[(abs(roots.imag) < 1e-9 * abs(roots)) & (roots.real > 1 + 1e-9)]
    return float(real.min()) if real.size else math.inf


@pytest.mark.parametrize("test", Q)
@pytest.mark.parametrize(
    "constants",
    [(7.83, 0.103, -0.0008), (50.0, 5.0, -0.05), (50.0, -2.0, 0.0), (50.0, -15.0, 1.5)],
    ids=str,
)
def test_a_cubic_rises_up_to_a_root(constants: tuple[float, float, float], test: str) -> None:
    C1, C2, C3 = constants
    law = Yeoh(6 * C1, C2_ratio=C2 / C1, C3_ratio=C3 / C1)
    found = law.stretch_range._asdict()[test]
    assert found == pytest.approx(falls_at(constants, test), rel=1e-9)
    assert law.most_stretch == min(law.stretch_range)


def test_a_published_silicone() -> None:
    """Its test curve rises as far as such a silicone stretches; before, it was refused."""
    law = law_by_name("yeoh", 6 * 7.83, constants=PUBLISHED)
    assert isinstance(law, Yeoh)
    assert pytest.approx(7.83) == law.moduli.C1
    assert (law.C2_ratio, law.C3_ratio) == pytest.approx((0.103 / 7.83, -0.0008 / 7.83))
    assert 5 < law.most_stretch < 6
    assert 7.5 < law.stretch_range.uniaxial < 8.5
    assert f"rises up to a stretch of {law.most_stretch:.3g}" in law.text


@pytest.mark.parametrize("share", [-0.02, -0.1, -0.5])
def test_a_negative_second_constant(share: float) -> None:
    """In tension the section shears by itself at λ² = C1/|C2|; two equal stretches end before."""
    law = MooneyRivlin(E, C2_share=share)
    C1, C2, _ = law.moduli
    ends = law.stretch_range
    assert ends.uniaxial == pytest.approx(math.sqrt(-C1 / C2), rel=1e-9)
    at = ends.equibiaxial

    def stress(stretch: float) -> float:  # of either direction, by half
        return (stretch - stretch**-5) * (C1 + C2 * stretch**2)

    step = 1e-5
    assert abs(stress(at + step) - stress(at - step)) < 1e-8 * C1
    assert stress(at) > stress(0.99 * at)
    assert stress(at) > stress(1.01 * at)
    assert ends.least == at


@pytest.mark.parametrize(
    "law",
    [
        NeoHookean(E),
        NeoHookean(E, 0.3),
        Gent(E, Jm=20.0),
        MooneyRivlin(E, C2_share=0.0),
        MooneyRivlin(E, C2_share=0.125),
        MooneyRivlin(E, C2_share=1.0),
        Yeoh(E, C2_ratio=0.0, C3_ratio=0.0),
        Yeoh(E, C2_ratio=0.18, C3_ratio=0.0),
        Yeoh(E, C2_ratio=-0.02, C3_ratio=0.001),
    ],
    ids=lambda law: law.text[:60],
)
def test_what_rises_for_ever_has_no_end(law: Isotropic) -> None:
    assert law.stretch_range == (math.inf,) * 3
    assert law.most_stretch == math.inf
    assert "rises" not in law.text
    assert RigidSection(E, 1e3).most_stretch == math.inf


def hill(law: Isotropic, stretch: float, other: float) -> float:
    """Least second derivative of W by the logarithms of two stretches, by differences [kPa]."""

    def energy(a: float, b: float) -> float:
        C = np.exp(2 * np.array([[a, b, -a - b, 0, 0, 0]]))
        C[:, 3:] = 0
        return float(law.energy(C)[0])

    a, b, h = math.log(stretch), math.log(other), 1e-4
    near = (energy(a + h, b) - 2 * energy(a, b) + energy(a - h, b)) / h**2
    far = (energy(a, b + h) - 2 * energy(a, b) + energy(a, b - h)) / h**2
    both = energy(a + h, b + h) - energy(a + h, b - h) - energy(a - h, b + h)
    both = (both + energy(a - h, b - h)) / (4 * h**2)
    return float(np.linalg.eigvalsh([[near, both], [both, far]])[0])


ratios = st.floats(-0.3, 0.3)


@given(ratios, st.floats(-0.05, 0.05), st.floats(0.0, 0.97), st.floats(-0.5, 1.0))
def test_within_its_range_a_cubic_is_stable(
    second: float, third: float, share: float, t: float
) -> None:
    """Also between the three tests: the largest stretch λ, another λᵗ."""
    law = Yeoh(E, C2_ratio=second, C3_ratio=third)
    stretch = min(law.most_stretch, 6.0) ** share
    assert hill(law, stretch, stretch**t) > 0


@given(st.floats(-2.0, 2.0), st.floats(0.0, 0.97), st.floats(-0.5, 1.0))
def test_within_its_range_mooney_rivlin_is_stable(share: float, part: float, t: float) -> None:
    law = MooneyRivlin(E, C2_share=share)
    stretch = min(law.most_stretch, 6.0) ** part
    assume(stretch > 1)
    assert hill(law, stretch, stretch**t) > 0
