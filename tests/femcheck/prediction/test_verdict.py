"""The sentence that a person reads, for each way in which a prediction ends."""

import re
from typing import Any

import numpy as np
import pytest

from femcheck.continuation.outcome import Status
from femcheck.mesh.gmsh_section import MeshFailure, MeshProblem
from femcheck.prediction.prediction import Prediction
from femcheck.prediction.rays import rays_of
from femcheck.prediction.verdict import advice, verdict
from femcheck.solid.winding import Wound
from tests.femcheck.prediction.small import faked, options_of, soft_subject

ONE, ALIKE, SLANTED = (1.0, 0.0, 0.0), (1.0, 1.0, 1.0), (0.5, 1.0, 0.0)
LIMIT = (Status.LIMIT_POINT, 27.24)


def sentence(found: Prediction) -> str:
    """The verdict; one line, one sentence, numbers that are numbers, brackets that close."""
    said = verdict(found)
    for text in filter(None, (said, advice(found))):
        assert "\n" not in text
        assert text == text.strip()
        assert "  " not in text
        assert not text.endswith(".")
        assert not re.search(r"\b(nan|inf|None|Status)\b", text)
        assert text.count("(") == text.count(")")
    return said


@pytest.mark.parametrize(
    ("status", "word"),
    [
        (Status.LIMIT_POINT, "balloons at 27.2 kPa"),
        (Status.BUCKLED, "buckles at 27.2 kPa"),
        (Status.INVERTED, "turned inside out"),
        (Status.STEP_TOO_SMALL, "steps became too small"),
        (Status.LINEAR_SOLVER, "linear solver"),
        (Status.WORK_LIMIT, "work limit"),
        (Status.TIME_OUT, "time limit"),
        (Status.STOPPED, "its process ended"),
    ],
    ids=lambda value: value.name if isinstance(value, Status) else "",
)
def test_every_ending_has_its_words(status: Status, word: str) -> None:
    found = faked({ALIKE: (status, 27.24)})
    said = sentence(found)
    assert word in said
    assert "all supplies alike" in said
    assert "1 of 26 combinations has no " in said
    assert "27.2 kPa" in said
    assert not found.holds
    assert found.unanswered == 1


def test_what_the_computation_lost_is_not_sold_as_physics() -> None:
    """A ray without time is not known; a limit at a higher pressure is what the actuator does."""
    found = faked({SLANTED: (Status.TIME_OUT, 3.0)})
    said = sentence(found)
    assert "no answer that is known: time limit reached" in said
    assert "exist" not in said
    way_out = advice(found)
    assert way_out is not None
    assert "--resume" in way_out
    assert "wind" not in way_out
    both = faked({SLANTED: (Status.STOPPED, 0.0), ALIKE: LIMIT})
    assert "balloons at 27.2 kPa" in sentence(both) or "snaps at 27.2 kPa" in sentence(both)
    assert both.not_computed == 1
    assert both.stable_box == 0  # what is known


def test_the_lowest_pressure_is_told() -> None:
    """Of whichever ray, and of those that end at one pressure always the same."""
    found = faked({ALIKE: LIMIT, SLANTED: (Status.BUCKLED, 22.0), ONE: (Status.LIMIT_POINT, 31.0)})
    assert found.stable_box == 22
    said = sentence(found)
    assert "buckles at 22 kPa" in said
    assert "pressures as 0.5 : 1 : 0" in said
    tied = faked({SLANTED: LIMIT, ALIKE: LIMIT, ONE: LIMIT})
    assert "(supply 1 alone" in sentence(tied)


@pytest.mark.parametrize(("share", "verb"), [(0.01, "creases"), (0.5, "buckles")])
def test_where_it_buckles(share: float, verb: str) -> None:
    mode = (share, (3.0, -4.25, 50.0))
    said = sentence(faked({SLANTED: (Status.BUCKLED, 27.24)}, mode=mode))
    assert f"this section {verb} at 27.2 kPa" in said
    # a place says something where only a part of the section moves
    assert ("near (3.0, -4.2, 50.0) mm" in said) == (verb == "creases")


def test_nothing_exists() -> None:
    rays, _ = rays_of(soft_subject().pressures)
    said = sentence(faked({ray.direction: (Status.LIMIT_POINT, 3.14159) for ray in rays}))
    assert "at 3.14 kPa" in said
    assert "26 of 26 combinations" in said
    assert said.endswith("workspace at 40 kPa does not exist")
    assert "at 3.14 kPa (supply 1 alone, 3.14 kPa on the coarse mesh)" in said


def test_nothing_exists_as_far_as_it_is_known() -> None:
    """Not a part of the workspace is left, though why one ray ends is not known."""
    rays, _ = rays_of(soft_subject().pressures)
    ends = {ray.direction: (Status.LIMIT_POINT, 3.0) for ray in rays}
    said = sentence(faked(ends | {SLANTED: (Status.STEP_TOO_SMALL, 2.5)}))
    assert "workspace at 40 kPa does not exist" in said
    assert "1 of 26 combinations has no answer that is known" in said


def test_a_ray_that_no_combination_is_on_takes_none_of_them_away() -> None:
    """With a lowest level above zero each supply alone is followed, but is not asked for.

    The beam's workspace exists whole then; the box that is safe from rest on is smaller.
    """
    found = faked({ONE: (Status.LIMIT_POINT, 30.0)}, levels=[20, 30, 40])
    assert found.unanswered == 0
    assert found.holds
    said = sentence(found)
    assert "all 27 combinations have a stable answer" in said
    assert "exist" not in said
    assert found.stable_box == 30


@pytest.mark.parametrize(
    ("wound", "condition", "way_out"),
    [
        (None, "unreinforced, ", "wind every chamber"),
        (Wound.OUTER, "with the outside wound, ", "wind every chamber"),
        (Wound.CHAMBERS, "with its chambers wound, ", "thicken the walls"),
        (Wound.BOTH, "with its chambers and the outside wound, ", "thicken the walls"),
    ],
)
def test_winding_is_told_and_not_advised_twice(
    wound: Wound | None, condition: str, way_out: str
) -> None:
    found = faked({ALIKE: LIMIT}, wound=wound)
    assert sentence(found).startswith(condition)
    said = advice(found)
    assert said is not None
    assert said.startswith("stay below 18.1 kPa in every supply (27.2 kPa over a margin of 1.5")
    assert way_out in said
    calm = faked({}, wound=wound)
    assert sentence(calm).startswith(condition)
    assert advice(calm) is None


@pytest.mark.parametrize(
    ("share", "holds", "judged"),
    [
        (0.0, True, "the beam holds"),
        (0.04, True, "the beam holds"),
        (0.31, False, "not be trusted"),
    ],
)
def test_all_answered(share: float, holds: bool, judged: str) -> None:
    found = faked({}, share=share)
    said = sentence(found)
    assert found.holds is holds
    assert found.worst == pytest.approx(share, abs=1e-9)
    assert "up to 40 kPa all 26 combinations have a stable answer" in said
    assert judged in said
    assert f"{100 * share:.3g} %" in said
    assert "asked 5 %" in said
    assert found.stable_box == found.safe_box.pressure == found.largest == 40
    assert found.certain


def test_no_solid() -> None:
    subject, options = soft_subject(), options_of()
    failure = MeshFailure(MeshProblem.FATAL, "2 separate pieces")
    law = options.law_for(subject.design.actuator)
    found = Prediction(subject, options, law, failure, None, {}, (), (), {})
    assert sentence(found).startswith("no answer: ")
    assert "2 separate pieces" in verdict(found)
    assert advice(found) is None
    assert not found.holds
    assert np.isnan(found.tips).all()


@pytest.mark.parametrize("levels", [[0, 20, 40], [1, 2, 3]])
def test_worst_and_median_are_over_what_has_an_answer(levels: list[int]) -> None:
    changes: dict[str, Any] = {"levels": levels, "share": 0.25}
    found = faked({ALIKE: (Status.LIMIT_POINT, levels[0] + 0.5)}, **changes)
    assert found.worst == pytest.approx(0.25)
    assert found.median == pytest.approx(0.25)
    assert not found.holds
