"""What charts have taught: how far a solid of so many layers is off, and what it costs.

`knowledge.csv` is written by `python -m femcheck.accuracy.knowledge CHART…` of the chart folders
under reports/chart.
"""

from __future__ import annotations

import csv
import io
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files
from pathlib import Path

import numpy as np

from beamopt.storage.writing import csv_text, write_atomic
from femcheck.models.question import Question
from femcheck.models.solid import SolidModel

__all__ = ["MATERIAL", "ORDERS", "RIGID", "Level", "learnt", "levels_for", "scale_of"]

FILE = "knowledge.csv"
HEADER = "law,layers,size,grading,error_over_scale,cpu_seconds,charts"
RIGID, MATERIAL = "rigid-section", "material"
ORDERS = {RIGID: 4.0, MATERIAL: 2.0}
"""In which the tips' error falls with the layers: of a bending rod, and of a clamp's end effect."""

FINER = {RIGID: (12, 16), MATERIAL: (12, 16, 24)}
"""Layers beyond the charts, as far as they are; errors follow from the order."""


@dataclass(frozen=True, slots=True)
class Level:
    """A solid, the error to expect of it over the question's scale, and its cost [s]."""

    model: SolidModel
    error: float
    seconds: float


def scale_of(question: Question) -> float:
    """What errors go with [mm]: L θ⁴ for the beam's own law, the beam's displacement for others.

    θ : the largest turn of the beam [rad].
    """
    subject = question.subject
    length = subject.design.actuator.length
    strains = subject.response.strains(question.pressures)
    turn = float(np.hypot(strains[:, 1], strains[:, 2]).max()) * length
    if question.is_of_the_beam:
        return max(length * turn**4, 1e-3)  # a straight tip has rounding left
    from femcheck.models.beam import RodOnOutline

    tips = RodOnOutline().reply(question).tips
    moved = np.linalg.norm(tips - np.array([0.0, 0.0, length]), axis=1)
    return max(float(moved.max()), 1e-3)


def levels_for(question: Question) -> tuple[Level, ...]:
    """Solids for a question's law from coarse to fine."""
    kind = RIGID if question.is_of_the_beam else MATERIAL
    return _read()[kind]


@lru_cache(maxsize=1)
def _read() -> dict[str, tuple[Level, ...]]:
    text = files("femcheck.accuracy").joinpath(FILE).read_text(encoding="utf-8")
    found: dict[str, list[Level]] = {RIGID: [], MATERIAL: []}
    for row in csv.DictReader(io.StringIO(text)):
        grading = float(row["grading"]) if row["grading"] else None
        model = SolidModel(layers=int(row["layers"]), size=float(row["size"]), grading=grading)
        level = Level(model, float(row["error_over_scale"]), float(row["cpu_seconds"]))
        found[row["law"]].append(level)
    return {kind: (*levels, *_beyond(kind, levels[-1])) for kind, levels in found.items()}


def _beyond(kind: str, last: Level) -> list[Level]:
    """Finer levels than any chart has, by the order of convergence."""
    found = []
    for layers in (one for one in FINER[kind] if one > last.model.layers):
        more = layers / last.model.layers
        grading = None if last.model.grading is None else last.model.grading * more
        model = SolidModel(layers=layers, size=last.model.size, grading=grading)
        found.append(Level(model, last.error / more ** ORDERS[kind], last.seconds * more**1.5))
    return found


def learnt(charts: Sequence[Path]) -> str:
    """The table of chart folders; of several with one kind of law the largest errors.

    Raises
    ------
    OSError, KeyError, ValueError : a folder is no chart's.
    """
    from femcheck.chart.kept import read_chart

    rows: dict[tuple[str, int, float, float | None], list[tuple[float, float, str]]] = {}
    for folder in sorted(charts, key=lambda one: one.name):
        chart = read_chart(folder)
        if not chart.is_confirmed:
            raise ValueError(f"{folder.name}: no second family confirms its reference")
        kind = RIGID if chart.question.is_of_the_beam else MATERIAL
        scale = scale_of(chart.question)
        for model, row in chart.solids("wedge18"):
            usual = SolidModel(layers=model.layers, size=model.size, grading=model.grading)
            if model == usual and model.size == 2.0 and row.is_whole:
                key = (kind, model.layers, model.size, model.grading)
                found = (row.error / scale, row.measured.seconds, folder.name)
                rows.setdefault(key, []).append(found)
    cells = [
        (*key, f"{max(e for e, _, _ in f):.3g}", f"{max(s for _, s, _ in f):.3g}",
         " ".join(name for _, _, name in f))
        for key, f in sorted(rows.items(), key=lambda item: (item[0][0] != RIGID, item[0][1]))
    ]  # fmt: skip
    return csv_text(HEADER, cells)


if __name__ == "__main__":
    named = [Path(name) for name in sys.argv[1:]]
    charts = named or [file.parent for file in Path("reports/chart").glob("*/journal.jsonl")]
    if not charts:
        sys.exit("knowledge: no chart under reports/chart; name the charts' folders")
    write_atomic(Path(__file__).with_name(FILE), learnt(charts))
