"""Replies, and what they cost."""

import subprocess
import sys

import numpy as np
import pytest

from femcheck.check.options import CheckOptions
from femcheck.models.question import Question
from femcheck.models.reply import FOUND, Reply, cpu_seconds, nothing
from tests.femcheck.check.small import design_of, three_circles

TIPS = np.array([[0.0, 0.0, 1.0], [0.0, 3.0, 1.0], [np.nan] * 3])


def test_what_is_found_and_why_the_rest_is_not() -> None:
    reply = Reply(TIPS, (FOUND, FOUND, "limit point at P = 3 kPa"))
    assert reply.found.tolist() == [True, True, False]
    assert not reply.is_whole
    assert reply.reason == "limit point at P = 3 kPa"
    assert Reply(TIPS[:2], (FOUND, FOUND)).reason == FOUND


def test_the_commonest_reason_is_said() -> None:
    assert Reply(TIPS, ("a", "b", "b")).reason == "b"
    assert Reply(TIPS, (FOUND, FOUND, "b")).reason == "b"


def test_away_is_a_length_or_nothing() -> None:
    away = Reply(TIPS, (FOUND,) * 3).away(np.zeros((3, 3)))
    assert away[:2].tolist() == [1.0, pytest.approx(np.sqrt(10))]
    assert np.isnan(away[2])


def test_nothing_has_a_reason_a_tip() -> None:
    question = Question.of("small", design_of(three_circles()), CheckOptions(), np.zeros((2, 3)))
    assert nothing(question, "no mesh").reasons == ("no mesh", "no mesh")
    assert nothing(question, ["a", "b"]).reasons == ("a", "b")
    assert np.isnan(nothing(question, "no mesh").tips).all()
    assert nothing(question, "no mesh").tips.shape == (2, 3)


def test_processes_count() -> None:
    """What a process that was waited for took is in; waiting itself is not."""
    work = "import time\nwhile time.process_time() < 0.3: pass"
    before = cpu_seconds()
    subprocess.run([sys.executable, "-c", work], check=True)
    assert cpu_seconds() - before > 0.25  # children's are in hundredths of a second
