"""What was found, by axis and column; and where cells and lines say different things."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from femcheck.stability.axis import Axis, Column
from femcheck.stability.ending import MapEnding
from femcheck.stability.solve import CellResult, TraceResult, apart_of
from femcheck.stability.validity import LOAD
from femcheck.stability.work import FINER, TRACE, Key, Result

__all__ = ["AxisFound", "MapRow", "RowAgreement", "agreement_of", "found_of", "share_of_cell"]

NEAR = 0.01  # of the limit: a cell so near to the line may end on either side of it


@dataclass(frozen=True, slots=True)
class MapRow:
    """One specimen at all pressures of its axis; None where it is not solved yet.

    trace : its path. finer : that on the finer mesh. cells : by pressure.
    """

    axis: Axis
    column: Column
    trace: TraceResult | None
    finer: TraceResult | None
    cells: tuple[CellResult | None, ...]

    @property
    def label(self) -> str:
        """Of its column, on one line."""
        return " ".join(self.column.label.split())

    @property
    def solved(self) -> Iterator[tuple[float, CellResult]]:
        """Pressure [kPa] and result of each cell that is solved."""
        for pressure, cell in zip(self.axis.pressures, self.cells, strict=True):
            if cell is not None:
                yield pressure, cell


@dataclass(frozen=True, slots=True)
class AxisFound:
    """A panel with what was found."""

    axis: Axis
    rows: tuple[MapRow, ...]


@dataclass(frozen=True, slots=True)
class RowAgreement:
    """Cells, each solved from rest by itself, against the limit of its row's path.

    agree : cells that say what the line says. near : within a hundredth of the line, not judged.
    against : sentences about those that say the opposite. neither : about those that say nothing.
    tips : largest distance between the tips of cell and path, over the displacement.
    """

    agree: int
    near: int
    against: tuple[str, ...]
    neither: tuple[str, ...]
    tips: float


def found_of(axes: Mapping[str, Axis], results: Mapping[Key, Result]) -> list[AxisFound]:
    """What is known of each axis; axes of which nothing is known are left out."""
    found = []
    for name, axis in axes.items():
        if any(key[0] == name for key in results):
            rows = tuple(_row(axis, number, results) for number in range(len(axis.columns)))
            found.append(AxisFound(axis, rows))
    return found


def _row(axis: Axis, number: int, results: Mapping[Key, Result]) -> MapRow:
    def path(kind: int) -> TraceResult | None:
        result = results.get((axis.name, number, kind))
        return result if isinstance(result, TraceResult) else None

    def cell(place: int) -> CellResult | None:
        result = results.get((axis.name, number, place))
        return result if isinstance(result, CellResult) else None

    cells = tuple(cell(place) for place in range(len(axis.pressures)))
    return MapRow(axis, axis.columns[number], path(TRACE), path(FINER), cells)


def share_of_cell(row: MapRow, cell: CellResult) -> float | None:
    """Difference to the beam over the beam's displacement; None without an equilibrium."""
    if cell.tip is None or cell.beam is None:
        return None
    length = row.column.specimen.length
    apart = apart_of(np.array([cell.tip]), np.array([cell.beam]), length)[0]
    return float(np.linalg.norm(apart)) if np.isfinite(apart).all() else None


def agreement_of(rows: Iterable[MapRow]) -> RowAgreement:
    """Compare every cell with the line of its row."""
    agree = near = 0
    against: list[str] = []
    neither: list[str] = []
    apart = 0.0
    for row in rows:
        if row.trace is None:
            continue
        for pressure, cell in row.solved:
            said = f"{row.axis.name} {row.label}, {pressure:g} kPa: {cell.ending.value}"
            expected = _expected(row.trace, pressure)
            if expected is None:
                near += 1
            elif _says(cell.ending, row.trace.ending) is None:
                neither.append(f"{said}, the path {_told(row.trace)}")
            elif _says(cell.ending, row.trace.ending) is expected:
                agree += 1
            else:
                against.append(f"{said}, the path {_told(row.trace)}")
            apart = max(apart, _tips_apart(row, row.trace, pressure, cell))
    return RowAgreement(agree, near, tuple(against), tuple(neither), apart)


def _expected(trace: TraceResult, pressure: float) -> bool | None:
    """Whether the path says that there is an equilibrium; None where it does not say."""
    if trace.ending in (MapEnding.NO_MESH, MapEnding.NO_PAIR):
        return False
    if trace.critical is None:
        return True if trace.ending.has_equilibrium else None
    if abs(pressure - trace.critical) <= NEAR * trace.critical:
        return None
    if pressure < trace.critical:
        return True
    return False if trace.ending.says_none else None


def _says(ending: MapEnding, of_path: MapEnding) -> bool | None:
    """Whether a cell says that there is an equilibrium; None where it says nothing."""
    if ending.has_equilibrium:
        return True
    absent = ending in (MapEnding.NO_MESH, MapEnding.NO_PAIR) and ending is of_path
    return False if ending.says_none or absent else None


def _told(trace: TraceResult) -> str:
    if trace.critical is None:
        return f"says: {trace.ending.value}"
    return f"ends at {trace.critical:.4g} kPa ({trace.ending.value})"


def _tips_apart(row: MapRow, trace: TraceResult, pressure: float, cell: CellResult) -> float:
    """Distance between the tips of cell and path at one pressure, over the displacement."""
    on_path = _at(trace.track, pressure)
    if cell.tip is None or on_path is None or not cell.ending.has_equilibrium:
        return 0.0
    moved = np.linalg.norm(np.array(cell.tip) - [0.0, 0.0, row.column.specimen.length])
    return float(np.linalg.norm(np.array(cell.tip) - on_path) / moved)


def _at(track: Sequence[Sequence[float]], pressure: float) -> Sequence[float] | None:
    """The tip at a pressure that the path stopped at, before its end."""
    for point in track:
        if abs(point[LOAD] - pressure) <= 1e-9 * pressure:
            return point[1:4]
    return None
