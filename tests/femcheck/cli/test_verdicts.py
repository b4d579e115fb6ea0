"""Exit codes: 0 holds, 1 does not hold, 3 could not be computed."""

from dataclasses import replace

import numpy as np
import pytest

from beamopt.cli.exit_codes import ExitCode, joined
from femcheck.chart.chart import Chart
from femcheck.chart.reference import Limit, Reference
from femcheck.check.checked import Checked
from femcheck.check.comparison import Comparison, SolidTips
from femcheck.check.options import CheckOptions
from femcheck.cli.verdicts import code_of
from femcheck.continuation.outcome import Status
from femcheck.mesh.gmsh_section import MeshFailure, MeshProblem
from femcheck.models.question import Question
from femcheck.prediction.options import PredictionOptions
from femcheck.prediction.prediction import Prediction
from femcheck.regression.regression import Regression
from tests.femcheck.check.small import small_subject

HOLDS, DIFFERS, LOST = ExitCode.HOLDS, ExitCode.DOES_NOT_HOLD, ExitCode.NOT_COMPUTED
SUBJECT = small_subject()
OPTIONS = CheckOptions()


def checked(off: float = 0.0, endings: dict[int, Status] | None = None) -> Checked:
    """A check whose solid is `off` [mm] beside the beam, without a tip where there is an ending."""
    tips, statuses = SUBJECT.beam_tips + np.array([off, 0.0, 0.0]), [Status.CONVERGED] * 27
    for row, status in (endings or {}).items():
        tips[row], statuses[row] = np.nan, status
    nothing = np.zeros(27)
    solid = SolidTips("standard", np.inf, tips, tips, tuple(statuses), nothing, nothing.astype(int))
    compared = Comparison(SUBJECT, (solid, replace(solid, mesh="coarse")), 2.0, 1.0)
    return Checked(SUBJECT, OPTIONS, None, compared, None, None, (), {})


def without(problem: MeshProblem) -> Checked:
    return Checked(SUBJECT, OPTIONS, MeshFailure(problem), None, None, None, (), {})


@pytest.mark.parametrize(
    ("found", "code"),
    [
        (checked(), HOLDS),
        (checked(off=5.0), DIFFERS),
        (checked(endings={9: Status.LIMIT_POINT}), DIFFERS),
        (checked(endings={9: Status.BEYOND_LAW, 3: Status.TIME_OUT}), DIFFERS),
        (checked(endings={9: Status.WORK_LIMIT}), LOST),
        (checked(endings={9: Status.TIME_OUT}), LOST),
        (checked(endings={9: Status.STOPPED}), LOST),
        (checked(off=5.0, endings={9: Status.STOPPED}), DIFFERS),
        (checked(endings={0: Status.STOPPED}), HOLDS),  # no pressure: nothing to compare
        (without(MeshProblem.NO_GMSH), LOST),
        (without(MeshProblem.HUNG), LOST),
        (without(MeshProblem.FATAL), DIFFERS),
    ],
)
def test_of_a_check(found: Checked, code: ExitCode) -> None:
    assert code_of(found) is code
    assert (code is HOLDS) == found.holds


def test_of_a_prediction_without_gmsh() -> None:
    options = PredictionOptions()
    law = options.law_for(SUBJECT.design.actuator)
    missing = MeshFailure(MeshProblem.NO_GMSH)
    found = Prediction(SUBJECT, options, law, missing, None, {}, (), (), {})
    assert code_of(found) is LOST
    assert (found.unanswered, found.holds) == (0, False)


@pytest.mark.parametrize(
    ("moved", "late", "code"),
    [(0, 0, HOLDS), (1, 0, DIFFERS), (0, 1, LOST), (1, 1, DIFFERS)],
)
def test_of_a_regression(moved: int, late: int, code: ExitCode) -> None:
    found = Regression((None,) * moved, (None,) * late, (), 1, 1)  # type: ignore[arg-type]
    assert code_of(found) is code


def test_of_a_chart() -> None:
    question = Question.of("disc", SUBJECT.design, OPTIONS)
    tips, band = SUBJECT.beam_tips, np.full(27, 0.1)
    near, far = (Limit("other", tips + off, band) for off in (0.01, 1.0))
    nowhere = Limit("other", np.full((27, 3), np.nan), band)
    for others, code in (((), HOLDS), ((near, nowhere), HOLDS), ((near, far), DIFFERS)):
        assert code_of(Chart(question, (), Reference("one", tips, band, others=others))) is code
    assert code_of(Chart(question, (), None)) is LOST


def test_one_that_does_not_hold_settles_it() -> None:
    assert joined([HOLDS, LOST, DIFFERS]) is DIFFERS
    assert joined([HOLDS, LOST]) is LOST
    assert joined([]) is HOLDS
