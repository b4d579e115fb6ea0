"""What counts as moved, and which rung is named."""

import math

import numpy as np
import pytest

from beamopt.rod.status import RodStatus
from femcheck.continuation.ended import FOUND, Ended, NoReply
from femcheck.continuation.outcome import Status
from femcheck.models.reply import Reply
from femcheck.regression.agreement import contradictions
from femcheck.regression.held import columns, of_reply
from femcheck.regression.measure import MeasuredPart
from femcheck.regression.moved import compare, lowest
from tests.femcheck.regression.small import held

LIMIT, BUCKLED = Ended(Status.LIMIT_POINT, 22.61), Ended(Status.BUCKLED)


def test_a_tip_within_its_tolerance_has_not_moved() -> None:
    before = held({"a": (0.0, 0.0, 60.0)})
    assert compare("d", [before], MeasuredPart((held({"a": (0.06, 0.06, 60.0)}),))) == []
    (moved,) = compare("d", [before], MeasuredPart((held({"a": (0.08, 0.08, 60.0)}),)))
    assert moved.distance == pytest.approx(0.08 * math.sqrt(2))
    assert str(moved) == "beam fine of d: tips at a moved by 0.113 mm (tolerance 0.1)"


@pytest.mark.parametrize(
    ("was", "now"),
    [
        ((1.0,), LIMIT),
        (LIMIT, (1.0,)),
        (LIMIT, BUCKLED),
        (LIMIT, Ended(RodStatus.LIMIT_POINT)),
        ((1.0,), (1.0, 2.0)),
        ((1.0,), (math.nan,)),
    ],
)
def test_an_equilibrium_that_came_or_went_has_moved(was: object, now: object) -> None:
    (moved,) = compare("d", [held({"a": was})], MeasuredPart((held({"a": now}),)))  # type: ignore[dict-item]
    assert moved.distance == math.inf
    assert "held: " in str(moved)


def test_the_same_status_has_not_moved_whatever_the_load() -> None:
    now = MeasuredPart((held({"a": Ended(Status.BUCKLED, 3.0, "said otherwise")}),))
    assert compare("d", [held({"a": BUCKLED})], now) == []


def test_rows_and_rungs_that_came_or_went_have_moved() -> None:
    before = [held({"a": (1.0,), "b": (1.0,)}), held({"c": (1.0,)}, "gmsh")]
    now = MeasuredPart(
        (held({"a": (1.0,), "z": (1.0,)}), held({"n": (0.0,)}, "outline")), "it died"
    )
    moved = compare("d", before, now)
    said = [(one.held.rung, one.row, one.before, one.now) for one in moved]
    assert said == [
        ("outline", "n", None, (0.0,)),
        ("beam", "b", (1.0,), None),
        ("beam", "z", None, (1.0,)),
        ("gmsh", "c", (1.0,), Ended(NoReply.BROKEN, detail="it died")),
    ]


def test_the_lowest_rung_is_named_and_there_what_moved_most() -> None:
    before = [held({"a": (0.0,), "b": (0.0,)}, "response"), held({"a": (0.0,)}, "section")]
    first = [held({"a": (9.0,), "b": (0.0,)}, "response"), held({"a": (0.0,)}, "section")]
    second = [held({"a": (1.0,), "b": (30.0,)}, "response"), held({"a": (0.0,)}, "section")]
    moved = compare("d", before, MeasuredPart(tuple(first)))
    moved += compare("e", before, MeasuredPart(tuple(second)))
    found = lowest(moved)
    assert found is not None
    assert (found.design, found.held.rung, found.row) == ("e", "response", "b")
    assert lowest([]) is None


def test_digits_end_a_little_below_the_tolerance() -> None:
    written = held({"a": (1 / 3, -1e-9), "b": BUCKLED}, tolerance=0.00234).written()
    assert written.rows == {"a": (0.33333, 0.0), "b": BUCKLED}
    assert written.tolerance == 0.0023
    assert str(written.rows["a"]) == "(0.33333, 0.0)"
    assert held({"a": (1 / 3,)}, tolerance=5.0).written().rows == {"a": (0.33,)}


def test_numbers_without_a_tolerance_are_written_with_all_digits() -> None:
    exact = held({"a": (17.8 / 3, 1e-20)}, tolerance=0.0)
    assert exact.written().rows == exact.rows
    assert compare("d", [exact.written()], MeasuredPart((exact,))) == []


def test_a_reply_is_a_row_a_combination() -> None:
    reply = Reply(np.array([[0, 0, 1.0], [np.nan] * 3]), (FOUND, BUCKLED))
    rows = of_reply(np.array([[0, 5.0, 0], [1e-3, 0, 100]]), reply)
    assert rows == {"0, 5, 0 kPa": (0.0, 0.0, 1.0), "0.001, 0, 100 kPa": BUCKLED}


def test_numbers_that_are_none_have_a_status() -> None:
    found = columns(["a", "b"], np.array([[1.0, np.nan], [1.0, 2.0]]))
    assert found == {"a": Ended(NoReply.NOT_FINITE), "b": (1.0, 2.0)}


def test_rungs_that_say_the_same_are_held_against_each_other() -> None:
    one = held({"a": (1.0,)}, "rod, modes")
    assert contradictions([one, held({"a": (1.19,)}, "rod, elements")], 60) == []
    (said,) = contradictions([one, held({"a": (1.21,)}, "rod, elements")], 60)
    assert said == "rod, modes and rod, elements: tips at a: 0.21 mm apart (allowed 0.2)"
    (said,) = contradictions([one, held({"a": BUCKLED}, "rod, elements")], 60)
    assert said.endswith("no numbers")
    areas = held({"material": (10.0,), "supply 1": (2.0,)}, "kept mesh", quantity="areas")
    volumes = held({"material": (600.0,), "supply 1": (150.0,)}, "solid at rest")
    (said,) = contradictions([areas, volumes], 60)
    assert said == "kept mesh and solid at rest: supply 1: 150 mm³ are not 2 mm² × 60 mm"
    assert contradictions([areas], 60) == []  # the other rung is not wanted


def test_what_depends_on_the_clock_is_not_held() -> None:
    (said,) = contradictions([held({"a": Ended(Status.TIME_OUT)})], 60)
    assert said == "beam: tips at a: time limit reached"
