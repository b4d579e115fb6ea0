"""Exit codes of what was found: it holds, it does not, or it could not be computed."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from beamopt.cli.exit_codes import ExitCode, joined
from femcheck.accuracy.ending import Ending, Within, beam_difference
from femcheck.chart.chart import Chart
from femcheck.check.checked import Checked
from femcheck.continuation.ended import ReplyStatus
from femcheck.continuation.outcome import Status
from femcheck.mesh.gmsh_section import MeshFailure, MeshProblem
from femcheck.prediction.prediction import Prediction
from femcheck.regression.regression import Regression
from femcheck.stability.ending import MapEnding as CellEnding
from femcheck.stability.found import AxisFound, agreement_of

__all__ = ["code_of"]

Found = Checked | Prediction | Within | Chart | Regression | Sequence[AxisFound]


def code_of(found: Found, agree: float = 0.05) -> ExitCode:
    """The exit code of a result.

    agree : of answers to an accuracy, the difference allowed between beam and solid, as a share of
        displacement.
    """
    if isinstance(found, Checked):
        return _of_check(found)
    if isinstance(found, Prediction):
        return _of_prediction(found)
    if isinstance(found, Within):
        return _of_answer(found, agree)
    if isinstance(found, Chart):
        return _of_chart(found)
    if isinstance(found, Regression):
        return _either(bool(found.moved), bool(found.late))
    return _of_map(found)


def _either(differs: bool, unknown: bool) -> ExitCode:
    if differs:
        return ExitCode.DOES_NOT_HOLD
    return ExitCode.NOT_COMPUTED if unknown else ExitCode.HOLDS


def _of_statuses(statuses: Iterable[ReplyStatus]) -> ExitCode:
    """Of cases without an answer: the actuator has none, or the computation lost it."""
    codes = (
        ExitCode.DOES_NOT_HOLD if status.is_settled else ExitCode.NOT_COMPUTED
        for status in statuses
        if status is not Status.CONVERGED
    )
    return joined(codes)


def _of_failure(failure: MeshFailure | None) -> ExitCode:
    """No solid: the outline is to blame, or gmsh."""
    fatal = failure is not None and failure.problem is MeshProblem.FATAL
    return ExitCode.DOES_NOT_HOLD if fatal else ExitCode.NOT_COMPUTED


def _of_check(found: Checked) -> ExitCode:
    compared = found.comparison
    if compared is None:
        return _of_failure(found.failure)
    if not compared.moves or compared.worst > found.options.agree:
        return ExitCode.DOES_NOT_HOLD
    rows = np.flatnonzero(compared.is_loaded & np.isnan(compared.difference))
    return _of_statuses(compared.final.statuses[row] for row in rows.tolist())


def _of_prediction(found: Prediction) -> ExitCode:
    if not found.has_answers:
        return _of_failure(found.failure)
    if found.worst > found.options.agree:
        return ExitCode.DOES_NOT_HOLD
    if found.holds:
        return ExitCode.HOLDS
    rows = np.flatnonzero(found.is_loaded)
    # nothing is loaded: there is nothing that could hold
    return _of_statuses(map(found.status, rows.tolist())) or ExitCode.DOES_NOT_HOLD


def _of_answer(found: Within, agree: float) -> ExitCode:
    """Of an answer to an accuracy: tips that are not there, then the beam's distance."""
    if found.reply is None:
        return ExitCode.NOT_COMPUTED
    missing = _of_statuses(one.status for one in found.reply.endings if not one.is_found)
    beam, difference = beam_difference(found)
    straight = np.array([0.0, 0.0, found.question.design.actuator.length])
    moved = np.linalg.norm(beam - straight, axis=1)
    allowed = np.maximum(agree * np.maximum(moved, 1e-2 * moved.max()), found.accuracy)
    known = np.isfinite(difference)
    near = bool((difference[known] <= allowed[known]).all())
    reached = found.ending in (Ending.REACHED, Ending.NO_TIP)
    return joined([missing, _either(reached and not near, not reached)])


def _of_chart(found: Chart) -> ExitCode:
    """Of a chart: other families contradict the reference, or there is none."""
    reference = found.reference
    if reference is None:
        return ExitCode.NOT_COMPUTED
    others = (one for one in reference.others if np.isfinite(reference.apart(one)).any())
    return _either(not all(reference.agrees(one) for one in others), False)


def _of_map(found: Sequence[AxisFound]) -> ExitCode:
    """Of a map: cells contradict the lines, or some were cut short, or there is no solid at all."""
    rows = [row for one in found for row in one.rows]
    endings = {cell.ending for row in rows for _, cell in row.solved}
    lost = any(one.is_interrupted for one in endings) or endings == {CellEnding.NO_MESH}
    return _either(bool(agreement_of(rows).against), lost)
