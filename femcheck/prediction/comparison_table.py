"""Beam and solid at each combination, as a table."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.storage.writing import csv_text
from femcheck.check.tables import COMPARE, both, cells, plain
from femcheck.prediction.answer import Answer
from femcheck.prediction.prediction import Prediction

__all__ = ["compare_csv", "ratios_of", "stretch_cells"]

MORE = ",ends_at_kpa,snaps_at_kpa,largest_stretch,stretch_at_x,stretch_at_y,stretch_at_z"


def compare_csv(found: Prediction) -> str:
    """Tips of solid and beam, a row a combination and mesh."""
    return csv_text(COMPARE + MORE, _compare(found))


def _compare(found: Prediction) -> Iterator[tuple[object, ...]]:
    """Every combination on the standard mesh, those of the principal rays on the coarse one."""
    subject, length = found.subject, found.subject.design.actuator.length
    beam, displacement = subject.beam_tips, found.displacement
    for mesh in found.solids:
        tips = found.tips_on(mesh)
        difference = np.linalg.norm(tips - beam, axis=1)
        for row, pressures in enumerate(subject.pressures.tolist()):
            place, moved = found.places[row], displacement[row]
            if place is not None and (mesh, place[0]) not in found.results:
                continue
            answer = found.answer(row, mesh)
            yield (
                found.options.law,
                None,
                found.options.poisson_ratio,
                mesh,
                *map(plain, pressures),
                *cells(beam[row]),
                *cells(tips[row]),
                *cells([difference[row], difference[row] / length]),
                *cells([difference[row] / moved if moved > 0 else math.nan]),
                *cells(ratios_of(found, mesh, answer)),
                *both(found.status(row, mesh)),
                *cells([found.ended_at(row, mesh), found.snap(row, mesh)]),
                *stretch_cells(answer),
            )


def ratios_of(found: Prediction, mesh: str, answer: Answer | None) -> FloatArray:
    """(3,) volume of each supply's chambers over that at rest; NaN for a supply without any."""
    if answer is None:
        return np.full(3, np.nan)
    length = found.subject.design.actuator.length
    rest = found.solids[mesh].section.moments.chamber_areas * length
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(np.where(rest > 0, answer.volumes / rest, np.nan))


def stretch_cells(answer: Answer | None) -> list[object]:
    """Cells of the largest stretch and its place; empty without an answer."""
    return [None] * 4 if answer is None else cells([answer.stretch, *answer.stretch_at])
