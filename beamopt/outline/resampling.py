"""A smooth loop resampled to edges as long as its curvature allows, its area unchanged."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray

__all__ = ["resample"]

CORNER = np.radians(20.0)  # sharper turns of the smooth loop are corners, and stay
LONGEST, SHORTEST = 4.0, 0.25  # mm, edges in a ring of 25 mm
SPACING = 0.05  # mm between places where curvature is measured
WINDOW = 0.3  # mm to either side that it is averaged over
GRADING = 2.0  # growth of edge length along the loop
FEWEST = 12  # edges of a loop
CRUMB = 3.0  # times the sagitta: edges this short are not made shorter
PASSES = 5  # at making edges shorter where chords are too far off
ROUNDS = 8  # at making areas equal, each some thirty times nearer
STRAIGHT = 1e-9  # of its length squared; a smaller area between a line and its chord is none


def resample(points: FloatArray, sagitta: float) -> FloatArray:
    """(m, 2) vertices along a smooth loop (n, 2) [mm], edges at most `sagitta` off it.

    Corners stay; the vertices between them lie so far beside the loop that the edges enclose its
    area exactly, each edge about as much as the part of the loop that it stands for. Edges are
    √(8 R s) long where the curve's radius is R, at most 4 mm and where it can be at least 0.25 mm;
    lengths change gradually along the loop.
    """
    loop = _without_repeats(points)
    dense, length, turning, vertex = _dense(loop, SPACING)
    corner = vertex & (np.abs(turning) > CORNER)
    size = _sizes(length, np.where(corner, 0.0, turning), sagitta)
    start = int(np.flatnonzero(corner)[0]) if corner.any() else int(np.argmin(size))
    dense, length, size, corner = (
        np.roll(a, -start, axis=0) for a in (dense, length, size, corner)
    )
    arc = np.concatenate([[0.0], np.cumsum(length)])
    closed = np.concatenate([dense, dense[:1]])
    fixed = _apart(np.flatnonzero(corner), arc, min(SHORTEST, arc[-1] / FEWEST) / 2)
    for _ in range(PASSES):
        at = _places(_graded(size, arc), arc, fixed)
        off, edge = _distances(at, arc, closed)
        edges = np.diff(np.append(at, arc[-1]))
        bad = (off > sagitta) & (edges > CRUMB * sagitta)
        if not bad.any():
            break
        # where an edge reaches from an arc into a straight: shorter there, gradually around it
        shorter = np.where(bad, 0.8 * edges, np.inf)
        size = np.minimum(size, shorter[edge])
    at = _refined(at, arc, closed, sagitta)
    corners = arc[fixed[:-1]] if corner.any() else arc[:0]
    return _equal_area(*_bent(at, arc, closed, corners), corners)


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


def _sizes(length: FloatArray, turning: FloatArray, sagitta: float) -> FloatArray:
    """(n,) edge length that curvature allows at each point [mm]."""
    total = length.sum()
    at = np.cumsum(length) - length
    window = min(WINDOW, total / 8)
    # total turning as a function of place, over three rounds so that windows never end
    places = np.concatenate([at - total, at, at + total])
    turned = np.cumsum(np.tile(np.abs(turning), 3))
    behind = np.searchsorted(places, at + window, side="right") - 1
    before = np.searchsorted(places, at - window, side="left") - 1
    curvature = (turned[behind] - np.where(before >= 0, turned[before], 0.0)) / (2 * window)
    longest = min(LONGEST, total / FEWEST)
    with np.errstate(divide="ignore"):
        size = np.sqrt(8 * sagitta / curvature)
    size = np.clip(size, min(SHORTEST, longest), longest)
    return np.asarray(size)


def _apart(corners: IndexArray, arc: FloatArray, least: float) -> IndexArray:
    """Both ends of the loop and the corners between that are `least` [mm] from the one before.

    Offsets leave crumbs of a micrometre whose ends look like corners.
    """
    end = len(arc) - 1
    kept = [0]
    for corner in corners:
        if arc[corner] - arc[kept[-1]] >= least and arc[end] - arc[corner] >= least:
            kept.append(int(corner))
    return np.array([*kept, end])


def _graded(size: FloatArray, arc: FloatArray) -> FloatArray:
    """No size larger than any other plus `GRADING` times the way to it."""
    n = size.size
    places = np.concatenate([arc[:-1] - arc[-1], arc[:-1], arc[:-1] + arc[-1]])
    slope, tripled = GRADING * places, np.tile(size, 3)
    up = slope + np.minimum.accumulate(tripled - slope)
    down = np.minimum.accumulate((tripled + slope)[::-1])[::-1] - slope
    return np.asarray(np.minimum(up, down)[n : 2 * n])


def _places(size: FloatArray, arc: FloatArray, fixed: IndexArray) -> FloatArray:
    """Where the nodes lie along the loop: a whole number of edges between corners.

    The k-th node of a stretch lies where ∫ ds/h has reached the k-th part of its end value.
    """
    inverse = 1 / np.append(size, size[0])
    steps = (inverse[1:] + inverse[:-1]) / 2 * np.diff(arc)
    count = np.concatenate([[0.0], np.cumsum(steps)])
    least = -(-FEWEST // (len(fixed) - 1))
    nodes = []
    for i, j in pairwise(fixed):
        edges = max(int(np.ceil(count[j] - count[i] - 1e-9)), least)
        ends = np.linspace(count[i], count[j], edges + 1)[:-1]
        nodes.append(np.interp(ends, count[i : j + 1], arc[i : j + 1]))
    return np.concatenate(nodes)


def _distances(
    at: FloatArray, arc: FloatArray, closed: FloatArray
) -> tuple[FloatArray, IndexArray]:
    """How far the loop is from each chord, and the chord of each of its points."""
    x, y = (np.interp(at, arc, closed[:, k]) for k in range(2))
    edge = np.searchsorted(at, arc[:-1], side="right") - 1
    dx, dy = np.roll(x, -1) - x, np.roll(y, -1) - y
    u, v = closed[:-1, 0] - x[edge], closed[:-1, 1] - y[edge]
    off = np.abs(dx[edge] * v - dy[edge] * u) / np.maximum(np.hypot(dx, dy)[edge], 1e-300)
    worst = np.zeros(at.size)
    np.maximum.at(worst, edge, off)
    return worst, edge


def _refined(at: FloatArray, arc: FloatArray, closed: FloatArray, sagitta: float) -> FloatArray:
    """Edges halved where the loop is still more than `sagitta` from its chord."""
    for _ in range(8):
        ends = np.append(at, arc[-1])
        far = _distances(at, arc, closed)[0] > 1.05 * sagitta
        bad = np.flatnonzero(far & (np.diff(ends) > CRUMB * sagitta))
        if not bad.size:
            break
        at = np.unique(np.concatenate([at, (ends[bad] + ends[bad + 1]) / 2]))
    return at


def _bent(
    at: FloatArray, arc: FloatArray, closed: FloatArray, corners: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Places and vertices of the edges, and the area between each edge and the loop beside it.

    A curve between two corners has a vertex at least, which can make up for its area. Areas are
    positive where the loop runs to the right of the edge [mm²].
    """
    while True:
        vertices = np.stack([np.interp(at, arc, closed[:, k]) for k in range(2)], axis=1)
        beside = _areas_beside(at, vertices, arc, closed)
        still = np.isin(at, corners)
        length = np.diff(np.append(at, arc[-1]))
        stiff = still & np.roll(still, -1) & (np.abs(beside) > STRAIGHT * length**2)
        if not stiff.any():
            return at, vertices, beside
        at = np.sort(np.concatenate([at, (at + length / 2)[stiff]]))


def _areas_beside(
    at: FloatArray, vertices: FloatArray, arc: FloatArray, closed: FloatArray
) -> FloatArray:
    origin = closed[:-1].mean(axis=0)
    loop, corner = closed - origin, vertices - origin
    swept = np.concatenate([[0.0], np.cumsum(_cross(loop[:-1], loop[1:]))]) / 2
    k = np.searchsorted(arc, at, side="right") - 1
    until = swept[k] + _cross(loop[k], corner) / 2
    chord = _cross(corner, np.roll(corner, -1, axis=0)) / 2
    return np.asarray(np.diff(np.append(until, swept[-1])) - chord)


def _equal_area(
    at: FloatArray, vertices: FloatArray, beside: FloatArray, corners: FloatArray
) -> FloatArray:
    """Vertices moved across the loop until its edges enclose what it encloses.

    What lies beside an edge is shared by the ends of it that are no corners, so that second
    moments also agree, to the fourth power of the edges' length.
    """
    free = ~np.isin(at, corners)
    wanted = _area(vertices) + beside.sum()
    share = beside / np.where(free & np.roll(free, -1), 2, 1)
    along = np.roll(vertices, -1, axis=0) - np.roll(vertices, 1, axis=0)
    gain = np.hypot(*along.T)  # twice the area that moving by 1 mm to the right adds
    right = np.stack([along[:, 1], -along[:, 0]], axis=1) / np.maximum(gain, 1e-300)[:, None]
    by = np.where(free, 2 * (share + np.roll(share, 1)) / np.maximum(gain, 1e-300), 0.0)
    size = float((gain * np.abs(by)).sum()) / 2
    for _ in range(ROUNDS if size > 0 else 0):  # two neighbours that move: their product counts
        missing = wanted - _area(vertices + by[:, None] * right)
        by = by + missing / size * np.abs(by)
    return np.asarray(vertices + by[:, None] * right)


def _area(points: FloatArray) -> float:
    about = points - points.mean(axis=0)
    return float(_cross(about, np.roll(about, -1, axis=0)).sum()) / 2


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
