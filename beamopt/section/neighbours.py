"""Which feature points are neighbours, and how many of those are of different types.

The second objective and the mutation look at the edges of the Delaunay triangulation (paper, Second
Objective and Mutation).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray, IndexArray
from beamopt.base.compiled import compiled
from beamopt.section.cell_owners import cell_owners
from beamopt.section.delaunay import delaunay_edges
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import Domain

__all__ = [
    "cell_neighbours",
    "count_edges",
    "neighbour_edges",
    "neighbour_ratio",
    "neighbours_of",
]


def neighbour_edges(points: FeaturePoints) -> IndexArray:
    """(m, 2) index pairs of neighbouring feature points, lower index first, sorted."""
    edges = delaunay_edges(points.x, points.y)
    return edges[np.lexsort((edges[:, 1], edges[:, 0]))]


@compiled
def cell_neighbours(px: FloatArray, py: FloatArray, domain: Domain) -> IndexArray:
    """(m, 2) index pairs of neighbours among the feature points that have a cell in `domain`.

    Lower index first, in no particular order.
    """
    own = cell_owners(px, py, domain)
    edges = delaunay_edges(px[own], py[own])
    for e in range(edges.shape[0]):
        edges[e, 0], edges[e, 1] = own[edges[e, 0]], own[edges[e, 1]]
    return edges


def neighbour_ratio(different: FloatArray, same: FloatArray) -> FloatArray:
    """Edges between different types over edges between equal types, r in K = λ r.

    Where no edge joins equal types the paper's r is undefined; one such edge is then counted, so
    that r stays finite and grows with the edges between different types. Without edges r is 0.
    """
    return np.asarray(different / np.maximum(same, 1.0))


@compiled
def count_edges(edges: IndexArray, types: NDArray[np.uint8]) -> tuple[int, int]:
    """How many edges join different types, and how many equal ones."""
    different = 0
    for e in range(edges.shape[0]):
        different += types[edges[e, 0]] != types[edges[e, 1]]
    return different, edges.shape[0] - different


@compiled
def neighbours_of(edges: IndexArray, count: int) -> tuple[IndexArray, IndexArray]:
    """Neighbours of point k: `neighbours[begin[k]:begin[k + 1]]`."""
    begin = np.zeros(count + 1, dtype=np.int64)
    for e in range(edges.shape[0]):
        begin[edges[e, 0] + 1] += 1
        begin[edges[e, 1] + 1] += 1
    for k in range(count):
        begin[k + 1] += begin[k]
    at = begin[:-1].copy()
    neighbours = np.empty(2 * edges.shape[0], dtype=np.int64)
    for e in range(edges.shape[0]):
        k, l = edges[e, 0], edges[e, 1]  # noqa: E741
        neighbours[at[k]] = l
        at[k] += 1
        neighbours[at[l]] = k
        at[l] += 1
    return begin, neighbours
