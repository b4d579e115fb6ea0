"""Edges between equal and between different types."""

from __future__ import annotations

import numpy as np

from beamopt.section.delaunay import delaunay_edges
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.neighbours import count_edges, neighbour_edges, neighbour_ratio


def test_edges_come_sorted() -> None:
    points = FeaturePoints.random(PolarGrid(), 60, np.random.default_rng(8))
    edges = neighbour_edges(points).tolist()
    assert edges == sorted(delaunay_edges(points.x, points.y).tolist())


def test_edges_are_counted_by_type() -> None:
    edges = np.array([[0, 1], [1, 2], [0, 3], [2, 3]])
    assert count_edges(edges, np.array([0, 0, 2, 3], dtype=np.uint8)) == (3, 1)
    assert count_edges(edges, np.array([1, 1, 1, 1], dtype=np.uint8)) == (0, 4)
    assert count_edges(edges[:0], np.array([1], dtype=np.uint8)) == (0, 0)


def test_ratio_of_different_to_equal() -> None:
    found = neighbour_ratio(np.array([6.0, 3.0, 0.0]), np.array([4.0, 6.0, 5.0]))
    np.testing.assert_array_equal(found, [1.5, 0.5, 0.0])


def test_ratio_without_equal_edges_counts_one() -> None:
    found = neighbour_ratio(np.array([0.0, 1.0, 7.0]), np.zeros(3))
    np.testing.assert_array_equal(found, [0.0, 1.0, 7.0])
