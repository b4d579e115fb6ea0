"""Everything solved so far, a line each: a kill loses what was under way and nothing else."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from beamopt.base.errors import InputError
from beamopt.storage.line_journal import LineJournal
from femcheck.stability.axis import Axis
from femcheck.stability.ending import MapEnding
from femcheck.stability.solve import CellResult, TraceResult
from femcheck.stability.work import FINER, TRACE, Key, Result

__all__ = ["SCHEMA", "MapJournal"]

SCHEMA = "femcheck-stability/1"
NOT_A_NUMBER = None  # JSON has no NaN


class MapJournal:
    """A file with a line that says what it is, and one a task.

    Parameters
    ----------
    path : of the file; made where there is none.
    axes : what is asked for. Lines of other axes stay for the day they are.

    Raises
    ------
    InputError : the file that is there is no journal, or its axes are not what they are now.
    """

    def __init__(self, path: Path, axes: Mapping[str, Axis]) -> None:
        self.results: dict[Key, Result] = {}
        self._lines = LineJournal(path, {"schema": SCHEMA}, "stability map of solids")
        read = self._lines.read(lambda data: (_key(data), str(data["question"]), _result(data)))
        for key, question, result in read:
            self._take(key, question, result, axes)

    def _take(self, key: Key, question: str, result: Result, axes: Mapping[str, Axis]) -> None:
        name, column, number = key
        if name not in axes:
            return
        axis = axes[name]
        known = column < len(axis.columns) and number < len(axis.pressures)
        if not known or question != axis.digest(column):
            said = "what is there is of another map (specimens, pressures); name another folder"
            raise InputError(self._lines.path, f"axis {name}", None, said)
        self.results[key] = result

    def add(self, axis: Axis, key: Key, result: Result) -> None:
        """Keep a result."""
        self.results[key] = result
        name, column, number = key
        data = {"axis": name, "column": column, "number": number, "question": axis.digest(column)}
        data |= asdict(result) | {"ending": result.ending.name}
        if isinstance(result, TraceResult):
            data["track"] = [[_or_null(value) for value in row] for row in result.track]
        self._lines.add(data)


TRACES = TypeAdapter(TraceResult)
CELLS = TypeAdapter(CellResult)
"""Checks that every value is of its kind, which lines without digests need not be."""


def _or_null(value: float) -> float | None:
    return value if value == value else NOT_A_NUMBER


def _or_nan(value: float | None) -> float:
    return float("nan") if value is None else value


def _key(data: dict[str, Any]) -> Key:
    return str(data["axis"]), int(data["column"]), int(data["number"])


def _result(data: dict[str, Any]) -> Result:
    values = {k: v for k, v in data.items() if k not in ("axis", "column", "number", "question")}
    values["ending"] = MapEnding[values["ending"]]
    if data["number"] in (TRACE, FINER):
        values["snaps"] = tuple(values["snaps"])
        values["track"] = tuple(tuple(_or_nan(one) for one in row) for row in values["track"])
        return TRACES.validate_python(asdict(TraceResult(**values)))
    for name in ("tip", "beam"):
        values[name] = None if values[name] is None else tuple(values[name])
    return CELLS.validate_python(asdict(CellResult(**values)))
