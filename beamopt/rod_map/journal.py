"""Samples of the stability map on disk as they come: a kill loses those under way only."""

from __future__ import annotations

from functools import partial
from typing import Any

from beamopt.rod.status import RodStatus
from beamopt.rod_map.cases import case_of
from beamopt.rod_map.sampling import MethodSample, Sample
from beamopt.rod_map.verdict import MethodVerdict, Witness
from beamopt.storage.line_journal import LineJournal

__all__ = ["SCHEMA", "line_of", "samples_in"]

SCHEMA = "beamopt-stability/1"


def samples_in(journal: LineJournal) -> dict[int, Sample]:
    """Samples of a journal by the index of their case.

    Raises
    ------
    InputError : the journal is damaged.
    """
    read = journal.read(partial(_sample, journal.asked["seed"]))
    return {sample.case.index: sample for sample in read}


def line_of(sample: Sample) -> dict[str, Any]:
    """A sample as a line of a journal."""
    return {
        "index": sample.case.index,
        "witness": sample.witness.name,
        "truth": sample.truth.name,
        "gap": sample.gap,
        "seconds": sample.seconds,
        "rows": [
            (
                *(row.method, row.resolution, row.verdict.name, row.status.name),
                *(row.distance, row.seconds),
            )
            for row in sample.rows
        ],
    }


def _sample(seed: int, data: dict[str, Any]) -> Sample:
    case = case_of(seed, data["index"])
    rows = tuple(
        MethodSample(
            case, method, resolution, MethodVerdict[verdict], RodStatus[status], distance, seconds
        )
        for method, resolution, verdict, status, distance, seconds in data["rows"]
    )
    # earlier versions wrote names in small letters
    witness, truth = Witness[data["witness"].upper()], RodStatus[data["truth"]]
    return Sample(case, witness, truth, data["gap"], rows, data["seconds"])
