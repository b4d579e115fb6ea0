"""A smooth loop resampled to edges as long as its curvature allows."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from beamopt.arrays import FloatArray, IndexArray

__all__ = ["resample"]

CORNER = np.radians(20.0)  # sharper turns of the smooth loop are corners, and stay
LONGEST, SHORTEST = 4.0, 0.25  # mm, edges in a ring of 25 mm
SPACING = 0.05  # mm between places where curvature is measured
WINDOW = 0.3  # mm to either side that it is averaged over
GRADING = 0.7  # growth of edge length along the loop
FEWEST = 6  # edges of a loop


def resample(points: FloatArray, sagitta: float, unit: float = 1.0) -> FloatArray:
    """(m, 2) vertices on a smooth loop (n, 2) [mm], its chords at most `sagitta` off it.

    Edges are √(8 R s) long where the curve's radius is R, at most 4 mm and where it can be at
    least 0.25 mm, both times `unit`; lengths change gradually along the loop.
    """
    loop = _without_repeats(points)
    dense, length, turning, vertex = _dense(loop, SPACING * unit)
    corner = vertex & (np.abs(turning) > CORNER)
    size = _sizes(length, np.where(corner, 0.0, turning), sagitta, unit)
    start = int(np.flatnonzero(corner)[0]) if corner.any() else int(np.argmin(size))
    dense, length, size, corner = (
        np.roll(a, -start, axis=0) for a in (dense, length, size, corner)
    )
    arc = np.concatenate([[0.0], np.cumsum(length)])
    closed = np.concatenate([dense, dense[:1]])
    # ∫ ds/h, between whose whole numbers (stretched, from corner to corner) the edges lie
    inverse = 1 / np.concatenate([size, size[:1]])
    count = np.concatenate([[0.0], np.cumsum((inverse[1:] + inverse[:-1]) / 2 * length)])
    fixed = np.unique(np.concatenate([[0], np.flatnonzero(corner), [len(dense)]]))
    least = -(-FEWEST // (len(fixed) - 1))
    stretches = [(count[i : j + 1], arc[i : j + 1]) for i, j in pairwise(fixed)]
    at = np.concatenate([_nodes(*stretch, least) for stretch in stretches])
    at = _refined(at, arc, closed, sagitta)
    return np.stack([np.interp(at, arc, closed[:, k]) for k in range(2)], axis=1)


def _without_repeats(points: FloatArray) -> FloatArray:
    gap = np.hypot(*(np.roll(points, -1, axis=0) - points).T)
    return np.asarray(points[gap > 1e-12 * gap.max()])


def _dense(
    loop: FloatArray, spacing: float
) -> tuple[FloatArray, FloatArray, FloatArray, IndexArray]:
    """Points along the loop, the edge after each, the turn at each, and which are vertices."""
    edge = np.roll(loop, -1, axis=0) - loop
    long = np.hypot(*edge.T)
    direction = np.arctan2(edge[:, 1], edge[:, 0])
    turn = (direction - np.roll(direction, 1) + np.pi) % (2 * np.pi) - np.pi
    parts = np.maximum(np.ceil(long / spacing), 1).astype(np.int64)
    k = np.repeat(np.arange(len(loop)), parts)
    step = np.arange(k.size) - np.repeat(np.cumsum(parts) - parts, parts)
    dense = loop[k] + (step / parts[k])[:, None] * edge[k]
    return dense, (long / parts)[k], np.where(step == 0, turn[k], 0.0), step == 0


def _sizes(length: FloatArray, turning: FloatArray, sagitta: float, unit: float) -> FloatArray:
    """(n,) edge length that curvature allows at each point [mm]."""
    n, total = length.size, length.sum()
    at = np.cumsum(length) - length
    window = min(WINDOW * unit, total / 8)
    # total turning as a function of place, over three rounds so that windows never end
    places = np.concatenate([at - total, at, at + total])
    turned = np.cumsum(np.tile(np.abs(turning), 3))
    behind = np.searchsorted(places, at + window, side="right") - 1
    before = np.searchsorted(places, at - window, side="left") - 1
    curvature = (turned[behind] - np.where(before >= 0, turned[before], 0.0)) / (2 * window)
    longest = min(LONGEST * unit, total / FEWEST)
    with np.errstate(divide="ignore"):
        size = np.sqrt(8 * sagitta / curvature)
    size = np.clip(size, min(SHORTEST * unit, longest), longest)
    # no point may be larger than any other plus GRADING times the way to it
    tripled = np.tile(size, 3)
    up = GRADING * places + np.minimum.accumulate(tripled - GRADING * places)
    down = np.minimum.accumulate((tripled + GRADING * places)[::-1])[::-1] - GRADING * places
    return np.minimum(up, down)[n : 2 * n]


def _nodes(count: FloatArray, arc: FloatArray, least: int) -> FloatArray:
    """Places along one stretch, its first end included, its last one not."""
    edges = max(int(np.ceil(count[-1] - count[0] - 1e-9)), least)
    return np.interp(np.linspace(count[0], count[-1], edges + 1)[:-1], count, arc)


def _refined(at: FloatArray, arc: FloatArray, closed: FloatArray, sagitta: float) -> FloatArray:
    """Nodes added where the loop is still more than `sagitta` from its chord."""
    for _ in range(8):
        x, y = (np.interp(at, arc, closed[:, k]) for k in range(2))
        edge = np.searchsorted(at, arc[:-1], side="right") - 1
        dx, dy = np.roll(x, -1) - x, np.roll(y, -1) - y
        u, v = closed[:-1, 0] - x[edge], closed[:-1, 1] - y[edge]
        off = np.abs(dx[edge] * v - dy[edge] * u) / np.maximum(np.hypot(dx, dy)[edge], 1e-300)
        worst = np.zeros(at.size)
        np.maximum.at(worst, edge, off)
        bad = np.flatnonzero(worst > 1.05 * sagitta)
        if not bad.size:
            break
        places = [arc[:-1][edge == k][np.argmax(off[edge == k])] for k in bad]
        at = np.unique(np.concatenate([at, places]))
    return at
