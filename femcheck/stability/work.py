"""All cells and paths of the map as independent tasks; see `beamopt.base.tasks`."""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import Executor, Future
from dataclasses import dataclass, field

from beamopt.base.tasks import Work
from femcheck.stability.axis import Axis
from femcheck.stability.ending import MapEnding
from femcheck.stability.solve import CellResult, TraceResult, solve_cell, trace_row

__all__ = ["FINER", "TRACE", "Key", "MapWork", "Result", "keys_of"]

Key = tuple[str, int, int]
"""Name of the axis, number of the column, and of the pressure; or `TRACE`, `FINER`."""
Result = CellResult | TraceResult

TRACE, FINER = -1, -2


def keys_of(axis: Axis) -> list[Key]:
    """A column's path, its cells, and its path on the finer mesh, column by column."""
    keys: list[Key] = []
    for number, column in enumerate(axis.columns):
        keys.append((axis.name, number, TRACE))
        keys += [(axis.name, number, place) for place in range(len(axis.pressures))]
        if column.compare:
            keys.append((axis.name, number, FINER))
    return keys


@dataclass
class MapWork(Work[Key, Result]):
    """What is to be solved, and what is known."""

    axes: Mapping[str, Axis]
    results: dict[Key, Result] = field(default_factory=dict)

    @property
    def keys(self) -> list[Key]:
        """Axis by axis."""
        return [key for axis in self.axes.values() for key in keys_of(axis)]

    def submit(self, executor: Executor, key: Key) -> Future[Result]:
        """Have a cell solved, or a path followed."""
        name, column, number = key
        axis = self.axes[name]
        specimen = axis.columns[column].specimen
        if number == TRACE:
            return executor.submit(trace_row, specimen, axis.pressures)
        if number == FINER:
            return executor.submit(trace_row, specimen.finer, axis.pressures[-1:])
        return executor.submit(solve_cell, specimen, axis.pressures[number])

    def stopped(self, key: Key) -> Result:
        """The result of a task whose process died."""
        if key[2] in (TRACE, FINER):
            return TraceResult(MapEnding.STOPPED, reason="its process died")
        return CellResult(MapEnding.STOPPED, reason="its process died")
