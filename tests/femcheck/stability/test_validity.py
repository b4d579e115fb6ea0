"""Where the beam is valid, on tracks whose crossings are known."""

import numpy as np
import pytest

from femcheck.stability.validity import Interval, intervals_of, stable_part
from tests.femcheck.stability.small import point

REST = (0.0, 0.0, 0.0, 60.0, np.nan, np.nan, np.nan, 0.0)


def test_linear_between_the_points() -> None:
    """0.2 − 0.02 P is 0.05 at 7.5 and −0.05 at 12.5 kPa, wherever the points are."""
    track = [REST, *(point(load, 0.2 - 0.02 * load) for load in (1.0, 6.0, 9.0, 20.0))]
    (found,) = intervals_of(track)
    assert found.ends
    assert found.begins
    assert (found.low, found.high) == pytest.approx((7.5, 12.5))


def test_a_tip_that_passes_the_beam_between_two_points() -> None:
    """Both points are half a displacement off, on different sides."""
    track = [REST, point(10.0, 0.5), point(20.0, -0.5)]
    (found,) = intervals_of(track)
    assert (found.low, found.high) == pytest.approx((14.5, 15.5))


def test_a_tip_that_passes_at_a_distance() -> None:
    before, behind = point(10.0, 0.5), point(20.0, -0.5)
    aside, beyond = ((*one[:5], 0.06, *one[6:]) for one in (before, behind))
    assert intervals_of([REST, aside, beyond]) == ()
    assert len(intervals_of([REST, aside, beyond], 0.07)) == 1


def test_valid_from_rest_on_and_to_the_end() -> None:
    assert intervals_of([REST, point(5.0, 0.01), point(10.0, 0.09)]) == (
        Interval(0.0, pytest.approx(7.5), True),  # type: ignore[arg-type]
    )
    assert intervals_of([REST, point(5.0, 0.09), point(10.0, 0.01)]) == (
        Interval(pytest.approx(7.5), 10.0, False),  # type: ignore[arg-type]
    )
    assert intervals_of([REST, point(5.0, 0.02), point(10.0, 0.01)]) == (
        Interval(0.0, 10.0, False),
    )


def test_in_and_out_and_in_again() -> None:
    track = [REST, point(2.0, 0.0), point(4.0, 0.1), point(6.0, 0.0)]
    assert [(one.low, one.high, one.ends) for one in intervals_of(track)] == [
        (0.0, 3.0, True),
        (5.0, 6.0, False),
    ]


def test_only_what_is_stable_counts() -> None:
    """Behind the limit the load falls; what is unstable on the way up counts as little."""
    track = [REST, point(5.0, 0.5), point(8.0, 0.3), point(7.0, 0.0), point(9.0, 0.0, unstable=1)]
    assert stable_part(track)[:, 0].tolist() == [0.0, 5.0, 8.0]
    assert intervals_of(track) == ()


def test_nothing_followed() -> None:
    assert intervals_of([]) == ()
    assert intervals_of([REST]) == ()
