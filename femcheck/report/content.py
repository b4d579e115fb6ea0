"""What files hold, taken key by key: what is missing or of another kind is said by its place."""

from __future__ import annotations

import csv
import io
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.errors import InputError
from beamopt.storage.input_file import read_json, read_text
from beamopt.storage.writing import cell_text

__all__ = ["Record", "ReportTable", "read_record", "read_table"]

PLAIN = {str: "text", bool: "true or false", dict: "a table of keys", list: "a list"}


@dataclass(frozen=True, slots=True)
class Record:
    """An object of a JSON file; keys below it are named with points, "verdict.text".

    file : for messages. data : the file's content.
    """

    file: Path
    data: dict[str, Any]

    def has(self, key: str) -> bool:
        """Whether the key stands there with a value that is not null."""
        found: Any = self.data
        for step in key.split("."):
            if not isinstance(found, dict) or found.get(step) is None:
                return False
            found = found[step]
        return True

    def text(self, key: str) -> str:
        """A text.

        Raises
        ------
        InputError : missing, or no text; likewise below.
        """
        return str(self._kind(key, str))

    def flag(self, key: str) -> bool:
        """True or false."""
        return bool(self._kind(key, bool))

    def list(self, key: str) -> list[Any]:
        """A list of anything."""
        return list(self._kind(key, list))

    def table(self, key: str) -> dict[str, Any]:
        """A table of keys."""
        return dict(self._kind(key, dict))

    def number(self, key: str) -> float:
        """A finite number."""
        value = self._value(key)
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise InputError(self.file, key, value, "must be a number")
        try:
            number = float(value)
        except OverflowError:  # a whole number beyond every float
            number = math.inf
        if not math.isfinite(number):
            raise InputError(self.file, key, value, "must be a finite number")
        return number

    def number_or_nan(self, key: str) -> float:
        """A finite number; NaN where it is null or not there."""
        return self.number(key) if self.has(key) else math.nan

    def _kind(self, key: str, kind: type) -> Any:
        value = self._value(key)
        if not isinstance(value, kind):
            raise InputError(self.file, key, value, f"must be {PLAIN[kind]}")
        return value

    def _value(self, key: str) -> Any:
        found: Any = self.data
        for step in key.split("."):
            if not isinstance(found, dict) or step not in found:
                raise InputError(self.file, key, None, "must be given (is the file whole?)")
            found = found[step]
        return found


@dataclass(frozen=True, slots=True)
class ReportTable:
    """A CSV file with a header.

    file : where it is from. header : names of the columns. rows : cells as they stand there.
    text : the whole file.
    """

    file: Path
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    text: str

    def column(self, name: str) -> list[str]:
        """Cells of a column.

        Raises
        ------
        InputError : there is none of that name.
        """
        if name not in self.header:
            raise InputError(self.file, name, None, "no column of that name")
        place = self.header.index(name)
        return [row[place] for row in self.rows]

    def numbers(self, *names: str) -> FloatArray:
        """(rows, names) numbers; NaN where a cell is empty.

        Raises
        ------
        InputError : no such column, or a cell that is no finite number.
        """
        columns = [
            [self._number(name, row, cell) for row, cell in enumerate(self.column(name), 2)]
            for name in names
        ]
        return np.array(columns, dtype=np.float64).reshape(len(names), -1).T

    def _number(self, name: str, line: int, cell: str) -> float:
        if cell == "":
            return math.nan
        try:
            value = float(cell)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise InputError(self.file, f"line {line}, {name}", cell, "must be a number")
        return value

    def where(self, name: str, value: str) -> ReportTable:
        """The rows that hold `value` in a column."""
        kept = [keep == value for keep in self.column(name)]
        rows = tuple(row for row, keep in zip(self.rows, kept, strict=True) if keep)
        return ReportTable(self.file, self.header, rows, self.text)


def read_record(path: Path) -> Record:
    """The object in a JSON file.

    Raises
    ------
    InputError : missing, cut off, or no object.
    """
    return Record(path, read_json(path))


def read_table(path: Path) -> ReportTable:
    """A CSV file.

    Raises
    ------
    InputError : missing, no text, empty, or a row that is longer or shorter than the header.
    """
    text = read_text(path)
    try:
        reader = csv.reader(io.StringIO(text), strict=True)
        rows = [tuple(cell_text(cell) for cell in row) for row in reader]
    except csv.Error as error:
        raise InputError(path, "", None, f"no table that can be read: {error}") from None
    if not rows or len(set(rows[0])) < len(rows[0]):
        raise InputError(path, "line 1", None, "must name every column once")
    for line, row in enumerate(rows[1:], 2):
        if len(row) != len(rows[0]):
            said = f"must hold {len(rows[0])} cells as the header does (is the file whole?)"
            raise InputError(path, f"line {line}", len(row), said)
    return ReportTable(path, rows[0], tuple(rows[1:]), text)
