"""Thickness of material behind the walls of chambers, by rays along their normals."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray, IndexArray

__all__ = ["Thin", "thin_places"]

FAN = np.radians(8.0)  # between the rays from a sharp corner
MOST_RAYS = 30_000  # or nearly; walls of a micrometre would ask for millions
NOTHING = 1e-7  # mm; a hit this near is the ray's own corner


class Thin(NamedTuple):
    """Places where a ray from one wall meets another one, shorter than asked.

    thickness (n,) [mm]; middle (n, 2) of the ray [mm]; start, hit (n,) numbers of the two loops.
    """

    thickness: FloatArray
    middle: FloatArray
    start: IndexArray
    hit: IndexArray


def thin_places(
    loops: Sequence[FloatArray],
    below: float,
    spacing: float,
    opposed: float,
    around: float = 3.0,
) -> Thin:
    """Where the material between two walls is thinner than `below` [mm].

    Where two walls come nearest to each other the normal of one meets the other at the distance
    between them, so that rays every `spacing` [mm] and a fan of them at sharp corners find every
    neck, between two chambers or between two parts of one. The two sides of a corner of material
    are always near each other; so walls of one loop only count when they face each other
    (`opposed` is the least cosine between one's normal and the other's, reversed) or are far from
    each other along the loop: more than `around` times as far as across.

    loops : (n, 2) each, closed, material on the left [mm].
    """
    import shapely

    if not loops:
        return _nothing()
    a = np.concatenate(loops)
    b = np.concatenate([np.roll(loop, -1, axis=0) for loop in loops])
    owner = np.repeat(np.arange(len(loops)), [len(loop) for loop in loops])
    after = np.concatenate(
        [
            np.roll(np.arange(len(loop)), -1) + first
            for loop, first in zip(loops, _firsts(loops), strict=True)
        ]
    )
    along = b - a
    length = np.hypot(*along.T)
    spacing = max(spacing, length.sum() / MOST_RAYS)
    along /= np.maximum(length, NOTHING**2)[:, None]
    normal = np.stack([-along[:, 1], along[:, 0]], axis=1)
    origin, ray, source, neighbour = _rays(a, b, length, normal, after, spacing)
    tree = shapely.STRtree(shapely.linestrings(np.stack([a, b], axis=1)))
    lines = shapely.linestrings(np.stack([origin, origin + below * ray], axis=1))
    k, edge = tree.query(lines)
    other = (edge != source[k]) & (edge != neighbour[k])
    k, edge = k[other], edge[other]
    t, within = _crossing(origin[k], ray[k], a[edge], b[edge])
    good = within & (t > NOTHING) & (t < below)
    k, edge, t = k[good], edge[good], t[good]
    order = np.lexsort((edge, t, k))
    k, edge, t = k[order], edge[order], t[order]
    first = np.ones(k.size, dtype=np.bool_)
    first[1:] = k[1:] != k[:-1]
    k, edge, t = k[first], edge[first], t[first]
    facing = (ray[k] * normal[edge]).sum(axis=1) < -opposed
    # places along the loops, all in a row, of both ends of each ray
    before = np.cumsum(length) - length
    start = before[source[k]] + np.hypot(*(origin[k] - a[source[k]]).T)
    end = before[edge] + np.hypot(*(origin[k] + t[:, None] * ray[k] - a[edge]).T)
    total = np.bincount(owner, weights=length)[owner[edge]]
    way = np.minimum(np.abs(end - start), total - np.abs(end - start))
    facing |= (owner[source[k]] != owner[edge]) | (way > around * t)
    k, edge, t = k[facing], edge[facing], t[facing]
    middle = origin[k] + t[:, None] / 2 * ray[k]
    return Thin(t, middle, owner[source[k]], owner[edge])


def _nothing() -> Thin:
    none = np.zeros(0, dtype=np.int64)
    return Thin(np.zeros(0), np.zeros((0, 2)), none, none)


def _firsts(loops: Sequence[FloatArray]) -> IndexArray:
    return np.cumsum([0] + [len(loop) for loop in loops[:-1]])


def _rays(
    a: FloatArray,
    b: FloatArray,
    length: FloatArray,
    normal: FloatArray,
    after: IndexArray,
    spacing: float,
) -> tuple[FloatArray, FloatArray, IndexArray, IndexArray]:
    """Origins, directions, and the one or two edges that each ray starts on."""
    count = np.maximum(np.ceil(length / spacing), 1).astype(np.int64)
    edge = np.repeat(np.arange(len(a)), count)
    step = np.arange(edge.size) - np.repeat(np.cumsum(count) - count, count)
    share = ((step + 0.5) / count[edge])[:, None]
    # at a chamber's convex corner (the material turns right) the normals open into a fan
    m, n = normal, normal[after]
    turn = np.arctan2(m[:, 0] * n[:, 1] - m[:, 1] * n[:, 0], (m * n).sum(axis=1))
    fan = np.where(turn < 0, np.ceil(-turn / FAN), 0).astype(np.int64)
    corner = np.repeat(np.arange(len(a)), fan)
    step = np.arange(corner.size) - np.repeat(np.cumsum(fan) - fan, fan)
    angle = np.arctan2(m[corner, 1], m[corner, 0]) + turn[corner] * (step + 0.5) / fan[corner]
    return (
        np.concatenate([a[edge] + share * (b - a)[edge], b[corner]]),
        np.concatenate([normal[edge], np.stack([np.cos(angle), np.sin(angle)], axis=1)]),
        np.concatenate([edge, corner]),
        np.concatenate([edge, after[corner]]),
    )


def _crossing(
    origin: FloatArray, ray: FloatArray, a: FloatArray, b: FloatArray
) -> tuple[FloatArray, NDArray[np.bool_]]:
    """How far along its ray an edge is met, and whether it is."""
    e, w = b - a, a - origin
    cross = ray[:, 0] * e[:, 1] - ray[:, 1] * e[:, 0]
    safe = np.where(cross == 0, 1.0, cross)
    t = (w[:, 0] * e[:, 1] - w[:, 1] * e[:, 0]) / safe
    u = (w[:, 0] * ray[:, 1] - w[:, 1] * ray[:, 0]) / safe
    return t, (cross != 0) & (u >= 0) & (u <= 1)
