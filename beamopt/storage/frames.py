"""Tables as pandas data frames; pandas is an extra."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from typing import TYPE_CHECKING

from beamopt.storage.writing import cell_text

if TYPE_CHECKING:
    from pandas import DataFrame

__all__ = ["frame_of"]


def frame_of(table: str) -> DataFrame:
    """Data frame of a table that `csv_text` made: the same columns, rows and digits.

    Raises
    ------
    ImportError : pandas is not installed.
    """
    try:
        from pandas import DataFrame
    except ImportError:
        said = "pandas is not installed: pip install 'beamopt[frames]'"
        raise ImportError(said, name="pandas") from None
    header, *rows = csv.reader(io.StringIO(table))
    columns = zip(*rows, strict=True) if rows else ([] for _ in header)
    return DataFrame(dict(zip(header, map(_column, columns), strict=True)))


def _column(cells: Sequence[str]) -> list[int] | list[float] | list[str | None]:
    """Numbers where all cells are, NaN for an empty one; else texts, None for an empty one."""
    try:
        return [int(cell) for cell in cells]
    except ValueError:
        pass
    try:
        return [float(cell or "nan") for cell in cells]
    except ValueError:
        return [cell_text(cell) if cell else None for cell in cells]
