"""Copies of a design that are checked in its place."""

import numpy as np
import pytest

from beamopt.rod.arc import arc_tips
from femcheck.solved.subject import Subject, slender_copy
from tests.femcheck.check.small import design_of, small_subject, three_circles


@pytest.mark.parametrize("slenderness", [0.2, 2.0, 10 / 3, 25.0])
def test_a_slender_copy_has_the_length_and_the_beam_of_it(slenderness: float) -> None:
    """H/D times D = 30 mm; the strains are the section's and stay, the tips are an arc's of H."""
    subject = small_subject()
    copy = slender_copy(subject, slenderness)
    length = copy.design.actuator.length
    assert length == pytest.approx(30 * slenderness)
    assert copy.slenderness == pytest.approx(slenderness)
    assert type(copy) is type(subject)
    assert copy.name == subject.name
    np.testing.assert_array_equal(copy.response.matrix, subject.response.matrix)
    strains = subject.response.strains(subject.pressures)
    np.testing.assert_allclose(copy.beam_tips, arc_tips(strains, length), atol=1e-12)
    # an arc of twice the length turns twice as far
    assert copy.largest_turn == pytest.approx(subject.largest_turn * length / 100)
    # everything but the length is the design's
    changed = copy.design.model_dump()
    changed["actuator"]["length"] = subject.design.actuator.length
    assert changed == subject.design.model_dump()


def test_the_same_length_changes_nothing() -> None:
    subject = small_subject()
    copy = slender_copy(subject, subject.slenderness)
    np.testing.assert_allclose(copy.beam_tips, subject.beam_tips, atol=1e-12)


def test_what_sealing_moved_stays_with_the_copy() -> None:
    moved = np.arange(27.0)
    subject = Subject("sealed", design_of(three_circles()), moved)
    assert slender_copy(subject, 2.0).sealing_moved is moved


@pytest.mark.parametrize("slenderness", [0.0, -1.0, np.nan, np.inf, 0.09 / 30, 1.1e5 / 30])
def test_lengths_that_no_design_has_are_refused(slenderness: float) -> None:
    with pytest.raises(ValueError, match="length"):
        slender_copy(small_subject(), slenderness)
