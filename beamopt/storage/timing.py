"""The times of a search: `timing.csv`, beside the results, which do not depend on them."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from beamopt.storage.input_file import read_text
from beamopt.storage.writing import csv_text, write_atomic

__all__ = ["Timing", "read_times", "write_times"]

HEADER = "what,value,unit"
OF_SEARCH = ("search", "evaluation", "compilation")


@dataclass(frozen=True, slots=True)
class Timing:
    """Duration of one call of a search.

    seconds : from the first section that it judged to the end [s]; what an earlier call had judged
        is not in it. judged : sections judged in that time.
    compiling : before it, for kernels to be compiled or loaded, and for one section [s].
    """

    seconds: float = 0.0
    judged: int = 0
    compiling: float = 0.0

    @property
    def evaluation(self) -> float | None:
        """Seconds a section; None where none was judged."""
        return self.seconds / self.judged if self.judged else None


def read_times(file: Path) -> dict[str, float]:
    """The seconds in a `timing.csv`, by what took them; none where there is no such table."""
    try:
        rows = csv.DictReader(read_text(file).splitlines())
        return {row["what"]: float(row["value"]) for row in rows}
    except (ValueError, KeyError, TypeError, csv.Error):
        return {}


def write_times(file: Path, timing: Timing, others: Mapping[str, float]) -> None:
    """Write what a search took, and `others` [s]; where nothing was judged, what stands there."""
    times: dict[str, float | None] = {
        "search": timing.seconds,
        "evaluation": timing.evaluation,
        "compilation": timing.compiling,
    }
    if not timing.judged:
        earlier = read_times(file)
        times |= {name: earlier[name] for name in OF_SEARCH if name in earlier}
    times |= others
    rows = [(name, value, "s") for name, value in times.items() if value is not None]
    write_atomic(file, csv_text(HEADER, rows))
