"""A chart read back from its folder."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from beamopt.base.errors import InputError
from beamopt.scene.design import Design
from beamopt.storage.checked_keys import parse
from beamopt.storage.line_journal import LineJournal
from femcheck.chart.chart import Chart
from femcheck.chart.lineup import line_up, mark_of
from femcheck.chart.measure import Measured, is_final, key_of, read
from femcheck.chart.reference import reference_of
from femcheck.check.options import CheckOptions
from femcheck.material.fibre import Thread
from femcheck.mesh.geo import SectionSizes
from femcheck.models.question import LawChoice, Question
from femcheck.prediction.options import PredictionOptions
from femcheck.solid.winding import Wound

__all__ = ["JOURNAL", "SUBJECT", "asked_of", "chart_of", "measured_in", "read_chart"]

JOURNAL, SUBJECT = "journal.jsonl", "chart"
SCHEMA = "femcheck-chart/1"


def asked_of(question: Question) -> dict[str, Any]:
    """What a journal's replies depend on."""
    return {
        "schema": SCHEMA,
        "name": question.name,
        "design": question.design.json(),
        "law": question.law.question,
        "solver": question.law.solver,
        "pressures": question.pressures.tolist(),
    }


def measured_in(journal: LineJournal, iterations: int = 0) -> dict[str, Measured]:
    """Replies by model, the last one of each; those that were cut short are not among them.

    iterations : the work limit of one case that is asked for now.

    Raises
    ------
    InputError : the journal is damaged.
    """
    measured = dict(journal.read(lambda line: (line["model"], read(line))))
    return {name: one for name, one in measured.items() if is_final(one, iterations)}


def chart_of(question: Question, measured: Mapping[str, Measured]) -> Chart:
    """The chart of all that was measured, whichever families were asked for last."""
    series = [
        one
        for one in line_up(question, whatever=True)
        if any(key_of(model) in measured for model in one.all)
    ]
    known = [
        measured[key_of(model)] for one in series for model in one.all if key_of(model) in measured
    ]
    aside = {key_of(model) for one in series for model in (one.sized, one.stiffer) if model}
    marks = {key_of(model): mark_of(model) for one in series for model in one.all}
    return Chart.of(question, known, reference_of(question, series, measured), aside, marks)


def read_chart(folder: Path) -> Chart:
    """The chart of a folder.

    Raises
    ------
    InputError : it is no chart's, or damaged.
    """
    file = folder / JOURNAL
    try:
        journal = LineJournal(file, None, SUBJECT)
    except OSError:
        raise InputError(file, "", None, "no journal of a chart") from None
    try:
        if journal.asked["schema"] != SCHEMA:
            raise ValueError
        question = _question(journal.asked, file)
    except (ValueError, KeyError, TypeError):
        raise InputError(file, "", None, "no journal of a chart") from None
    return chart_of(question, measured_in(journal))


def _question(asked: dict[str, Any], file: Path) -> Question:
    design = parse(Design, json.loads(asked["design"]), file)
    return Question.of(
        asked["name"],
        design,
        _law(asked["law"], asked["solver"]),
        np.array(asked["pressures"], dtype=np.float64),
    )


def _law(asked: dict[str, Any], solver: str) -> LawChoice:
    """Of `question` of the options."""
    solid: dict[str, Any] = {
        "solver": solver,
        "element": asked["element"],
        "layers": asked["layers"],
        "grading": asked["grading"],
        "sizes": SectionSizes(**asked["sizes"]),
    }
    if "penalties" in asked:
        return CheckOptions(penalties=tuple(asked["penalties"]), **solid)
    if asked["wound"] is not None:
        wound = asked["wound"]
        solid["wound"] = Wound(wound["where"])
        solid["thread"] = Thread(wound["N_per_m"], wound["toe"])
    return PredictionOptions(
        law=asked["law"],
        poisson_ratio=asked["poisson_ratio"],
        constants=asked["constants"],
        **solid,
    )
