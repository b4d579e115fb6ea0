"""Flips of types: proposals of a model, a microsecond each."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray, LabelArray
from beamopt.base.compiled import compiled, inlined
from beamopt.refine.arc_loss import ArcAim, arc_loss
from beamopt.refine.fragments import Fragments, kinds_of, moments_of_kinds, retyped
from beamopt.refine.orbits import Orbits

__all__ = ["Flips", "walk"]


class Flips(NamedTuple):
    """What flipping types can do.

    fragments : of the section. edges (m, 2) : neighbours; those of point k are
    `neighbours[begin[k]:begin[k + 1]]`. orbits : points that flip together.
    neighbour_weight : λ of the second objective.
    """

    fragments: Fragments
    edges: IndexArray
    begin: IndexArray
    neighbours: IndexArray
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
    fragments, members = flips.fragments, flips.orbits.members
    kinds = kinds_of(fragments, types)
    raw = moments_of_kinds(fragments, kinds) + added
    before = np.empty((4, 6))
    different = _different(types, flips)
    images, count = members.shape[1], flips.edges.shape[0]
    for k in range(draws.shape[0]):
        generator, new = _random_flip(types, flips, draws[k, 0], draws[k, 1], draws[k, 2])
        old = types[members[generator, 0]]
        if new == old:
            continue
        # as good as this is accepted; most flips are not, by their neighbours alone
        limit = total - temperature * np.log(draws[k, 3]) if draws[k, 3] > 0 else np.inf
        for image in range(images):
            types[members[generator, image]] = flips.orbits.types[image, new]
        if images > 1:  # some may be neighbours
            now = _different(types, flips)
        else:
            now, point = different, members[generator, 0]
            for at in range(flips.begin[point], flips.begin[point + 1]):
                near = types[flips.neighbours[at]]
                now += (near != new) - (near != old)
        second = flips.neighbour_weight * now / max(count - now, 1)
        accepted = second <= limit
        if accepted:
            before[:] = raw
            for image in range(images):
                retyped(fragments, types, kinds, raw, members[generator, image])
            first = arc_loss(raw, aim, limit - second)
            if first + second <= limit:
                total, different = first + second, now
                continue
        for image in range(images):
            types[members[generator, image]] = flips.orbits.types[image, old]
        if accepted:
            for image in range(images):
                retyped(fragments, types, kinds, raw, members[generator, image])
            raw[:] = before
    return float(total)


@inlined
def _different(types: LabelArray, flips: Flips) -> int:
    """Edges between different types."""
    different = 0
    for e in range(flips.edges.shape[0]):
        different += types[flips.edges[e, 0]] != types[flips.edges[e, 1]]
    return different


@inlined
def _random_flip(
    types: LabelArray, flips: Flips, way: float, where: float, what: float
) -> tuple[int, int]:
    count = flips.edges.shape[0]
    if way < 0.5 or count == 0:
        generator, new = int(where * flips.orbits.members.shape[0]), int(what * 4)
    else:
        e, side = int(where * count), int(what * 2)
        point, wanted = flips.edges[e, side], types[flips.edges[e, 1 - side]]
        generator, image = flips.orbits.generator[point], flips.orbits.image[point]
        new = 0
        for one in range(4):
            if flips.orbits.types[image, one] == wanted:
                new = one
    return generator, new
