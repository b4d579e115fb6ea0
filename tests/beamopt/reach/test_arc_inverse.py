"""Pressures of points: found again, projected onto the box, as near as any on a fine grid."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from beamopt.base.arrays import FloatArray
from beamopt.reach.arc_inverse import arc_inverse
from beamopt.reach.inverse import inverse_by_differences
from beamopt.rod.arc import arc_tip_jacobian, arc_tips
from beamopt.rod.response import linear_response
from beamopt.scene.scene import load_scene
from beamopt.section.phenotype import phenotypes

LENGTH, HIGH = 100.0, 100.0
SCENE = load_scene("random-section")
STRAIGHT = np.zeros(3)


def matrix_of(seed: int) -> FloatArray:
    """B of a random section."""
    points = SCENE.random_points(np.random.default_rng([seed]))
    moments = phenotypes(SCENE.grid.build(), [points], 4).moments
    return linear_response(moments, 300.0).matrix[0]


def tips_of(matrix: FloatArray, pressures: FloatArray, rest: FloatArray = STRAIGHT) -> FloatArray:
    return arc_tips(pressures @ matrix.T + rest, LENGTH)


def inverse(
    matrix: FloatArray, points: FloatArray, rest: FloatArray = STRAIGHT
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Pressures, tips, distances."""
    pressures, tips = arc_inverse(matrix[None], rest, LENGTH, points, 0.0, HIGH)
    return pressures[0], tips[0], np.linalg.norm(tips[0] - points, axis=1)


pressure = st.one_of(st.sampled_from([0.0, HIGH]), st.floats(0.0, HIGH))


@given(st.integers(0, 60), st.lists(st.tuples(pressure, pressure, pressure), min_size=1))
def test_what_pressures_reach_is_reached(seed: int, wanted: list[tuple[float, ...]]) -> None:
    """Whatever the order of the points; pressures at an end of the box among them."""
    matrix = matrix_of(seed)
    points = tips_of(matrix, np.array(wanted))
    pressures, tips, distances = inverse(matrix, points)
    assert distances.max() < 1e-6
    assert pressures.min() >= 0
    assert pressures.max() <= HIGH
    np.testing.assert_allclose(tips_of(matrix, pressures), tips, rtol=0, atol=1e-10)


@given(st.integers(0, 60), st.tuples(pressure, pressure, pressure), st.floats(-0.02, 0.02))
def test_a_rest_curvature_counts(seed: int, wanted: tuple[float, ...], k1: float) -> None:
    matrix, rest = matrix_of(seed), np.array([0.0, k1, 0.004])
    points = tips_of(matrix, np.array([wanted]), rest)
    assert inverse(matrix, points, rest)[2].max() < 1e-6


outside = st.tuples(st.floats(-90, 90), st.floats(-90, 90), st.floats(40, 190))


@given(st.integers(0, 60), st.lists(outside, min_size=1, max_size=6))
def test_the_nearest_tip_has_no_way_down(seed: int, points: list[tuple[float, ...]]) -> None:
    """Karush–Kuhn–Tucker: the gradient is zero inside, and points out of the box at its ends."""
    matrix, at = matrix_of(seed), np.array(points)
    pressures, tips, distances = inverse(matrix, at)
    slopes = arc_tip_jacobian(pressures @ matrix.T, LENGTH) @ matrix * HIGH
    gradient = np.einsum("mxj,mx->mj", slopes, tips - at)
    scale = np.linalg.norm(slopes, axis=(1, 2)) * (distances + 1e-2)
    share = gradient / scale[:, None]
    low, high = pressures == 0, pressures == HIGH
    assert (np.abs(share[~low & ~high]) < 1e-5).all()
    assert (share[low] > -1e-5).all()
    assert (share[high] < 1e-5).all()


@pytest.mark.parametrize("seed", range(12))
def test_no_tip_of_a_fine_grid_is_nearer(seed: int) -> None:
    """51³ pressures, points inside and outside; the grid itself is as wide as `mesh`."""
    matrix = matrix_of(seed)
    axis = np.linspace(0, HIGH, 51)
    grid = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)
    tips = tips_of(matrix, grid)
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(12, 3)) * [35, 35, 25] + [0, 0, 100]
    nearest = np.array([np.linalg.norm(tips - point, axis=1).min() for point in points])
    distances = inverse(matrix, points)[2]
    assert (distances <= nearest + 1e-9).all()
    mesh = np.linalg.norm(np.abs(matrix) @ np.full(3, 2.0) * [LENGTH, LENGTH**2, LENGTH**2])
    assert (distances >= nearest - mesh).all()


@pytest.mark.parametrize("seed", [7, 17])
def test_the_point_before_is_not_the_only_start(seed: int) -> None:
    """A soft actuator that curls up, and points far away: there are other minima."""
    matrix = 4 * matrix_of(seed)
    far = np.random.default_rng(seed).normal(size=(20, 3)) * [60, 60, 40] + [0, 0, 80]
    alone = np.concatenate([inverse(matrix, point[None])[2] for point in far])
    for k in range(6):
        after = [inverse(matrix, np.stack([far[k], point]))[2][1] for point in far]
        assert (np.array(after) <= alone + 1e-6).all()


def test_candidates_and_points_do_not_depend_on_the_others() -> None:
    """Candidates at all; points where each has one answer."""
    matrices = np.stack([matrix_of(k) for k in range(5)])
    points = tips_of(matrices[0], np.random.default_rng(1).uniform(10, 90, (9, 3)))
    together = arc_inverse(matrices, STRAIGHT, LENGTH, points, 0.0, HIGH)
    for k, matrix in enumerate(matrices):
        alone = arc_inverse(matrix[None], STRAIGHT, LENGTH, points, 0.0, HIGH)
        np.testing.assert_array_equal(alone[0][0], together[0][k])
        np.testing.assert_array_equal(alone[1][0], together[1][k])


def test_a_supply_without_chambers_and_no_material() -> None:
    """What does nothing is left where it is; what is not finite gives nothing."""
    matrix = matrix_of(0) * [1.0, 1.0, 0.0]
    points = tips_of(matrix, np.array([[20.0, 70.0, 0.0]]))
    assert inverse(matrix, points)[2].max() < 1e-6
    assert inverse(np.zeros((3, 3)), points)[2] == pytest.approx(
        np.linalg.norm(points - [0, 0, LENGTH], axis=1)
    )
    pressures, tips, _ = inverse(np.full((3, 3), np.nan), points)
    assert np.isnan(pressures).all()
    assert np.isnan(tips).all()


@settings(max_examples=10)
@given(st.integers(0, 60), st.lists(outside, min_size=1, max_size=5))
def test_differences_find_the_same(seed: int, points: list[tuple[float, ...]]) -> None:
    """The way of the other rungs on an arc, for points inside and outside."""
    matrix = matrix_of(seed)
    at = np.array([*points, *tips_of(matrix, np.array([[30.0, 60.0, 10.0], [0.0, 100.0, 55.0]]))])
    exact = inverse(matrix, at)[2]
    _, tips = inverse_by_differences(lambda p: tips_of(matrix, p), at, 0.0, HIGH)
    np.testing.assert_allclose(np.linalg.norm(tips - at, axis=1), exact, rtol=1e-4, atol=1e-3)


def test_differences_without_tips() -> None:
    """Where some pressures have no tip the others are searched; where none has, there is none."""
    matrix = matrix_of(0)

    def half(pressures: FloatArray) -> FloatArray:
        tips = tips_of(matrix, pressures)
        tips[pressures.sum(axis=1) > 200] = np.nan
        return tips

    inside = np.array([[20.0, 40.0, 10.0], [60.0, 60.0, 60.0]])
    points = tips_of(matrix, inside)
    pressures, tips = inverse_by_differences(half, points, 0.0, HIGH)
    np.testing.assert_allclose(tips, points, rtol=0, atol=1e-3)
    pressures, tips = inverse_by_differences(lambda p: p * np.nan, points, 0.0, HIGH)
    assert np.isnan(pressures).all()
    assert np.isnan(tips).all()
