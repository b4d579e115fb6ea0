"""Replies, and what they cost."""

import subprocess
import sys

import numpy as np
import pytest

from beamopt.rod.status import RodStatus
from femcheck.check.options import CheckOptions
from femcheck.continuation.ended import FOUND, Ended
from femcheck.continuation.outcome import Status
from femcheck.mesh.gmsh_section import MeshProblem
from femcheck.models.question import Question
from femcheck.models.reply import Reply, cpu_seconds, nothing
from tests.femcheck.check.small import design_of, three_circles

TIPS = np.array([[0.0, 0.0, 1.0], [0.0, 3.0, 1.0], [np.nan] * 3])


def test_what_is_found_and_why_the_rest_is_not() -> None:
    limit = Ended(Status.LIMIT_POINT, 3.0)
    reply = Reply(TIPS, (FOUND, Ended(RodStatus.CONVERGED), limit))
    assert reply.found.tolist() == [True, True, False]
    assert not reply.is_whole
    assert reply.ended is limit
    assert Reply(TIPS[:2], (FOUND, FOUND)).ended == FOUND


def test_the_commonest_status_is_said_with_its_lowest_load() -> None:
    late, *limits = (
        Ended(Status.TIME_OUT, 1.0),
        Ended(Status.LIMIT_POINT, 4.0),
        Ended(Status.LIMIT_POINT, 3.0),
    )
    assert Reply(TIPS, (late, *limits)).ended is limits[1]
    assert Reply(TIPS, (FOUND, FOUND, late)).ended is late


def test_away_is_a_length_or_nothing() -> None:
    away = Reply(TIPS, (FOUND,) * 3).away(np.zeros((3, 3)))
    assert away[:2].tolist() == [1.0, pytest.approx(np.sqrt(10))]
    assert np.isnan(away[2])


def test_nothing_has_an_ending_a_tip() -> None:
    question = Question.of("small", design_of(three_circles()), CheckOptions(), np.zeros((2, 3)))
    crashed = Ended(MeshProblem.CRASHED, detail="exit code 3")
    assert nothing(question, crashed).endings == (crashed, crashed)
    assert np.isnan(nothing(question, crashed).tips).all()
    assert nothing(question, crashed).tips.shape == (2, 3)


def test_processes_count() -> None:
    """What a process that was waited for took is in; waiting itself is not."""
    work = "import time\nwhile time.process_time() < 0.3: pass"
    before = cpu_seconds()
    subprocess.run([sys.executable, "-c", work], check=True)
    assert cpu_seconds() - before > 0.25  # children's are in hundredths of a second
