"""Moments against closed forms in polar coordinates and against quadrature.

Sums over up to 46080 elements, of integrals taken as differences of primitives, are right to about
1e-12 of the whole ring's; tolerances are ten times that.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beamopt.base.arrays import FloatArray, LabelArray
from beamopt.section.grid import PolarGrid
from beamopt.section.moments import Moments, moments_of
from tests.beamopt.section.quadrature import element_points

NEAR = 1e-11


def random_labels(grid: PolarGrid, seed: int) -> LabelArray:
    return np.random.default_rng(seed).integers(4, size=grid.shape).astype(np.uint8)


def sector(inner: float, outer: float, first: float, last: float) -> FloatArray:
    """Integrals of {1, x, y, x², y², xy} over a piece of a ring, angles in degrees."""
    a, b = np.radians([first, last])
    r1, r2, r3 = ((outer**n - inner**n) / n for n in (2, 3, 4))
    double = (np.sin(2 * b) - np.sin(2 * a)) / 4
    return np.array(
        [
            r1 * (b - a),
            r2 * (np.sin(b) - np.sin(a)),
            r2 * (np.cos(a) - np.cos(b)),
            r3 * ((b - a) / 2 + double),
            r3 * ((b - a) / 2 - double),
            r3 * (np.cos(2 * a) - np.cos(2 * b)) / 4,
        ]
    )


def three_chambers() -> tuple[PolarGrid, LabelArray]:
    """Three chambers of 80°, r 13…22 mm; with 175 rows both radii are edges of the grid."""
    grid = PolarGrid(radial=175, angular=72)
    np.testing.assert_allclose(grid.edges[[23, 128]], [13.0, 22.0])
    labels = np.zeros(grid.shape, dtype=np.uint8)
    for k in range(3):
        labels[23:128, 2 + 24 * k : 18 + 24 * k] = k + 1  # 10°…90°, 130°…210°, 250°…330°
    return grid, labels


def test_full_ring() -> None:
    """A = π (R² − r²), I = π/4 (R⁴ − r⁴)."""
    grid = PolarGrid()
    moments = moments_of(grid, np.zeros(grid.shape, dtype=np.uint8))
    inertia = np.pi / 4 * (25.0**4 - 10.0**4)
    assert moments.area == pytest.approx(np.pi * 525, rel=NEAR)
    np.testing.assert_allclose(moments.centroid, 0, atol=25 * NEAR)
    np.testing.assert_allclose(moments.second_moments, inertia * np.eye(2), atol=inertia * NEAR)
    assert not moments.chamber_areas.any()
    assert not moments.chamber_first_moments.any()


def test_half_ring() -> None:
    """The upper half: ȳ = 4 (R³ − r³) / (3π (R² − r²)), I about its own centroid."""
    grid = PolarGrid(radial=20, angular=90)
    labels = np.zeros(grid.shape, dtype=np.uint8)
    labels[:, 45:] = 1
    moments = moments_of(grid, labels)
    area, quarter = np.pi / 2 * 525, np.pi / 8 * (25.0**4 - 10.0**4)
    height = 4 * (25.0**3 - 10.0**3) / (3 * np.pi * 525)
    assert moments.area == pytest.approx(area, rel=NEAR)
    np.testing.assert_allclose(moments.centroid, [0, height], rtol=NEAR, atol=25 * NEAR)
    expected = np.diag([quarter - area * height**2, quarter])
    np.testing.assert_allclose(moments.second_moments, expected, rtol=NEAR, atol=quarter * NEAR)
    np.testing.assert_allclose(moments.chamber_areas, [area, 0, 0], rtol=NEAR)
    # the chamber's centroid lies 2ȳ below the material's
    np.testing.assert_allclose(
        moments.chamber_first_moments,
        [[0, -2 * height * area], [0, 0], [0, 0]],
        rtol=NEAR,
        atol=area * 25 * NEAR,
    )


def test_three_chambers_of_80_degrees() -> None:
    grid, labels = three_chambers()
    moments = moments_of(grid, labels)
    chambers = [sector(13, 22, first, first + 80) for first in (10, 130, 250)]
    material = sector(10, 25, 0, 360) - sum(chambers)
    expected = np.array([material, *chambers])
    size = np.abs(expected).max(axis=0)
    np.testing.assert_allclose(moments.raw, expected, rtol=0, atol=size.max() * 1e-13)
    # threefold symmetry: centroid on the axis, round second moments
    polar = np.pi / 2 * (25.0**4 - 10.0**4) - 3 * np.radians(80) * (22.0**4 - 13.0**4) / 4
    np.testing.assert_allclose(moments.centroid, 0, atol=25 * NEAR)
    np.testing.assert_allclose(moments.second_moments, polar / 2 * np.eye(2), atol=polar * NEAR)
    arms = np.linalg.norm(moments.chamber_first_moments, axis=-1) / moments.chamber_areas
    lever = 2 / 3 * np.sin(np.radians(40)) / np.radians(40) * (22**3 - 13**3) / (22**2 - 13**2)
    np.testing.assert_allclose(arms, lever, rtol=NEAR)


@pytest.mark.parametrize(
    "grid",
    [
        PolarGrid(radial=7, angular=11),
        PolarGrid(0.0, 4.0, 3, 5),
        PolarGrid(2.0, 9.0, 6, 8, 100.0, 170.0),
        PolarGrid(radial=1, angular=1, stop=45.0),
    ],
    ids=["ring", "disc", "sector", "one-element"],
)
def test_any_labels_against_quadrature(grid: PolarGrid) -> None:
    x, y, w = element_points(grid)
    labels = random_labels(grid, 1)
    densities = np.stack([w, w * x, w * y, w * x * x, w * y * y, w * x * y], axis=-1).sum(axis=2)
    expected = np.stack([densities[labels == kind].sum(axis=0) for kind in range(4)])
    size = grid.area * np.array([1, *[grid.outer_radius] * 2, *[grid.outer_radius**2] * 3])
    np.testing.assert_allclose(moments_of(grid, labels).raw / size, expected / size, atol=1e-12)


def test_second_moments_are_those_about_the_material_centroid() -> None:
    """I11 = ∫ y², I22 = ∫ x², I12 = −∫ xy, with x and y from the centroid (Steiner)."""
    grid = PolarGrid(radial=6, angular=9)
    labels = random_labels(grid, 2)
    moments = moments_of(grid, labels)
    x, y, w = (part[labels == 0] for part in element_points(grid))
    np.testing.assert_allclose(moments.centroid, [(w * x).sum(), (w * y).sum()] / w.sum())
    x, y = x - moments.centroid[0], y - moments.centroid[1]
    i11, i22, i12 = (w * y * y).sum(), (w * x * x).sum(), -(w * x * y).sum()
    np.testing.assert_allclose(moments.second_moments, [[i11, i12], [i12, i22]], rtol=1e-11)


def test_material_along_the_diagonal_has_a_negative_product() -> None:
    """Around 45° xy is positive, so I12 = −∫ xy is negative; the stiff axis is at −45°."""
    grid = PolarGrid(radial=8, angular=8)
    labels = np.ones(grid.shape, dtype=np.uint8)
    labels[:, [0, 4]] = 0  # columns around 22.5° and 202.5°
    moments = moments_of(grid, labels)
    assert moments.second_moments[0, 1] < 0
    (weak, stiff), axes = moments.principal
    assert weak < stiff
    # bending about the line of the material itself is the weak one
    along = np.array([np.cos(np.radians(22.5)), np.sin(np.radians(22.5))])
    assert abs(axes[:, 0] @ along) == pytest.approx(1, rel=NEAR)


def test_principal_axes_diagonalise() -> None:
    grid = PolarGrid(radial=5, angular=24)
    raw = np.stack([moments_of(grid, random_labels(grid, seed)).raw for seed in range(6)])
    moments = Moments(raw)
    values, axes = moments.principal
    assert (values[:, 0] <= values[:, 1]).all()
    rebuilt = np.einsum("nij,nj,nkj->nik", axes, values, axes)
    size = moments.second_moments.max()
    np.testing.assert_allclose(rebuilt, moments.second_moments, atol=size * 1e-13)


@given(st.integers(0, 2**32), st.integers(1, 11))
def test_turning_a_section_turns_its_moments(seed: int, columns: int) -> None:
    """Rotation by Q: c → Q c, I → Q I Qᵀ, A r → A Q r."""
    grid = PolarGrid(radial=4, angular=12)
    labels = random_labels(grid, seed)
    labels[0, 0] = 0  # some material
    angle = columns * 2 * np.pi / 12
    Q = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    a = moments_of(grid, labels)
    b = moments_of(grid, np.roll(labels, columns, axis=1))
    inertia = a.second_moments
    size = np.pi * 25.0**4
    np.testing.assert_allclose(b.area, a.area, rtol=NEAR)
    np.testing.assert_allclose(b.centroid, Q @ a.centroid, atol=25 * NEAR)
    np.testing.assert_allclose(b.second_moments, Q @ inertia @ Q.T, atol=size * NEAR)
    turned = a.chamber_first_moments @ Q.T
    np.testing.assert_allclose(b.chamber_first_moments, turned, atol=525 * 25 * NEAR)


@given(st.integers(0, 2**32))
def test_types_share_the_ring(seed: int) -> None:
    """Moments are additive: all types together are the ring."""
    grid = PolarGrid(radial=9, angular=14, start=30.0, stop=200.0)
    total = moments_of(grid, random_labels(grid, seed)).raw.sum(axis=0)
    np.testing.assert_allclose(total, sector(10, 25, 30, 200), rtol=NEAR)


def test_a_batch_equals_one_by_one() -> None:
    grid = PolarGrid(radial=6, angular=10)
    single = [moments_of(grid, random_labels(grid, seed)) for seed in range(6)]
    batch = Moments(np.stack([m.raw for m in single]).reshape(2, 3, 4, 6))
    for name in (
        "area",
        "centroid",
        "second_moments",
        "chamber_areas",
        "chamber_first_moments",
    ):
        one_by_one = np.stack([getattr(m, name) for m in single])
        together = getattr(batch, name)
        assert together.shape == (2, 3, *one_by_one.shape[1:])
        np.testing.assert_array_equal(together.reshape(one_by_one.shape), one_by_one)
    values, axes = batch.principal
    assert values.shape == (2, 3, 2)
    assert axes.shape == (2, 3, 2, 2)


def test_without_material_the_centroid_is_not_a_number() -> None:
    """A batch goes on without a warning (warnings are errors here)."""
    grid = PolarGrid(radial=3, angular=4)
    none = moments_of(grid, np.full(grid.shape, 2, dtype=np.uint8))
    some = moments_of(grid, random_labels(grid, 3))
    batch = Moments(np.stack([none.raw, some.raw]))
    assert batch.area[0] == 0
    assert np.isnan(batch.centroid[0]).all()
    assert np.isnan(batch.second_moments[0]).all()
    assert np.isnan(batch.chamber_first_moments[0]).all()
    np.testing.assert_allclose(batch.chamber_areas[0], [0, grid.area, 0])
    np.testing.assert_array_equal(batch.centroid[1], some.centroid)
