"""Changing types at boundaries between cells of different types (paper, Mutation)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from beamopt.base.arrays import IndexArray, LabelArray
from beamopt.section.feature_points import SUPPLIES, FeaturePoints
from beamopt.section.neighbours import neighbour_edges

__all__ = ["MUTATIONS", "direct", "mutate", "weighted"]

NewType = Callable[[int, int, LabelArray, IndexArray, np.random.Generator], int]


def mutate(
    points: FeaturePoints, new_type: NewType, share: float, rng: np.random.Generator
) -> FeaturePoints:
    """Change the type of one end of `share`·n random edges that join different types.

    Every change looks at the types before the mutation, so that each one is a change; where two
    edges pick the same feature point, the later one stays. Fewer such edges than asked for: all.
    """
    edges = neighbour_edges(points)
    boundary = edges[points.type[edges[:, 0]] != points.type[edges[:, 1]]]
    count = min(round(share * len(points)), len(boundary))
    types = points.type.copy()
    for edge in rng.choice(len(boundary), count, replace=False) if count else ():
        side = int(rng.integers(2))
        selected, other = int(boundary[edge, side]), int(boundary[edge, 1 - side])
        types[selected] = new_type(selected, other, points.type, edges, rng)
    return points.with_types(types)


def direct(
    selected: int, other: int, types: LabelArray, edges: IndexArray, rng: np.random.Generator
) -> int:
    """The type of the feature point at the other end of the edge."""
    return int(types[other])


def weighted(
    selected: int, other: int, types: LabelArray, edges: IndexArray, rng: np.random.Generator
) -> int:
    """A type drawn by how many neighbours have it; the selected point's own is not counted."""
    around = np.concatenate([edges[edges[:, 0] == selected, 1], edges[edges[:, 1] == selected, 0]])
    counts = np.bincount(types[around], minlength=len(SUPPLIES) + 1)
    counts[types[selected]] = 0
    return int(rng.choice(counts.size, p=counts / counts.sum()))


MUTATIONS: dict[str, NewType] = {"direct": direct, "weighted": weighted}
