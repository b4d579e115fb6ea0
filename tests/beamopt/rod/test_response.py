"""Rest strains against the minimum of the rod's potential."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import minimize

from beamopt.base.arrays import FloatArray, LabelArray
from beamopt.rod.response import LinearResponse, linear_response
from beamopt.section.drawing import RingPiece, rasterise
from beamopt.section.grid import PolarGrid
from beamopt.section.moments import Moments, moments_of
from tests.beamopt.section.quadrature import element_points

GRID = PolarGrid(radial=5, angular=8)
E, G = 300.0, 100.0  # [kPa]


def random_labels(seed: int) -> LabelArray:
    return np.random.default_rng(seed).integers(4, size=GRID.shape).astype(np.uint8)


def one_chamber(first: float, last: float) -> Moments:
    """Supply 1 between two angles, r 13…22 mm."""
    grid = PolarGrid(radial=60, angular=120)
    return moments_of(grid, rasterise(grid, [RingPiece(1, (13.0, 22.0), (first, last))]))


@pytest.mark.parametrize("seed", range(4))
def test_strains_minimise_the_energy_of_the_fibres(seed: int) -> None:
    """The least ½ E ∫ e² dA − Σ P_i ∫ (1 + e) dA_i, e = ε + κ1 (y − c_y) − κ2 (x − c_x).

    The first integral goes over the material, the others over the chambers: volume per length. It
    is quadratic in (ε, κ1, κ2), so its minimum solves a linear system. No moment is used.
    """
    labels = random_labels(seed)
    x, y, w = element_points(GRID)
    solid = labels == 0
    c = np.array([(w * x)[solid].sum(), (w * y)[solid].sum()]) / w[solid].sum()
    modes = np.stack([np.ones_like(x), y - c[1], c[0] - x])
    m, wm = modes[:, solid].reshape(3, -1), w[solid].reshape(-1)
    stiffness = E * (m * wm) @ m.T
    pressures = np.random.default_rng(seed).uniform(0, 100, size=(5, 3))
    loads = [[(w * mode)[labels == k].sum() for mode in modes] for k in (1, 2, 3)]
    expected = np.linalg.solve(stiffness, (pressures @ np.array(loads)).T).T
    found = linear_response(moments_of(GRID, labels), E).strains(pressures)
    np.testing.assert_allclose(found, expected, rtol=1e-10, atol=1e-14)


def potential(moments: Moments, pressures: FloatArray, strains: FloatArray) -> float:
    """½ (v − e3)·K (v − e3) + ½ u·J u − Σ P_i A_i (v3 + (u × r_i)·e3), per unit length [mN].

    strains : v1, v2, v3 − 1, u1, u2, u3. Rows and columns 1, 2 of J are E times the full tensor.
    """
    shear, u = strains[:3], strains[3:]
    K = np.diag([G, G, E]) * moments.area
    J = np.zeros((3, 3))
    J[:2, :2] = E * moments.second_moments
    J[2, 2] = G * np.trace(moments.second_moments)
    areas = moments.chamber_areas
    arms = np.column_stack([moments.chamber_first_moments / areas[:, None], np.zeros(3)])
    volumes = areas * (1 + shear[2] + np.cross(u, arms)[:, 2])
    return float(shear @ K @ shear / 2 + u @ J @ u / 2 - pressures @ volumes)


@pytest.mark.parametrize("seed", range(3))
def test_strains_minimise_the_potential_of_the_rod(seed: int) -> None:
    """All six strains are free; at the minimum the rod neither shears nor twists."""
    moments = moments_of(GRID, random_labels(seed))
    pressures = np.array([80.0, 10.0, 35.0])
    # strain and curvature times 25 mm are of one size; so the minimiser sees a round bowl
    units = np.array([1, 1, 1, 1 / 25, 1 / 25, 1 / 25])
    scale = E * float(moments.area)
    result = minimize(
        lambda s: potential(moments, pressures, s * units) / scale, np.zeros(6), tol=1e-12
    )
    epsilon, k1, k2 = linear_response(moments, E).strains(pressures[None])[0]
    expected = np.array([0, 0, epsilon, k1, k2, 0]) / units
    # forward differences leave the minimum at about their step, 1.5e-8
    np.testing.assert_allclose(result.x, expected, atol=1e-6)


@given(st.integers(0, 2**32))
def test_principal_axes_give_the_same(seed: int) -> None:
    """κ = Q diag(1/(E I1), 1/(E I2)) Qᵀ Σ P_i A_i (r_i × e3)."""
    moments = moments_of(GRID, random_labels(seed))
    (i1, i2), axes = moments.principal
    x, y = moments.chamber_first_moments.T
    expected = axes @ np.diag([1 / i1, 1 / i2]) @ axes.T @ np.stack([y, -x]) / E
    found = linear_response(moments, E).matrix
    np.testing.assert_allclose(found[1:], expected, rtol=1e-9, atol=1e-14)
    np.testing.assert_allclose(found[0], moments.chamber_areas / (E * moments.area), rtol=1e-14)


def test_a_chamber_on_x_bends_about_minus_y() -> None:
    """It lies at r = (x, 0), r × e3 = (0, −x): κ2 < 0; it stretches as well."""
    strains = linear_response(one_chamber(-40, 40), E).strains(np.array([[50.0, 0, 0]]))[0]
    assert strains[0] > 0
    assert strains[2] < 0
    assert strains[1] == pytest.approx(0, abs=1e-12)


def test_a_chamber_on_y_bends_about_x() -> None:
    strains = linear_response(one_chamber(50, 130), E).strains(np.array([[50.0, 0, 0]]))[0]
    assert strains[0] > 0
    assert strains[1] > 0
    assert strains[2] == pytest.approx(0, abs=1e-12)


def test_a_round_chamber_only_stretches() -> None:
    """ε = P A1 / (E A)."""
    strains = linear_response(one_chamber(0, 360), E).strains(np.array([[50.0, 70, 90]]))[0]
    moments = one_chamber(0, 360)
    expected = 50.0 * moments.chamber_areas[0] / (E * moments.area)
    np.testing.assert_allclose(strains, [expected, 0, 0], rtol=1e-12, atol=1e-12)


@given(st.integers(0, 2**32), st.floats(1e-3, 1e3))
def test_only_pressure_over_modulus_counts(seed: int, factor: float) -> None:
    moments = moments_of(GRID, random_labels(seed))
    pressures = np.array([[10.0, 20.0, 70.0]])
    a = linear_response(moments, E).strains(pressures)
    b = linear_response(moments, factor * E).strains(factor * pressures)
    np.testing.assert_allclose(b, a, rtol=1e-13)


def test_a_larger_section_bends_less() -> None:
    """Lengths times s: ε stays, κ goes with 1/s."""
    labels = random_labels(5)
    small = linear_response(moments_of(GRID, labels), E).matrix
    big = linear_response(moments_of(PolarGrid(20.0, 50.0, *GRID.shape), labels), E).matrix
    np.testing.assert_allclose(big, small / np.array([[1], [2], [2]]), rtol=1e-10, atol=1e-16)


def test_strains_add_up() -> None:
    response = linear_response(moments_of(GRID, random_labels(6)), E)
    p = np.random.default_rng(6).uniform(0, 100, size=(2, 1, 3))
    total = response.strains(p[0]) + response.strains(p[1])
    np.testing.assert_allclose(response.strains(p[0] + p[1]), total, rtol=1e-12, atol=1e-16)
    np.testing.assert_array_equal(response.strains(np.zeros((1, 3))), np.zeros((1, 3)))


def test_a_batch_equals_one_by_one() -> None:
    single = [moments_of(GRID, random_labels(seed)) for seed in range(6)]
    batch = Moments(np.stack([m.raw for m in single]).reshape(2, 3, 4, 6))
    pressures = np.random.default_rng(7).uniform(0, 100, size=(4, 3))
    response = linear_response(batch, E)
    assert response.matrix.shape == (2, 3, 3, 3)
    strains = response.strains(pressures)
    assert strains.shape == (2, 3, 4, 3)
    expected = [linear_response(m, E).strains(pressures) for m in single]
    np.testing.assert_allclose(strains.reshape(6, 4, 3), expected, rtol=1e-14)


def test_a_section_without_material_has_no_finite_response() -> None:
    """And no warning: a batch goes on."""
    full = np.full(GRID.shape, 1, dtype=np.uint8)
    matrix = linear_response(moments_of(GRID, full), E).matrix
    assert np.isnan(matrix).all()


def test_any_matrix_may_be_a_response() -> None:
    matrix = np.arange(9.0).reshape(3, 3)
    found = LinearResponse(matrix).strains(np.eye(3))
    np.testing.assert_array_equal(found, matrix.T)  # a column a supply
