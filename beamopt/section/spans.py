"""Sets in the plane as angular spans on circles, and how they grow and shrink.

Across its rows' circles a section is known as well as its rows are thick; along them to a part of a
column. What seals a section needs that: a wall of 0.9 mm is two columns wide at the outer surface
of the default grid.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from beamopt.base.compiled import compiled
from beamopt.section.grid import PolarGrid

__all__ = [
    "ROW_SHARE",
    "Circles",
    "Spans",
    "add_span",
    "circles_of",
    "close",
    "complement",
    "dilate",
    "intersect",
    "no_spans",
    "open_",
    "widths_within",
]

SAME = 1e-7
"""Ends closer than this [columns] are one: a gap left by rounding would grow to a real one."""

ROW_SHARE = 0.5
"""Share of a row's half height by which growing alone reaches farther across rows.

A set's edge along a row lies up to half a row beyond the last circle inside; an edge across rows is
known exactly. This lies between the two: chambers then lose as much to a wall as outlines do, to
less than a thousandth. In closing and opening, growing and shrinking cancel and no share is best.
"""

FEWEST = 32
"""Circles outside the ring are no closer together than this part of the distance looked at."""


class Spans(NamedTuple):
    """Disjoint, ascending spans [first, last] on every circle, in columns from the grid's start.

    A span through the start is kept as two. Room for `first.shape[1]` on a circle: beyond that the
    nearest ones are joined.

    first, last (circles, room) : ends; number (circles,) : how many there are.
    """

    first: FloatArray
    last: FloatArray
    number: IndexArray


class Circles(NamedTuple):
    """The circles through a grid's rows of centroids, and some outside the ring on both sides.

    radii (circles,) [mm]; heights (circles,) of the rows around them [mm]; inside : how many lie
    within the hole; period : columns of a whole turn, also for a sector.
    """

    radii: FloatArray
    heights: FloatArray
    inside: int
    period: float


def circles_of(grid: PolarGrid, margin: float) -> Circles:
    """The circles of a grid and of `margin` [mm] around its rows."""
    rows = grid.centroid_radii
    heights = np.diff(grid.edges)
    low = max(heights[0], margin / FEWEST)
    high = max(heights[-1], margin / FEWEST)
    within = rows[0] - low * np.arange(int(np.ceil(margin / low)), 0, -1)
    within = within[within > 0] if margin else within[:0]
    beyond = rows[-1] + high * np.arange(1, int(np.ceil(margin / high)) + 1)
    return Circles(
        np.concatenate([within, rows, beyond]),
        np.concatenate([np.full(within.size, low), heights, np.full(beyond.size, high)]),
        within.size,
        360.0 / grid.span * grid.angular,
    )


def widths_within(circles: Circles, distance: float, row_share: float = 0.0) -> FloatArray:
    """(circles, 2k + 1) half width of what lies within `distance` [mm], on circles −k…k from each.

    In columns; negative where a circle is farther away. A point reaches as far as it is reached
    from, so that closing and opening are what they are called.
    """
    radii, heights = circles.radii, circles.heights
    half = np.add.outer(heights, heights) / 4
    across = np.abs(np.subtract.outer(radii, radii)) * distance / (distance + row_share * half)
    left = (distance - across) * (distance + across)
    sine = np.sqrt(np.clip(left / (4 * np.multiply.outer(radii, radii)), 0, 1))
    width = np.where(left < 0, -1.0, np.arcsin(sine) / np.pi * circles.period)
    n = radii.size
    first, second = np.nonzero(left >= 0)
    k = int(np.abs(first - second).max())
    table = np.full((n, 2 * k + 1), -1.0)
    table[first, second - first + k] = width[first, second]
    return table


def no_spans(circles: int, columns: int) -> Spans:
    """Empty sets on so many circles, with room for every run of that many columns."""
    room = columns // 2 + 16
    empty = np.zeros(circles, dtype=np.int64)
    return Spans(np.zeros((circles, room)), np.zeros((circles, room)), empty)


@compiled
def add_span(spans: Spans, i: int, first: float, last: float, period: float) -> None:
    """Add [first, last] to circle i; it may reach through the start, from either side."""
    spans.number[i] = _add(spans.first[i], spans.last[i], spans.number[i], 0, first, last, period)


@compiled
def _add(
    a: FloatArray, b: FloatArray, n: int, p: int, first: float, last: float, period: float
) -> int:
    """Add a span to the n in a and b, where those before p end before it; returns how many then."""
    if last - first >= period - SAME:
        a[0], b[0] = 0.0, period
        return 1
    if first < 0:
        n = _insert(a, b, n, 0, first + period, period)
        return _insert(a, b, n, 0, 0.0, last)
    if last > period:
        n = _insert(a, b, n, p, first, period)
        return _insert(a, b, n, 0, 0.0, last - period)
    return _insert(a, b, n, p, first, last)


@compiled
def _insert(a: FloatArray, b: FloatArray, n: int, p: int, first: float, last: float) -> int:
    """Add a span within the turn, joined with those that it meets."""
    while p < n and b[p] < first - SAME:
        p += 1
    q = p
    while q < n and a[q] <= last + SAME:
        q += 1
    if q == p and n == a.size:  # no room: join it with a neighbour
        p = min(p, n - 1)
        q = p + 1
    if q == p:
        for m in range(n, p, -1):
            a[m], b[m] = a[m - 1], b[m - 1]
        a[p], b[p] = first, last
        return n + 1
    a[p], b[p] = min(a[p], first), max(b[q - 1], last)
    if q > p + 1:
        for m in range(q, n):
            a[m - q + p + 1], b[m - q + p + 1] = a[m], b[m]
    return n - (q - p - 1)


@compiled
def complement(spans: Spans, period: float) -> None:
    """Put what is between the spans in their place, on every circle."""
    for i in range(spans.number.size):
        a, b, n = spans.first[i], spans.last[i], spans.number[i]
        before, count = 0.0, 0
        for m in range(n):
            first, last = a[m], b[m]
            if first - before > SAME:
                a[count], b[count] = before, first
                count += 1
            before = last
        if period - before > SAME and count < a.size:
            a[count], b[count] = before, period
            count += 1
        spans.number[i] = count


@compiled
def intersect(one: Spans, other: Spans, out: Spans) -> None:
    """What two sets have in common; `out` is neither of them."""
    for i in range(one.number.size):
        m = k = count = 0
        while m < one.number[i] and k < other.number[i] and count < out.first.shape[1]:
            first = max(one.first[i, m], other.first[i, k])
            last = min(one.last[i, m], other.last[i, k])
            if last - first > SAME:
                out.first[i, count], out.last[i, count] = first, last
                count += 1
            if one.last[i, m] < other.last[i, k]:
                m += 1
            else:
                k += 1
        out.number[i] = count


@compiled
def dilate(spans: Spans, widths: FloatArray, period: float, out: Spans) -> None:
    """What lies within a distance of a set, `widths` from `widths_within`; `out` is another one."""
    circles = spans.number.size
    k = widths.shape[1] // 2
    for i in range(circles):
        a, b, reach = out.first[i], out.last[i], widths[i]
        n = 0
        for step in range(2 * k + 1):
            # the circle itself first, then nearer before farther ones: most add nothing any more
            aside = (step + 1) // 2 if step % 2 else -(step // 2)
            j, width = i + aside, reach[k + aside]
            if width < 0 or not 0 <= j < circles:
                continue
            p = 0
            for m in range(spans.number[j]):
                first, last = spans.first[j, m] - width, spans.last[j, m] + width
                while p < n and b[p] < first - SAME:
                    p += 1
                if p == n or first < a[p] or last > b[p]:
                    n = _add(a, b, n, p, first, last, period)
                    p = 0 if first < 0 or last > period else p
            if n == 1 and a[0] == 0 and b[0] == period:
                break  # there is no more to reach
        out.number[i] = n


@compiled
def close(spans: Spans, widths: FloatArray, period: float, between: Spans) -> None:
    """Grow and shrink by a distance, in place: fills gaps narrower than twice that."""
    dilate(spans, widths, period, between)
    complement(between, period)
    dilate(between, widths, period, spans)
    complement(spans, period)


@compiled
def open_(spans: Spans, widths: FloatArray, period: float, between: Spans) -> None:
    """Shrink and grow by a distance, in place: removes what is narrower, rounds corners."""
    complement(spans, period)
    dilate(spans, widths, period, between)
    complement(between, period)
    dilate(between, widths, period, spans)
