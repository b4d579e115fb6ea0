"""Samples of the stability map on disk as they come: a kill loses those under way only."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

from beamopt.rod.status import RodStatus
from beamopt.rod_map.cases import case_of
from beamopt.rod_map.sampling import MethodSample, Sample
from beamopt.rod_map.verdict import MethodVerdict, Witness
from beamopt.storage.line_journal import LineJournal

__all__ = ["SampleJournal"]

SCHEMA = "beamopt-stability/1"


class SampleJournal:
    """A file with a line that says what is sampled, and one a sample.

    path : of the file. asked : what the samples depend on; that of a file that is there must be
    the same.

    Raises
    ------
    InputError : the file that is there is another one's.
    """

    def __init__(self, path: Path, asked: dict[str, Any]) -> None:
        self.path = path
        self._lines = LineJournal(path, {"schema": SCHEMA, **asked}, "stability map")
        read = self._lines.read(partial(_sample, asked["seed"]))
        self.samples = {sample.case.index: sample for sample in read}

    def add(self, sample: Sample) -> None:
        """Keep a sample."""
        self.samples[sample.case.index] = sample
        self._lines.add(_data(sample))


def _data(sample: Sample) -> dict[str, Any]:
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
