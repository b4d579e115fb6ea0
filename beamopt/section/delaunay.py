"""Delaunay triangulation of feature points in exact arithmetic.

Points lie on element centroids, so four on a circle and three on a line are everyday cases;
positions are therefore rounded to a lattice of 2⁻²⁵ of the largest extent (about a nanometre), on
which both predicates are exact in 64-bit integers.

A point at the place of an earlier one has no cell and no neighbours. Points on one line are each
other's neighbours along it. Four or more points on an empty circle are joined by one of the
triangulations possible there, the same one whenever the points are the same.
"""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from beamopt.base.compiled import compiled

__all__ = ["delaunay_edges"]

LATTICE_BITS = 25
HALF = 26
LOW = (1 << HALF) - 1
GHOST = -1
"""The vertex at infinity: a triangle with it stands for the outside of one edge of the hull."""


@compiled
def delaunay_edges(px: FloatArray, py: FloatArray) -> IndexArray:
    """(m, 2) edges of the Delaunay triangulation, lower index first, in no particular order.

    Incremental insertion: the triangles whose circumcircle holds the new point are replaced by a
    fan around it (Bowyer 1981, Watson 1981), with a vertex at infinity instead of a large triangle.
    """
    x, y = _lattice(px, py)
    n = x.size
    second, third = _first_triangle(x, y)
    if third < 0:
        return _edges_on_a_line(x, y)
    # vertex[t] counter-clockwise; beside[t, k] is the triangle across the edge opposite vertex k
    vertex = np.empty((2 * n + 2, 3), dtype=np.int64)
    beside = np.empty((2 * n + 2, 3), dtype=np.int64)
    count = _start(vertex, beside, x, y, second, third)
    cavity = np.empty(2 * n + 2, dtype=np.int64)
    state = np.zeros(2 * n + 2, dtype=np.int64)  # 2·turn + 1: in this turn's cavity, 2·turn: seen
    rim = np.empty((2 * n + 4, 4), dtype=np.int64)
    last = 0
    # round the ring, so that every point is near the one before it and the walk to it is short;
    # stable, so that of coincident points the earliest comes first
    order = np.argsort(np.arctan2(y * 1.0, x * 1.0), kind="mergesort")
    for turn in range(1, n + 1):
        p = order[turn - 1]
        if p in (0, second, third):
            continue
        seed = _locate(vertex, beside, x, y, p, last)
        if seed < 0:
            continue
        size = _cavity(vertex, beside, x, y, p, seed, turn, cavity, state)
        edges = _rim(vertex, beside, turn, cavity[:size], state, rim)
        last = _fan(vertex, beside, p, cavity[:size], rim[:edges], count)
        count += edges - size
    return _edges(vertex[:count])


@compiled
def _lattice(px: FloatArray, py: FloatArray) -> tuple[IndexArray, IndexArray]:
    """Positions as integers within ±2²⁴, so that differences fit 25 bits and a sign."""
    x = np.zeros(px.size, dtype=np.int64)
    y = np.zeros(px.size, dtype=np.int64)
    extent = 0.0
    for k in range(px.size):
        extent = max(extent, abs(px[k]), abs(py[k]))
    if extent < 1e-100:
        return x, y
    # a power of two scales without rounding, and does not depend on the points' exact positions
    scale = 2.0 ** (LATTICE_BITS - 1 - np.ceil(np.log2(extent)))
    for k in range(px.size):
        x[k] = np.int64(np.rint(px[k] * scale))
        y[k] = np.int64(np.rint(py[k] * scale))
    return x, y


@compiled
def _orientation(x: IndexArray, y: IndexArray, a: int, b: int, c: int) -> int:
    """Positive where a, b, c turn left; twice the area of the triangle, exact."""
    return int((x[b] - x[a]) * (y[c] - y[a]) - (y[b] - y[a]) * (x[c] - x[a]))


@compiled
def _in_circle(x: IndexArray, y: IndexArray, a: int, b: int, c: int, p: int) -> bool:
    """Whether p lies inside the circle through a, b, c (a left turn); exact.

    The determinant Σ liftᵢ · minorᵢ of 51-bit factors is summed in three digits of 26 bits.
    """
    ax, ay = x[a] - x[p], y[a] - y[p]
    bx, by = x[b] - x[p], y[b] - y[p]
    cx, cy = x[c] - x[p], y[c] - y[p]
    lifts = (ax * ax + ay * ay, bx * bx + by * by, cx * cx + cy * cy)
    minors = (bx * cy - by * cx, cx * ay - cy * ax, ax * by - ay * bx)
    high = middle = low = np.int64(0)
    for k in range(3):
        l1, l0 = lifts[k] >> HALF, lifts[k] & LOW
        m1, m0 = minors[k] >> HALF, minors[k] & LOW
        high += l1 * m1
        middle += l1 * m0 + l0 * m1
        low += l0 * m0
    middle += low >> HALF
    high += middle >> HALF
    return bool(high > 0 or (high == 0 and ((middle & LOW) | (low & LOW)) != 0))


@compiled
def _conflicts(vertex: IndexArray, x: IndexArray, y: IndexArray, t: int, p: int) -> bool:
    """Whether triangle t must go when p is inserted."""
    for k in range(3):
        if vertex[t, k] == GHOST:
            a, b = vertex[t, (k + 1) % 3], vertex[t, (k + 2) % 3]
            turn = _orientation(x, y, a, b, p)
            if turn != 0:
                return turn > 0
            along = (x[p] - x[a]) * (x[p] - x[b]) + (y[p] - y[a]) * (y[p] - y[b])
            return bool(along < 0)
    return _in_circle(x, y, vertex[t, 0], vertex[t, 1], vertex[t, 2], p)


@compiled
def _first_triangle(x: IndexArray, y: IndexArray) -> tuple[int, int]:
    """Two points that with point 0 span a triangle; −1 for what does not exist."""
    second = -1
    for k in range(1, x.size):
        if second < 0:
            if x[k] != x[0] or y[k] != y[0]:
                second = k
        elif _orientation(x, y, 0, second, k) != 0:
            return second, k
    return second, -1


@compiled
def _start(
    vertex: IndexArray, beside: IndexArray, x: IndexArray, y: IndexArray, second: int, third: int
) -> int:
    """The first triangle and the three ghosts around it; returns 4."""
    b, c = (second, third) if _orientation(x, y, 0, second, third) > 0 else (third, second)
    corner = (0, b, c)
    for k in range(3):
        vertex[0, k] = corner[k]
        beside[0, k] = k + 1
        ghost = k + 1  # outside the edge opposite corner k, which it runs through backwards
        vertex[ghost, 0] = corner[(k + 2) % 3]
        vertex[ghost, 1] = corner[(k + 1) % 3]
        vertex[ghost, 2] = GHOST
        beside[ghost, 0] = (k + 2) % 3 + 1
        beside[ghost, 1] = (k + 1) % 3 + 1
        beside[ghost, 2] = 0
    return 4


@compiled
def _locate(
    vertex: IndexArray, beside: IndexArray, x: IndexArray, y: IndexArray, p: int, start: int
) -> int:
    """A triangle that conflicts with p, by walking towards it; −1 where p is a vertex already."""
    t = start
    for k in range(3):
        if vertex[t, k] == GHOST:
            t = beside[t, k]
            break
    turned = True
    while turned:
        turned = False
        for k in range(3):
            a, b = vertex[t, (k + 1) % 3], vertex[t, (k + 2) % 3]
            if _orientation(x, y, a, b, p) < 0:
                t = beside[t, k]
                turned = True
                break
        for k in range(3):
            if vertex[t, k] == GHOST:
                return t
    for k in range(3):
        if x[vertex[t, k]] == x[p] and y[vertex[t, k]] == y[p]:
            return -1
    return t


@compiled
def _cavity(
    vertex: IndexArray,
    beside: IndexArray,
    x: IndexArray,
    y: IndexArray,
    p: int,
    seed: int,
    turn: int,
    cavity: IndexArray,
    state: IndexArray,
) -> int:
    """Collect the conflicting triangles around `seed`; returns how many."""
    cavity[0] = seed
    state[seed] = 2 * turn + 1
    size, done = 1, 0
    while done < size:
        for k in range(3):
            t = beside[cavity[done], k]
            if state[t] < 2 * turn:
                inside = _conflicts(vertex, x, y, t, p)
                state[t] = 2 * turn + inside
                if inside:
                    cavity[size] = t
                    size += 1
        done += 1
    return size


@compiled
def _rim(
    vertex: IndexArray,
    beside: IndexArray,
    turn: int,
    cavity: IndexArray,
    state: IndexArray,
    rim: IndexArray,
) -> int:
    """The cavity's boundary as rows (from, to, triangle outside, its side); returns how many."""
    edges = 0
    for t in cavity:
        for k in range(3):
            outside = beside[t, k]
            if state[outside] == 2 * turn + 1:
                continue
            rim[edges, 0] = vertex[t, (k + 1) % 3]
            rim[edges, 1] = vertex[t, (k + 2) % 3]
            rim[edges, 2] = outside
            for side in range(3):
                if beside[outside, side] == t:
                    rim[edges, 3] = side
            edges += 1
    return edges


@compiled
def _fan(
    vertex: IndexArray, beside: IndexArray, p: int, cavity: IndexArray, rim: IndexArray, count: int
) -> int:
    """Join p to every edge of the rim, in the cavity's places and two new ones; returns one."""
    place = np.empty(rim.shape[0], dtype=np.int64)
    for e in range(rim.shape[0]):
        t = cavity[e] if e < cavity.size else count + e - cavity.size
        place[e] = t
        vertex[t, 0], vertex[t, 1], vertex[t, 2] = p, rim[e, 0], rim[e, 1]
        beside[t, 0] = rim[e, 2]
        beside[rim[e, 2], rim[e, 3]] = t
    for e in range(rim.shape[0]):
        for f in range(rim.shape[0]):
            if rim[f, 0] == rim[e, 1]:  # f follows e around p
                beside[place[e], 1] = place[f]
                beside[place[f], 2] = place[e]
    return int(place[0])


@compiled
def _edges(vertex: IndexArray) -> IndexArray:
    """Every edge once: it is run through in both directions, and once upwards."""
    edges = np.empty((3 * vertex.shape[0] // 2, 2), dtype=np.int64)
    count = 0
    for t in range(vertex.shape[0]):
        for k in range(3):
            a, b = vertex[t, k], vertex[t, (k + 1) % 3]
            if GHOST < a < b:
                edges[count, 0], edges[count, 1] = a, b
                count += 1
    return edges[:count]


@compiled
def _edges_on_a_line(x: IndexArray, y: IndexArray) -> IndexArray:
    """Neighbours along the line that all points lie on, or none when they are all in one place."""
    n = x.size
    edges = np.empty((max(n - 1, 0), 2), dtype=np.int64)
    count = 0
    far = 0
    for k in range(n):
        if abs(x[k] - x[0]) + abs(y[k] - y[0]) > abs(x[far] - x[0]) + abs(y[far] - y[0]):
            far = k
    dx, dy = (x[far] - x[0], y[far] - y[0]) if n else (0, 0)
    place = x * dx + y * dy
    order = np.argsort(place, kind="mergesort")
    for k in range(1, n):
        a, b = order[k - 1], order[k]
        if place[a] == place[b]:
            order[k] = a  # the earlier of two coincident points stands for both
            continue
        edges[count, 0], edges[count, 1] = min(a, b), max(a, b)
        count += 1
    return edges[:count]
