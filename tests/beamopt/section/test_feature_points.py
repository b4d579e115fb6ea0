"""The genotype: what it admits, and how it is drawn at random."""

from __future__ import annotations

from dataclasses import FrozenInstanceError

import numpy as np
import pytest

from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid


def some(count: int = 7, seed: int = 1) -> FeaturePoints:
    return FeaturePoints.random(PolarGrid(), count, np.random.default_rng(seed))


@pytest.mark.parametrize("grid", [PolarGrid(), PolarGrid(0.0, 3.0, 4, 5, -20.0, 77.0)])
def test_random_points_lie_on_centroids(grid: PolarGrid) -> None:
    points = FeaturePoints.random(grid, 200, np.random.default_rng(2))
    assert len(points) == 200
    centroids = set(zip(*grid.centroids.reshape(2, -1).tolist(), strict=True))
    assert set(zip(points.x.tolist(), points.y.tolist(), strict=True)) <= centroids


def test_random_points_are_even_over_rows_and_columns() -> None:
    """Counts of a multinomial sample: within five standard deviations √(n p (1 − p))."""
    grid = PolarGrid(radial=8, angular=10)
    n = 40_000
    points = FeaturePoints.random(grid, n, np.random.default_rng(3))
    row = np.searchsorted(grid.edges, np.hypot(points.x, points.y)) - 1
    _, column, _ = grid.elements_at(points.x, points.y)
    for index, count in ((row, 8), (column, 10), (row * 10 + column, 80)):
        found = np.bincount(index, minlength=count)
        p = 1 / count
        assert np.abs(found - n * p).max() < 5 * np.sqrt(n * p * (1 - p))


@pytest.mark.parametrize(
    ("keys", "shares"),
    [
        ({}, [1 / 2, 1 / 6, 1 / 6, 1 / 6]),
        ({"material_probability": 0.1}, [0.1, 0.3, 0.3, 0.3]),
        ({"material_probability": 1.0}, [1.0, 0.0, 0.0, 0.0]),
        ({"material_probability": 0.0}, [0.0, 1 / 3, 1 / 3, 1 / 3]),
    ],
)
def test_types_have_their_shares(keys: dict[str, float], shares: list[float]) -> None:
    n = 60_000
    points = FeaturePoints.random(PolarGrid(), n, np.random.default_rng(4), **keys)
    p = np.array(shares)
    found = np.bincount(points.type, minlength=4)
    # five standard deviations of a multinomial sample
    assert (np.abs(found - n * p) <= 5 * np.sqrt(n * p * (1 - p)) + 1e-6).all()


def test_the_same_seed_gives_the_same_points() -> None:
    assert some(seed=5).digest == some(seed=5).digest
    assert some(seed=5).digest != some(seed=6).digest


def test_angles_run_from_0_to_360_degrees() -> None:
    points = FeaturePoints([1, 0, -1, 0, 1], [0, 2, 0, -3, -1], [0] * 5)
    np.testing.assert_allclose(np.degrees(points.angles), [0, 90, 180, 270, 315])


def test_arrays_have_their_types_and_shape() -> None:
    points = FeaturePoints([1, 2], (3, 4), [0, 3.0])
    assert (points.x.dtype, points.y.dtype, points.type.dtype) == (float, float, np.uint8)
    assert len(points) == 2
    assert len(FeaturePoints([], [], [])) == 0


@pytest.mark.parametrize(
    ("x", "y", "type", "said"),
    [
        ([1, 2], [1], [0], "2, 1, 1 entries"),
        ([1], [1], [0, 1], "1, 1, 2 entries"),
        ([float("nan")], [1], [0], "finite"),
        ([1], [float("inf")], [0], "finite"),
        ([1], [1], [4], "type"),
        ([1], [1], [-1], "type"),
        ([1], [1], [1.5], "type"),
        ([1], [1], [256], "type"),  # would be 0 in a byte
        ([1], [1], [float("nan")], "type"),
    ],
)
def test_misuse(x: list[float], y: list[float], type: list[float], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        FeaturePoints(x, y, type)


@pytest.mark.parametrize("name", ["x", "y", "type"])
def test_points_do_not_change(name: str) -> None:
    points = some()
    with pytest.raises(ValueError, match="read-only"):
        getattr(points, name)[0] = 1
    with pytest.raises(FrozenInstanceError):
        setattr(points, name, getattr(points, name))


def test_points_do_not_change_with_the_arrays_they_were_made_from() -> None:
    x, y, kind = np.ones(3), np.ones(3), np.ones(3, dtype=np.uint8)
    points = FeaturePoints(x, y, kind)
    x[0] = y[0] = kind[0] = 2
    assert points.x[0] == points.y[0] == points.type[0] == 1


def test_taking_joins_some_of_these_and_some_of_others() -> None:
    a, b = some(5, 1), some(4, 2)
    own, theirs = np.array([1, 0, 0, 1, 1], dtype=bool), np.array([0, 1, 0, 1], dtype=bool)
    child = a.taking(own, b, theirs)
    np.testing.assert_array_equal(child.x, [*a.x[[0, 3, 4]], *b.x[[1, 3]]])
    np.testing.assert_array_equal(child.y, [*a.y[[0, 3, 4]], *b.y[[1, 3]]])
    np.testing.assert_array_equal(child.type, [*a.type[[0, 3, 4]], *b.type[[1, 3]]])
    assert len(a.taking(~own & own, b, ~theirs & theirs)) == 0


def test_with_types_keeps_the_places() -> None:
    points = some()
    other = points.with_types(np.full(7, 3, dtype=np.uint8))
    np.testing.assert_array_equal([other.x, other.y], [points.x, points.y])
    assert (other.type == 3).all()


def test_digest_tells_points_apart() -> None:
    base = FeaturePoints([1, 2], [3, 4], [0, 1])
    assert base.digest == FeaturePoints([1.0, 2.0], [3.0, 4.0], [0, 1]).digest
    assert len(bytes.fromhex(base.digest)) == 8
    others = [
        FeaturePoints([2, 1], [3, 4], [0, 1]),
        FeaturePoints([3, 4], [1, 2], [0, 1]),
        FeaturePoints([1, 2], [3, 4], [1, 0]),
        FeaturePoints([2, 1], [4, 3], [1, 0]),  # another order ties otherwise
        FeaturePoints([1, 2], [3, np.nextafter(4, 5)], [0, 1]),
        FeaturePoints([1], [3], [0]),
    ]
    assert len({points.digest for points in [base, *others]}) == 7
