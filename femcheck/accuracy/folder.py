"""Answers to an accuracy as a folder: tips with estimates, what was tried, what it cost."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from beamopt.base.provenance import provenance
from beamopt.storage.campaign import claimed_journal
from beamopt.storage.line_journal import LineJournal
from beamopt.storage.result_folder import FolderKind
from beamopt.storage.writing import csv_text, json_text, write_atomic
from femcheck.accuracy.ending import Ending, Within, tips_csv
from femcheck.accuracy.within import Progress, RungChoice, answer_within, check_asked
from femcheck.chart.kept import asked_of, measured_in
from femcheck.chart.measure import Measured, key_of, written
from femcheck.models.question import Question
from femcheck.models.reply import Model
from femcheck.solved.folder import PACKAGES

__all__ = ["run_accuracy"]

JOURNAL = "journal.jsonl"
FILES = (
    *("design.json", "tips.csv", "tried.csv", "timing.csv", "summary.json"),
    "provenance.json",
)
KIND = FolderKind(
    "answers to an accuracy", JOURNAL, ('{"schema":"femcheck-accuracy/',), files=FILES
)
TRIED = "model,unknowns,size,found,of"


@dataclass(frozen=True, eq=False)
class _Journal:
    """Replies on disk."""

    lines: LineJournal
    known: dict[str, Measured]

    def find(self, model: Model) -> Measured | None:
        return self.known.get(key_of(model))

    def keep(self, measured: Measured) -> None:
        self.lines.add(written(measured))


def run_accuracy(
    question: Question,
    accuracy: float,
    out: Path,
    *,
    rung: RungChoice = "auto",
    most_seconds: float = np.inf,
    workers: int = 0,
    resume: bool = False,
    progress: Progress | None = None,
) -> Within:
    """Answer to `accuracy` [mm] and write what was found to `out`; see `answer_within`.

    resume : go on with what is in `out`.

    Raises
    ------
    InputError : `out` holds something else, or can not be written; see also `answer_within`.
    """
    check_asked(question, accuracy, rung)
    asked = asked_of(question) | {"schema": "femcheck-accuracy/1", "accuracy": accuracy}
    with claimed_journal(out, KIND, asked, "question of this accuracy", resume=resume) as lines:
        found = answer_within(
            question,
            accuracy,
            rung=rung,
            most_seconds=most_seconds,
            workers=workers,
            progress=progress,
            kept=_Journal(lines, measured_in(lines, question.law.limits.iterations)),
        )
        _write(found, out)
    return found


def _write(found: Within, out: Path) -> None:
    found.question.design.save(out / "design.json")
    write_atomic(out / "tips.csv", tips_csv(found))
    tried = [
        (one.name, one.reply.unknowns, one.reply.size,
         int(one.reply.found.sum()), len(one.reply.endings))
        for one in found.tried
    ]  # fmt: skip
    write_atomic(out / "tried.csv", csv_text(TRIED, tried))
    times = [(row[0], one.seconds, "s") for row, one in zip(tried, found.tried, strict=True)]
    write_atomic(out / "timing.csv", csv_text("what,value,unit", times))
    write_atomic(out / "summary.json", json_text(_summary(found)))
    write_atomic(out / "provenance.json", json_text(provenance(PACKAGES)))


def _summary(found: Within) -> dict[str, Any]:
    worst = found.worst
    return {
        "design": found.question.name,
        "law": found.question.law_text,
        "accuracy_mm": found.accuracy,
        "ending": found.ending.value,
        "ended": found.ending.name,
        "reached": found.ending is Ending.REACHED,
        "chosen": found.chosen,
        "reason": found.reason,
        "compared_with": list(found.compared_with),
        "estimate_is": found.source.value,
        "estimate_source": found.source.name,
        "worst_estimate_mm": None if np.isnan(worst) else float(f"{worst:.4g}"),
    }
