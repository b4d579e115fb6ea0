"""Everything solved so far, a line each: a kill loses what was under way and nothing else."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from pydantic import TypeAdapter

from beamopt.base.errors import InputError
from beamopt.storage.line_journal import LineJournal
from femcheck.stability.axis import Axis
from femcheck.stability.ending import MapEnding
from femcheck.stability.solve import CellResult, TraceResult
from femcheck.stability.work import FINER, TRACE, Key, Result

__all__ = ["ASKED", "SUBJECT", "line_of", "results_in"]

ASKED, SUBJECT = {"schema": "femcheck-stability/1"}, "stability map of solids"
NOT_A_NUMBER = None  # JSON has no NaN


def results_in(journal: LineJournal, axes: Mapping[str, Axis]) -> dict[Key, Result]:
    """Results of a journal that are of `axes`; lines of others stay for the day they are asked for.

    Raises
    ------
    InputError : the journal is damaged, or its axes are not what they are now.
    """
    results: dict[Key, Result] = {}
    read = journal.read(lambda data: (_key(data), str(data["question"]), _result(data)))
    for key, question, result in read:
        name, column, number = key
        if name not in axes:
            continue
        axis = axes[name]
        known = column < len(axis.columns) and number < len(axis.pressures)
        if not known or question != axis.digest(column):
            said = "what is there is of another map (specimens, pressures); name another folder"
            raise InputError(journal.path, f"axis {name}", None, said)
        results[key] = result
    return results


def line_of(axis: Axis, key: Key, result: Result) -> dict[str, Any]:
    """A result as a line of a journal."""
    name, column, number = key
    data = {"axis": name, "column": column, "number": number, "question": axis.digest(column)}
    data |= asdict(result) | {"ending": result.ending.name}
    if isinstance(result, TraceResult):
        data["track"] = [[_or_null(value) for value in row] for row in result.track]
    return data


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
