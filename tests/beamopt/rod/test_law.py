"""The section's law against the 6×6 stiffness that it is the half inverse of."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beamopt.base.arrays import FloatArray
from beamopt.rod.law import SectionLaw, cross, section_law
from beamopt.rod.rod import PointLoad, Rod, Segment
from beamopt.section.drawing import RingPiece, rasterise
from beamopt.section.grid import PolarGrid
from beamopt.section.moments import Moments, moments_of
from tests.beamopt.rod.samples import definite, solved, turned

seeds = st.integers(0, 2**32)
FREE = (0, 1, 2)


def half_inverted(stiffness: FloatArray) -> SectionLaw:
    J, S, K = stiffness[:3, :3], stiffness[:3, 3:], stiffness[3:, 3:]
    compliance = np.linalg.inv(K)
    coupling = S @ compliance
    return SectionLaw(J - coupling @ S.T, compliance, coupling, FREE)


def answers(law: SectionLaw, bent: FloatArray, force: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Moment, and v − v*."""
    moment = law.bending @ bent + law.coupling @ force
    return moment, law.compliance @ force - law.coupling.T @ bent


@given(seeds)
def test_it_is_the_stiffness_half_inverted(seed: int) -> None:
    rng = np.random.default_rng(seed)
    stiffness, strains = definite(rng, 6), rng.normal(size=6)
    moment, force = np.split(stiffness @ strains, 2)
    found = answers(half_inverted(stiffness), strains[:3], force)
    np.testing.assert_allclose(found[0], moment, atol=1e-12 * np.abs(stiffness).max())
    np.testing.assert_allclose(found[1], strains[3:], atol=1e-12 * np.abs(stiffness).max())


def energy(law: SectionLaw, bent: FloatArray, force: FloatArray) -> float:
    """½ (Δu·m + Δv·n); the coupling's parts cancel."""
    moment, along = answers(law, bent, force)
    return float(bent @ moment + along @ force) / 2


@given(seeds)
def test_about_another_axis_it_is_the_same_section(seed: int) -> None:
    """Same Δu and n; m gains c × n, v gains c × Δu; the energy stays."""
    rng = np.random.default_rng(seed)
    law, axis = half_inverted(definite(rng, 6)), rng.normal(size=2)
    bent, force = rng.normal(size=3), rng.normal(size=3)
    c = np.array([*axis, 0.0])
    here, there = answers(law, bent, force), answers(law.about(axis), bent, force)
    np.testing.assert_allclose(there[0] - here[0], np.cross(c, force), atol=1e-13)
    np.testing.assert_allclose(there[1] - here[1], np.cross(c, bent), atol=1e-13)
    assert energy(law.about(axis), bent, force) == pytest.approx(energy(law, bent, force))
    back = law.about(axis).about(-axis)
    np.testing.assert_allclose(back.coupling, law.coupling, atol=1e-14)


@given(seeds, st.floats(-7, 7))
def test_turned_it_answers_in_turned_axes(seed: int, angle: float) -> None:
    rng = np.random.default_rng(seed)
    law, R = half_inverted(definite(rng, 6)), turned(2, angle)
    bent, force = rng.normal(size=3), rng.normal(size=3)
    here, there = answers(law, bent, force), answers(law.turned(angle), R @ bent, R @ force)
    for one, other in zip(here, there, strict=True):
        np.testing.assert_allclose(other, R @ one, atol=1e-12)
    back = law.turned(angle).turned(-angle)
    for name in ("bending", "compliance", "coupling"):
        np.testing.assert_allclose(getattr(back, name), getattr(law, name), atol=1e-12)


@pytest.mark.parametrize("shift", [(0.0, 0.3), (-0.2, 0.1)])
def test_a_rod_about_another_axis_takes_the_same_shape(shift: tuple[float, float]) -> None:
    """Loads and tip are carried over to the new axis; rest strains v* = e3 − u* × c."""
    rng = np.random.default_rng(8)
    law, axis = half_inverted(definite(rng, 6)), np.array(shift)
    c = np.array([*axis, 0.0])  # the old axis, seen from the new one
    u = 0.3 * rng.normal(size=3)
    rest = np.array([*u, 0.0, 0.0, 1.0])
    end = PointLoad(force=rng.normal(size=3), at=np.array([0.1, 0.2, 0.0]))
    old = solved(Rod((Segment(1.5, law, rest, end=end),)), 16)
    moved = PointLoad(force=end.force, at=end.at + c)
    rest_there = np.array([*u, *(np.array([0.0, 0.0, 1.0]) - np.cross(u, c))])
    new = solved(Rod((Segment(1.5, law.about(axis), rest_there, end=moved),)), 16)
    there = new.tips[0] + new.rotations[0] @ c
    np.testing.assert_allclose(there, old.tips[0] + c, rtol=0, atol=1e-10)
    np.testing.assert_allclose(new.rotations, old.rotations, rtol=0, atol=1e-10)


@pytest.fixture(scope="module")
def moments() -> Moments:
    grid = PolarGrid(radial=20, angular=40)
    return moments_of(grid, rasterise(grid, [RingPiece(1, (13.0, 22.0), (-40.0, 40.0))]))


def test_of_moments(moments: Moments) -> None:
    """K = diag(κGA, κGA, EA), J = diag(EI, G I_T); κ = 1 and no twist unless asked for."""
    E, G, area = 300.0, 100.0, float(moments.area)
    law = section_law(moments, E, G)
    assert law.free == (0, 1)
    np.testing.assert_allclose(law.bending[:2, :2], E * moments.second_moments)
    np.testing.assert_allclose(np.linalg.inv(law.compliance), np.diag([G, G, E]) * area)
    assert not law.coupling.any()
    shear = np.array([[0.6, 0.05], [0.05, 0.5]]) * area
    law = section_law(moments, E, G, torsion_constant=7.0, shear_area=shear)
    assert law.free == FREE
    assert law.bending[2, 2] == pytest.approx(700.0)
    np.testing.assert_allclose(np.linalg.inv(law.compliance)[:2, :2], G * shear)


def test_a_force_through_the_shear_centre_does_not_twist(moments: Moments) -> None:
    """To first order; through the centroid it does."""
    centre = np.array([3.0, -2.0])
    law = section_law(moments, 300.0, 100.0, torsion_constant=2e3, shear_centre=centre)

    def twist(at: FloatArray) -> float:
        end = PointLoad(force=np.array([1e-3, 2e-3, 0.0]), at=at)
        R = solved(Rod((Segment(100.0, law, end=end),))).rotations[0]
        return float(R[1, 0])

    through_centroid = twist(np.zeros(3))
    assert abs(twist(np.array([*centre, 0.0]))) < 1e-4 * abs(through_centroid)
    # m3 = (−a × F)3 over G I_T: the force acts beside the shear centre
    expected = 100.0 * (-np.cross([*centre, 0.0], [1e-3, 2e-3, 0.0])[2]) / (100.0 * 2e3)
    assert through_centroid == pytest.approx(expected, rel=1e-3)


def test_the_matrix_of_a_cross_product() -> None:
    rng = np.random.default_rng(0)
    a, b = rng.normal(size=(2, 3))
    np.testing.assert_allclose(cross(a) @ b, np.cross(a, b), rtol=1e-15)
