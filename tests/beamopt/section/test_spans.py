"""Spans on circles against membership, asked for at many angles."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray
from beamopt.section.grid import PolarGrid
from beamopt.section.spans import (
    ROW_SHARE,
    Circles,
    Spans,
    add_span,
    circles_of,
    close,
    complement,
    dilate,
    intersect,
    no_spans,
    open_,
    widths_within,
)

RING = PolarGrid(radial=12, angular=24)
SECTOR = PolarGrid(radial=9, angular=24, start=10.0, stop=310.0)
DISC = PolarGrid(0.0, 6.0, radial=12, angular=24)
GRIDS = [RING, SECTOR, DISC]


def scattered(circles: Circles, rng: np.random.Generator, most: int = 4) -> Spans:
    """A few spans on every circle, some through the start, some empty, some all round."""
    spans = no_spans(circles.radii.size, 24)
    for i in range(circles.radii.size):
        for _ in range(rng.integers(0, most + 1)):
            first = rng.uniform(-1, circles.period)
            last = first + rng.choice([0.01, 1.0, 4.0, 30.0], p=[0.3, 0.3, 0.35, 0.05])
            last = min(max(last, 0.0), circles.period + 1)
            add_span(spans, i, first, last, circles.period)
    return spans


def holds(spans: Spans, at: FloatArray) -> NDArray[np.bool_]:
    """(circles, angles) whether the sets hold the places `at` [columns]."""
    found = np.zeros((spans.number.size, at.size), dtype=np.bool_)
    for i, n in enumerate(spans.number):
        for first, last in zip(spans.first[i, :n], spans.last[i, :n], strict=True):
            found[i] |= (at >= first) & (at <= last)
    return found


def places(circles: Circles, seed: int) -> FloatArray:
    return np.random.default_rng(seed).uniform(0, circles.period, 200)


def is_tidy(spans: Spans, period: float) -> bool:
    """Spans ascend, do not meet, and stay within the turn."""
    for i, n in enumerate(spans.number):
        ends = np.stack([spans.first[i, :n], spans.last[i, :n]], axis=1).ravel()
        if n and not (ends[0] >= 0 and ends[-1] <= period and (np.diff(ends)[1::2] > 0).all()):
            return False
    return True


def copied(spans: Spans) -> Spans:
    return Spans(spans.first.copy(), spans.last.copy(), spans.number.copy())


@given(st.sampled_from(GRIDS), st.integers(0, 2**32))
def test_what_is_added_is_held_round_the_start_too(grid: PolarGrid, seed: int) -> None:
    circles = circles_of(grid, 0.0)
    rng = np.random.default_rng(seed)
    spans = no_spans(circles.radii.size, 24)
    at = places(circles, seed)
    expected = np.zeros(at.size, dtype=np.bool_)
    for _ in range(6):
        first = rng.uniform(-circles.period / 3, circles.period)
        last = max(first, 0.0) + rng.uniform(0, circles.period / 3)
        add_span(spans, 3, first, last, circles.period)
        expected |= np.mod(at - first, circles.period) <= last - first
    np.testing.assert_array_equal(holds(spans, at)[3], expected)
    assert not holds(spans, at)[[0, 1, 2, 4]].any()
    assert is_tidy(spans, circles.period)


@given(st.sampled_from(GRIDS), st.integers(0, 2**32))
def test_complement_and_intersection(grid: PolarGrid, seed: int) -> None:
    circles = circles_of(grid, 0.0)
    rng = np.random.default_rng(seed)
    one, other = scattered(circles, rng), scattered(circles, rng)
    at = places(circles, seed)
    both = no_spans(circles.radii.size, 24)
    intersect(one, other, both)
    np.testing.assert_array_equal(holds(both, at), holds(one, at) & holds(other, at))
    before = holds(one, at)
    complement(one, circles.period)
    np.testing.assert_array_equal(holds(one, at), ~before)
    assert is_tidy(one, circles.period)
    assert is_tidy(both, circles.period)


@given(st.sampled_from(GRIDS), st.integers(0, 2**32), st.sampled_from([0.05, 0.6, 2.5, 40.0]))
def test_dilation_holds_what_is_within_the_distance(
    grid: PolarGrid, seed: int, distance: float
) -> None:
    """By the distances of places on circles to the nearest place of each span."""
    circles = circles_of(grid, 0.0)
    spans = scattered(circles, np.random.default_rng(seed), most=1)
    grown = no_spans(circles.radii.size, 24)
    dilate(spans, widths_within(circles, distance), circles.period, grown)
    at, radii = places(circles, seed), circles.radii
    squares = np.full((radii.size, at.size), np.inf)
    for j, n in enumerate(spans.number):
        for first, last in zip(spans.first[j, :n], spans.last[j, :n], strict=True):
            off = np.mod(at - first, circles.period)
            away = np.minimum(np.maximum(off - (last - first), 0), circles.period - off)
            away = np.where(off <= last - first, 0, away) / circles.period * 2 * np.pi
            away = np.minimum(away, np.pi)
            across = np.subtract.outer(radii, radii[j : j + 1])
            chord = 4 * np.multiply.outer(radii, radii[j : j + 1]) * np.sin(away / 2) ** 2
            squares = np.minimum(squares, across**2 + chord)
    clear = np.abs(np.sqrt(squares) - distance) > 1e-6
    np.testing.assert_array_equal(holds(grown, at)[clear], (squares <= distance**2)[clear])
    assert is_tidy(grown, circles.period)


def test_a_row_share_reaches_farther_across_rows_only() -> None:
    circles = circles_of(RING, 0.0)
    plain, more = widths_within(circles, 3.0), widths_within(circles, 3.0, ROW_SHARE)
    k, m = plain.shape[1] // 2, more.shape[1] // 2
    np.testing.assert_array_equal(plain[:, k], more[:, m])
    inside = (plain[:, k + 1] >= 0) & (plain[:, k + 1] < circles.period / 2)
    assert (more[inside, m + 1] > plain[inside, k + 1]).all()


@given(st.sampled_from(GRIDS), st.integers(0, 2**32), st.sampled_from([0.4, 1.1]))
def test_closing_and_opening(grid: PolarGrid, seed: int, distance: float) -> None:
    """A closing adds, an opening takes away, and a second one does nothing more."""
    circles = circles_of(grid, distance)
    widths = widths_within(circles, distance)
    drawn = scattered(circles, np.random.default_rng(seed))
    between = no_spans(circles.radii.size, 24)
    at = places(circles, seed)
    for change, sign in ((close, 1), (open_, -1)):
        spans = copied(drawn)
        change(spans, widths, circles.period, between)
        before, once = holds(drawn, at).astype(int), holds(spans, at).astype(int)
        assert (sign * (once - before) >= 0).all()
        change(spans, widths, circles.period, between)
        np.testing.assert_array_equal(holds(spans, at), once.astype(np.bool_))
        assert is_tidy(spans, circles.period)


def test_circles_reach_as_far_as_the_margin() -> None:
    circles = circles_of(RING, 2.0)
    rows = RING.centroid_radii
    np.testing.assert_array_equal(circles.radii[circles.inside :][:12], rows)
    assert circles.radii[0] <= rows[0] - 2.0
    assert circles.radii[-1] >= rows[-1] + 2.0
    assert (np.diff(circles.radii) > 0).all()
    assert circles.period == 24
    assert circles_of(SECTOR, 0.0).period == pytest.approx(24 * 360 / 300)
    assert circles_of(DISC, 2.0).radii[0] > 0
    assert circles_of(RING, 1000.0).radii.size < 200  # however far


def test_without_room_neighbours_are_joined() -> None:
    spans = no_spans(1, 2)
    room = spans.first.shape[1]
    for k in range(room + 5):
        add_span(spans, 0, 2.0 * k, 2.0 * k + 1, 1000.0)
    assert spans.number[0] == room
    assert spans.last[0, room - 1] == 2 * (room + 4) + 1
    assert is_tidy(spans, 1000.0)
