"""Tables of numbers that people write: comma-separated, columns matched by name."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.errors import InputError
from beamopt.storage.input_file import read_text

__all__ = ["Table", "read_table"]

MOST_ROWS = 100_000
FARTHEST = 1e6  # mm, kPa; beyond any actuator


@dataclass(frozen=True, eq=False)
class Table:
    """Rows of numbers.

    path : the file. lines : number of each row's line there, from 1. header : all of its columns.
    columns : (n,) values of those that were asked for; NaN where an optional one is blank.
    """

    path: Path
    lines: tuple[int, ...]
    header: tuple[str, ...]
    columns: Mapping[str, FloatArray]

    def __len__(self) -> int:
        return len(self.lines)

    def stacked(self, names: Sequence[str]) -> FloatArray:
        """(n, len(names)) columns side by side."""
        return np.stack([self.columns[name] for name in names], axis=-1)

    def fault(self, row: int, name: str, allowed: str) -> InputError:
        """What to raise for a value that is a number but can not be meant."""
        value = self.columns[name][row]
        shown = "" if np.isnan(value) else f"{value:g}"
        return InputError(self.path, f"line {self.lines[row]}, {name}", shown, allowed)


def read_table(
    path: Path, units: Mapping[str, str], optional: Mapping[str, str] | None = None
) -> Table:
    """Read a table; lines that start with # are comments, other columns are not looked at.

    units : of the columns that must be there, as "kPa". optional : of those that need not be, and
        whose cells may be blank.

    Raises
    ------
    InputError : the file, line, column and value of the first thing that is wrong.
    """
    lines = [
        (number, line)
        for number, line in enumerate(read_text(path).splitlines(), 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if len(lines) > MOST_ROWS:
        raise InputError(path, "rows", len(lines), f"at most {MOST_ROWS} (take every n-th)")
    names = ",".join(units)
    if not lines:
        raise InputError(path, "", "an empty file", f"a table with the columns {names}")
    header = [name.strip() for name in _cells(path, *lines[0])]
    may_be_there = optional or {}
    for name in (*units, *may_be_there):
        if header.count(name) > 1 or (name in units and name not in header):
            asked = names if name in units else name
            raise InputError(path, "header", ",".join(header), f"must name {asked} once each")
    known = {**units, **{name: unit for name, unit in may_be_there.items() if name in header}}
    rows = [_numbers(path, number, line, header, known, units) for number, line in lines[1:]]
    values = np.array(rows, dtype=np.float64).reshape(len(rows), len(known))
    columns = {name: np.full(len(rows), np.nan) for name in may_be_there}
    columns |= {name: values[:, k] for k, name in enumerate(known)}
    return Table(path, tuple(number for number, _ in lines[1:]), tuple(header), columns)


def _numbers(
    path: Path,
    number: int,
    line: str,
    header: Sequence[str],
    known: Mapping[str, str],
    needed: Mapping[str, str],
) -> list[float]:
    """The values of one line, in the order of `known`."""
    cells = _cells(path, number, line)
    if len(cells) > len(header):
        said = f"has more cells than the {len(header)} columns"
        raise InputError(path, f"line {number}", line, said)
    values = []
    for name, unit in known.items():
        place = header.index(name)
        text = cells[place].strip() if place < len(cells) else ""
        if not text and name not in needed:
            values.append(np.nan)
            continue
        try:
            value = float(text)
        except ValueError:
            value = np.nan
        if not abs(value) <= FARTHEST:
            said = "a finite number" + (f" of {unit}" if unit else "")
            raise InputError(path, f"line {number}, {name}", text, said)
        values.append(value)
    return values


def _cells(path: Path, number: int, line: str) -> list[str]:
    try:
        return next(csv.reader([line]))
    except csv.Error as error:
        raise InputError(path, f"line {number}", None, f"no row of a table: {error}") from None
