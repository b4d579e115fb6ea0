"""The order in which 27 pressure combinations are solved, and what each is predicted from."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import numpy as np

__all__ = ["Node", "Prediction", "all_nodes", "ancestors", "prediction"]

Node = tuple[int, int, int]
"""Indices (0…2) of the pressure levels of supplies 1, 2, 3."""

Prediction = list[tuple[float, Node | int]]
"""Terms whose sum predicts a node's shape: a factor and a solved node, or a supply (1…3), for the
change of the unloaded body's shape with that supply's pressure [1/kPa]."""


def all_nodes() -> list[Node]:
    """All nodes, those with fewer steps from the first one earlier."""
    nodes = [(i, j, k) for i, j, k in product(range(3), range(3), range(3))]
    return sorted(nodes, key=lambda node: (sum(node), node))


def prediction(node: Node, levels: tuple[float, float, float]) -> Prediction:
    """What the shape at a node is predicted from, the first term's node being the nearest.

    With two supplies raised above their lowest level the step along one is taken from where the
    other is one lower; with one supply raised twice, it is extrapolated along its own line; the
    first steps follow the tangent at rest. All parents have fewer steps, so that the nodes form a
    tree that does not depend on how many are solved at once.
    """
    raised = [axis for axis in range(3) if node[axis] > 0]
    if len(raised) >= 2:
        a, b = raised[:2]
        both = _lower(_lower(node, a), b)
        return [(1.0, _lower(node, a)), (1.0, _lower(node, b)), (-1.0, both)]
    if not raised:
        return [(levels[0], supply) for supply in (1, 2, 3)]
    axis = raised[0]
    below = _lower(node, axis)
    step = levels[node[axis]] - levels[below[axis]]
    if node[axis] == 1:
        return [(1.0, below), (step, axis + 1)]
    ratio = step / (levels[1] - levels[0])
    return [(1.0 + ratio, below), (-ratio, _lower(below, axis))]


def ancestors(node: Node) -> Iterator[Node]:
    """The nodes on the way back to the first one, the nearest first."""
    while any(node):
        node = _lower(node, int(np.argmax(node)))
        yield node


def _lower(node: Node, axis: int) -> Node:
    i, j, k = (n - (axis == place) for place, n in enumerate(node))
    return (i, j, k)
