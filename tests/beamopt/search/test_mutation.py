import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from beamopt.search.variation import direct, mutate, weighted
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.neighbours import neighbour_edges


def random_points(seed: int, count: int = 60) -> FeaturePoints:
    return FeaturePoints.random(PolarGrid(), count, np.random.default_rng([seed]))


@given(st.integers(0, 10_000), st.sampled_from([direct, weighted]))
def test_only_ends_of_boundary_edges_change_and_they_do(seed: int, method) -> None:
    points = random_points(seed)
    mutant = mutate(points, method, 0.1, np.random.default_rng([seed, 1]))
    changed = np.flatnonzero(mutant.type != points.type)
    assert 1 <= len(changed) <= 6  # 0.1 · 60 edges; two edges may pick the same point
    edges = neighbour_edges(points)
    boundary = edges[points.type[edges[:, 0]] != points.type[edges[:, 1]]]
    assert set(changed) <= set(boundary.ravel())
    np.testing.assert_array_equal(mutant.x, points.x)


@given(st.integers(0, 10_000), st.sampled_from([direct, weighted]))
def test_the_new_type_is_a_neighbours(seed: int, method) -> None:
    points = random_points(seed)
    mutant = mutate(points, method, 0.1, np.random.default_rng([seed, 1]))
    edges = neighbour_edges(points)
    for k in np.flatnonzero(mutant.type != points.type):
        around = np.concatenate([edges[edges[:, 0] == k, 1], edges[edges[:, 1] == k, 0]])
        assert mutant.type[k] in points.type[around]


def test_weighted_draws_by_the_number_of_neighbours() -> None:
    """A material point among 5 neighbours of supply 1, 2 of supply 2 and one of material."""
    angle = np.radians(np.arange(8) * 45.0)
    around = [1, 1, 1, 1, 1, 2, 2, 0]
    points = FeaturePoints([0.0, *np.cos(angle)], [0.0, *np.sin(angle)], [0, *around])
    edges = neighbour_edges(points)
    rng = np.random.default_rng(0)
    drawn = [weighted(0, 1, points.type, edges, rng) for _ in range(7000)]
    counts = np.bincount(drawn, minlength=4)
    assert counts[0] == counts[3] == 0
    assert abs(counts[1] / 7000 - 5 / 7) < 0.025  # four standard deviations


def test_direct_copies_the_other_end() -> None:
    types = np.array([0, 3], dtype=np.uint8)
    assert direct(0, 1, types, np.array([[0, 1]]), np.random.default_rng(0)) == 3


def test_nothing_to_mutate() -> None:
    rng = np.random.default_rng(0)
    for points in (
        FeaturePoints([], [], []),
        FeaturePoints([1.0], [2.0], [1]),
        FeaturePoints([1.0, 2.0, 1.0], [2.0, 2.0, 5.0], [1, 1, 1]),
    ):
        np.testing.assert_array_equal(mutate(points, weighted, 1.0, rng).type, points.type)
