"""Flips of types: proposals of a model, a microsecond each."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from beamopt.arrays import FloatArray, IndexArray, LabelArray
from beamopt.compiled import compiled
from beamopt.refine.arc_loss import ArcAim, arc_loss
from beamopt.refine.fragments import Fragments, kinds_of, moments_of_kinds, retype
from beamopt.refine.orbits import Orbits

__all__ = ["Flips", "flip", "walk"]


class Flips(NamedTuple):
    """What flipping types can do.

    fragments : of the section. edges (m, 2) : neighbours. orbits : points that flip together.
    neighbour_weight : λ of the second objective.
    """

    fragments: Fragments
    edges: IndexArray
    orbits: Orbits
    neighbour_weight: float


@compiled
def walk(
    types: LabelArray,
    added: FloatArray,
    total: float,
    temperature: float,
    flips: Flips,
    aim: ArcAim,
    draws: FloatArray,
) -> float:
    """A Metropolis chain of the model at `temperature` [mm²], in place; returns its last T.

    A flip gives a random feature point the type of a random neighbour, or every other time any.
    The rule is Metropolis's as if flips were as likely as their reverse, which those towards
    neighbours are not: chains lean towards cells that hang together.

    types (n,). added (4, 6) : what the model leaves out of the moments, as last judged.
    total : T there. draws (proposals, 4) : random numbers in [0, 1).
    """
    kinds = kinds_of(flips.fragments, types)
    raw = moments_of_kinds(flips.fragments, kinds) + added
    before = np.empty((4, 6))
    for draw in draws:
        generator, new = _random_flip(types, flips, draw)
        old = types[flips.orbits.members[generator, 0]]
        if new == old:
            continue
        before[:] = raw
        flip(types, kinds, raw, generator, new, flips)
        ratio = _ratio(flips.edges, types)
        new_total = arc_loss(raw, aim) + flips.neighbour_weight * ratio
        if new_total <= total or draw[3] < np.exp((total - new_total) / temperature):
            total = new_total
        else:
            flip(types, kinds, raw, generator, old, flips)
            raw[:] = before
    return total


@compiled
def flip(
    types: LabelArray, kinds: LabelArray, raw: FloatArray, generator: int, new: int, flips: Flips
) -> None:
    """Give a generator another type and its images theirs, in place: O(1) in the moments."""
    for image in range(flips.orbits.members.shape[1]):
        types[flips.orbits.members[generator, image]] = flips.orbits.types[image, new]
    for image in range(flips.orbits.members.shape[1]):
        retype(flips.fragments, types, kinds, raw, flips.orbits.members[generator, image])


@compiled
def _random_flip(types: LabelArray, flips: Flips, draw: FloatArray) -> tuple[int, int]:
    count = flips.edges.shape[0]
    if draw[0] < 0.5 or count == 0:
        generator = int(draw[1] * flips.orbits.members.shape[0])
        return generator, int(draw[2] * 4)
    edge = flips.edges[int(draw[1] * count)]
    side = int(draw[2] * 2)
    point, wanted = edge[side], types[edge[1 - side]]
    image = flips.orbits.image[point]
    for new in range(4):
        if flips.orbits.types[image, new] == wanted:
            return flips.orbits.generator[point], new
    return flips.orbits.generator[point], wanted


@compiled
def _ratio(edges: IndexArray, types: LabelArray) -> float:
    """Edges between different types over edges between equal ones; see `neighbour_ratio`."""
    different = 0
    for e in range(edges.shape[0]):
        different += types[edges[e, 0]] != types[edges[e, 1]]
    return float(different / max(edges.shape[0] - different, 1))
