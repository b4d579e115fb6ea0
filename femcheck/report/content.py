"""Tables of results, read back column by column."""

from __future__ import annotations

import csv
import io
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.errors import InputError
from beamopt.storage.input_file import read_text
from beamopt.storage.writing import cell_text

__all__ = ["ReportTable", "read_table"]


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
