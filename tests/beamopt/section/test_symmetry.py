"""Symmetric sections: their images are a group, and what follows for moments and tips."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beamopt.base.arrays import FloatArray, LabelArray
from beamopt.rod.arc import arc_tips
from beamopt.rod.response import linear_response
from beamopt.section.cross_section import CrossSection
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.phenotype import phenotypes
from beamopt.section.seal import UNSEALED, SealRules
from beamopt.section.symmetry import Symmetry, mirror_symmetry, threefold_symmetry
from beamopt.target.workspace import pressure_grid

GRID = PolarGrid(radial=32, angular=120)
SYMMETRIES = {"mirror": mirror_symmetry(), "three-fold": threefold_symmetry(GRID)}
SEALED = SealRules(1.0, 0.9, 0.5, 3.0, True)
PRESSURES = pressure_grid((0.0, 50.0, 100.0))

each_symmetry = pytest.mark.parametrize("symmetry", SYMMETRIES.values(), ids=SYMMETRIES)


def anywhere(seed: int, count: int = 40) -> FeaturePoints:
    """Points that are on no element's centroid, so that no element is equally far from two."""
    rng = np.random.default_rng(seed)
    r, phi = rng.uniform(10, 25, count), rng.uniform(0, 2 * np.pi, count)
    types = rng.choice(4, size=count, p=[0.5, 0.2, 0.15, 0.15])
    return FeaturePoints(r * np.cos(phi), r * np.sin(phi), types)


def assert_same(one: FeaturePoints, other: FeaturePoints) -> None:
    for name in ("x", "y", "type"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


@each_symmetry
def test_images_form_a_group(symmetry: Symmetry) -> None:
    """One after the other is again one of them, and each is undone by one."""

    def place(matrix: FloatArray, types: LabelArray) -> int:
        near = [
            k
            for k, (m, t) in enumerate(symmetry.images)
            if np.allclose(m, matrix, atol=1e-15) and np.array_equal(t, types)
        ]
        assert len(near) == 1
        return near[0]

    assert place(np.eye(2), np.arange(4, dtype=np.uint8)) == 0
    table = [
        [place(b @ a, types_b[types_a]) for b, types_b in symmetry.images]
        for a, types_a in symmetry.images
    ]
    whole = list(range(len(symmetry.images)))
    assert all(sorted(row) == whole for row in table)


@given(st.integers(0, 2**32), st.sampled_from(list(SYMMETRIES)))
def test_symmetrised_twice_is_symmetrised(seed: int, name: str) -> None:
    symmetry = SYMMETRIES[name]
    once = symmetry.symmetrised(anywhere(seed))
    assert_same(symmetry.symmetrised(once), once)
    on_centroids = FeaturePoints.random(GRID, 50, np.random.default_rng(seed))
    once = symmetry.symmetrised(on_centroids)
    assert_same(symmetry.symmetrised(once), once)


@each_symmetry
def test_images_follow_the_generators_in_order(symmetry: Symmetry) -> None:
    points = anywhere(1)
    generators = symmetry.generators(points)
    whole = symmetry.expanded(generators)
    n = len(generators)
    assert len(whole) == n * len(symmetry.images)
    for k, (matrix, types) in enumerate(symmetry.images):
        part = slice(k * n, (k + 1) * n)
        x, y = matrix @ np.stack([generators.x, generators.y])
        np.testing.assert_array_equal(whole.x[part], x)
        np.testing.assert_array_equal(whole.y[part], y)
        np.testing.assert_array_equal(whole.type[part], types[generators.type])


def test_what_is_kept_and_what_it_becomes() -> None:
    points = FeaturePoints([20.0, 20.0, -15.0], [1.0, -1.0, 2.0], [1, 3, 2])
    mirrored = SYMMETRIES["mirror"].symmetrised(points)
    assert mirrored.y.tolist() == [1.0, 2.0, -1.0, -2.0]
    assert mirrored.type.tolist() == [1, 2, 1, 3]
    turned = SYMMETRIES["three-fold"].symmetrised(points)  # the second is at 357°, the third at 172
    np.testing.assert_allclose(np.degrees(turned.angles), [2.862, 122.862, 242.862], atol=1e-3)
    assert turned.type.tolist() == [1, 2, 3]


@each_symmetry
@pytest.mark.parametrize("angle", [0.0, 120.0, 180.0, 240.0, 360.0 - 1e-13, 120.0 - 1e-13])
def test_points_between_two_parts_are_counted_once(symmetry: Symmetry, angle: float) -> None:
    """On the mirror line or the axis there is none to keep; rounding never brings an image back."""
    phi = np.radians(angle)
    points = FeaturePoints([18 * np.cos(phi), 0.0], [18 * np.sin(phi), 0.0], [2, 2])
    once = symmetry.symmetrised(points)
    assert len(once) in (0, len(symmetry.images))
    assert_same(symmetry.symmetrised(once), once)


def test_a_point_where_the_first_third_begins_is_counted_once() -> None:
    """Its images are where the next thirds begin, but for rounding to either side."""
    for start in range(0, 360, 7):
        symmetry = threefold_symmetry(PolarGrid(start=start, stop=start + 360.0))
        for r in np.linspace(10, 25, 9):
            phi = np.radians(start)
            once = symmetry.symmetrised(FeaturePoints([r * np.cos(phi)], [r * np.sin(phi)], [1]))
            assert len(once) == 3
            assert_same(symmetry.symmetrised(once), once)


@each_symmetry
def test_folded_points_are_all_generators(symmetry: Symmetry) -> None:
    points = anywhere(2, 300)
    folded = symmetry.folded(points)
    assert_same(symmetry.generators(folded), folded)
    assert len(folded) == 300
    counts = np.bincount(folded.type, minlength=4)
    assert counts[0] == (points.type == 0).sum()
    np.testing.assert_allclose(
        np.hypot(folded.x, folded.y), np.hypot(points.x, points.y), rtol=1e-14
    )


@given(st.integers(0, 2**32), st.booleans())
def test_a_mirrored_raster_is_the_raster(seed: int, sealed: bool) -> None:
    points = SYMMETRIES["mirror"].symmetrised(anywhere(seed))
    labels = section(points, sealed).labels
    np.testing.assert_array_equal(np.array([0, 1, 3, 2])[labels[:, ::-1]], labels)


@given(st.integers(0, 2**32), st.booleans())
def test_a_turned_raster_is_the_raster(seed: int, sealed: bool) -> None:
    points = SYMMETRIES["three-fold"].symmetrised(anywhere(seed))
    labels = section(points, sealed).labels
    np.testing.assert_array_equal(np.array([0, 2, 3, 1])[np.roll(labels, 40, axis=1)], labels)


@given(st.integers(0, 2**32), st.booleans())
def test_moments_of_a_threefold_section(seed: int, sealed: bool) -> None:
    """No direction is better than another: I = ½ (I11 + I22) · 1, the centroid on the axis."""
    moments = section(SYMMETRIES["three-fold"].symmetrised(anywhere(seed)), sealed).moments
    inertia, area = moments.second_moments, moments.area
    mean = np.trace(inertia) / 2
    np.testing.assert_allclose(inertia, mean * np.eye(2), atol=1e-10 * mean)
    np.testing.assert_allclose(moments.centroid, 0, atol=1e-11)
    np.testing.assert_allclose(moments.chamber_areas, moments.chamber_areas[0], atol=1e-10 * area)


@given(st.integers(0, 2**32))
def test_moments_of_a_mirrored_section(seed: int) -> None:
    moments = section(SYMMETRIES["mirror"].symmetrised(anywhere(seed)), False).moments
    assert abs(moments.centroid[1]) < 1e-11
    assert abs(moments.second_moments[0, 1]) < 1e-10 * np.trace(moments.second_moments)


@pytest.mark.parametrize("name", SYMMETRIES)
@given(seed=st.integers(0, 2**32))
def test_the_workspace_has_the_symmetry(name: str, seed: int) -> None:
    """Pressures handed on from supply to supply move the tip to its image."""
    symmetry = SYMMETRIES[name]
    moments = section(symmetry.symmetrised(anywhere(seed)), False).moments
    response = linear_response(moments, 300.0)
    tips = arc_tips(response.strains(PRESSURES), 100.0)
    # a section of little material goes far, and rounding with it
    far = max(np.abs(tips).max() / 100, 1.0) ** 2
    for matrix, types in symmetry.images:
        handed = np.empty_like(PRESSURES)
        handed[:, types[1:].astype(int) - 1] = PRESSURES
        there = arc_tips(response.strains(handed), 100.0)
        np.testing.assert_allclose(there[:, :2], tips[:, :2] @ matrix.T, atol=1e-8 * far)
        np.testing.assert_allclose(there[:, 2], tips[:, 2], atol=1e-8 * far)


@each_symmetry
def test_the_share_that_differs(symmetry: Symmetry) -> None:
    """None of a symmetric section; else the elements whose image is of another type."""
    points = anywhere(5)
    whole = symmetry.symmetrised(points)
    found = phenotypes(GRID, [whole, points], 4, symmetry=symmetry).asymmetry
    assert found[0] == 0
    labels = section(points, False).labels
    shares = []
    for matrix, types in symmetry.images[1:]:
        x, y = np.einsum("ab,bij->aij", matrix, GRID.centroids)
        row, column, inside = GRID.elements_at(x, y)
        assert inside.all()
        shares.append((labels[row, column] != types[labels]).mean())
    assert found[1] == pytest.approx(np.mean(shares))


def section(points: FeaturePoints, sealed: bool) -> CrossSection:
    return CrossSection.from_points(
        GRID, points, 0 if sealed else 4, SEALED if sealed else UNSEALED
    )
