"""What counts as moved, and which rung is named."""

import math

import numpy as np
import pytest

from femcheck.models.reply import Reply
from femcheck.regression.agreement import contradictions
from femcheck.regression.held import columns, of_reply, split
from femcheck.regression.measure import Measured
from femcheck.regression.moved import compare, lowest
from tests.femcheck.regression.small import held


def test_a_tip_within_its_tolerance_has_not_moved() -> None:
    before = held({"a": (0.0, 0.0, 60.0)})
    assert compare("d", [before], Measured((held({"a": (0.06, 0.06, 60.0)}),))) == []
    (moved,) = compare("d", [before], Measured((held({"a": (0.08, 0.08, 60.0)}),)))
    assert moved.distance == pytest.approx(0.08 * math.sqrt(2))
    assert str(moved) == "beam fine of d: tips at a moved by 0.113 mm (tolerance 0.1)"


@pytest.mark.parametrize(
    ("was", "now"),
    [
        ((1.0,), "limit point"),
        ("limit point", (1.0,)),
        ("limit point", "buckled"),
        ((1.0,), (1.0, 2.0)),
        ((1.0,), (math.nan,)),
    ],
)
def test_an_equilibrium_that_came_or_went_has_moved(was: object, now: object) -> None:
    (moved,) = compare("d", [held({"a": was})], Measured((held({"a": now}),)))  # type: ignore[dict-item]
    assert moved.distance == math.inf
    assert "held: " in str(moved)


def test_the_same_words_have_not_moved() -> None:
    assert compare("d", [held({"a": "buckled"})], Measured((held({"a": "buckled"}),))) == []


def test_rows_and_rungs_that_came_or_went_have_moved() -> None:
    before = [held({"a": (1.0,), "b": (1.0,)}), held({"c": (1.0,)}, "gmsh")]
    now = Measured((held({"a": (1.0,), "z": (1.0,)}), held({"n": (0.0,)}, "outline")), "it died")
    moved = compare("d", before, now)
    said = [(one.held.rung, one.row, one.before, one.now) for one in moved]
    assert said == [
        ("outline", "n", None, (0.0,)),
        ("beam", "b", (1.0,), None),
        ("beam", "z", None, (1.0,)),
        ("gmsh", "c", (1.0,), "it died"),
    ]


def test_the_lowest_rung_is_named_and_there_what_moved_most() -> None:
    before = [held({"a": (0.0,), "b": (0.0,)}, "response"), held({"a": (0.0,)}, "section")]
    first = [held({"a": (9.0,), "b": (0.0,)}, "response"), held({"a": (0.0,)}, "section")]
    second = [held({"a": (1.0,), "b": (30.0,)}, "response"), held({"a": (0.0,)}, "section")]
    moved = compare("d", before, Measured(tuple(first)))
    moved += compare("e", before, Measured(tuple(second)))
    found = lowest(moved)
    assert found is not None
    assert (found.design, found.held.rung, found.row) == ("e", "response", "b")
    assert lowest([]) is None


def test_digits_end_a_little_below_the_tolerance() -> None:
    written = held({"a": (1 / 3, -1e-9), "b": "buckled"}, tolerance=0.00234).written()
    assert written.rows == {"a": (0.33333, 0.0), "b": "buckled"}
    assert written.tolerance == 0.0023
    assert str(written.rows["a"]) == "(0.33333, 0.0)"
    assert held({"a": (1 / 3,)}, tolerance=5.0).written().rows == {"a": (0.33,)}


def test_reasons_are_split_into_words_and_pressure() -> None:
    assert split("limit point at P = 22.61 kPa") == ("limit point", 22.61)
    assert split("no mesh") == ("no mesh", None)
    reply = Reply(np.array([[0, 0, 1.0], [np.nan] * 3]), ("converged", "buckled at P = 3 kPa"))
    rows = of_reply(np.array([[0, 5.0, 0], [1e-3, 0, 100]]), reply)
    assert rows == {"0, 5, 0 kPa": (0.0, 0.0, 1.0), "0.001, 0, 100 kPa": "buckled"}


def test_numbers_that_are_none_are_said_in_words() -> None:
    found = columns(["a", "b"], np.array([[1.0, np.nan], [1.0, 2.0]]))
    assert found == {"a": "not a number", "b": (1.0, 2.0)}


def test_rungs_that_say_the_same_are_held_against_each_other() -> None:
    one = held({"a": (1.0,)}, "rod, modes")
    assert contradictions([one, held({"a": (1.19,)}, "rod, elements")], 60) == []
    (said,) = contradictions([one, held({"a": (1.21,)}, "rod, elements")], 60)
    assert said == "rod, modes and rod, elements: tips at a: 0.21 mm apart (allowed 0.2)"
    (said,) = contradictions([one, held({"a": "buckled"}, "rod, elements")], 60)
    assert said.endswith("no numbers")
    areas = held({"material": (10.0,), "supply 1": (2.0,)}, "kept mesh", quantity="areas")
    volumes = held({"material": (600.0,), "supply 1": (150.0,)}, "solid at rest")
    (said,) = contradictions([areas, volumes], 60)
    assert said == "kept mesh and solid at rest: supply 1: 150 mm³ are not 2 mm² × 60 mm"
    assert contradictions([areas], 60) == []  # the other rung is not wanted


def test_what_depends_on_the_clock_is_not_held() -> None:
    (said,) = contradictions([held({"a": "time limit reached"})], 60)
    assert said == "beam: tips at a: time limit reached"
