"""The map as tables; times stand in `timing.csv` and nowhere else."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite

from beamopt.storage.writing import csv_text
from femcheck.stability.axis import Axis
from femcheck.stability.ending import MapEnding
from femcheck.stability.found import AxisFound, MapRow, share_of_cell
from femcheck.stability.validity import intervals_of
from femcheck.stability.work import FINER, TRACE, Key, Result

__all__ = ["tables_of", "timing_csv"]

CASES = (
    "axis,column,pressure_kPa,status,ended,reached_kPa,solid_x,solid_y,solid_z,beam_x,beam_y,beam_z,"
    "difference_share,largest_stretch,unstable,iterations,unknowns,reason"
)
LIMITS = (
    "axis,column,limit_kPa,status,ended,growth,snaps_kPa,triangles,layers,unknowns,finer_kPa,"
    "finer_status,finer_ended,finer_triangles,finer_layers,coarse_over_finer,exact_kPa,over_exact"
)
VALIDITY = "axis,column,within_5_percent,from_kPa,to_kPa,to_is"
TIMES = "axis,column,task,seconds"

NOTHING: tuple[object, ...] = (None, None, None)


def tables_of(found: Sequence[AxisFound]) -> dict[str, str]:
    """Tables by file name; the same results give the same bytes."""
    rows = [row for one in found for row in one.rows]
    return {
        "cases.csv": csv_text(CASES, (line for row in rows for line in _cases(row))),
        "limits.csv": csv_text(LIMITS, (line for row in rows for line in _limits(row))),
        "validity.csv": csv_text(VALIDITY, (line for row in rows for line in _validity(row))),
    }


def _cases(row: MapRow) -> list[tuple[object, ...]]:
    return [
        (
            *(row.axis.name, row.label, pressure, *_both(cell.ending), _short(cell.reached)),
            *(NOTHING if cell.tip is None else map(_short, cell.tip)),
            *(NOTHING if cell.beam is None else map(_short, cell.beam)),
            *(_short(share_of_cell(row, cell)), _short(cell.stretch), cell.unstable),
            *(cell.iterations, cell.unknowns, cell.reason),
        )
        for pressure, cell in row.solved
    ]


def _limits(row: MapRow) -> list[tuple[object, ...]]:
    """A line, where a path was followed."""
    trace, finer, exact = row.trace, row.finer, row.column.exact
    if trace is None:
        return []
    limit = trace.critical
    fine: tuple[object, ...] = (None,) * 6
    if finer is not None:
        size = finer.triangles, finer.layers
        fine = (_short(finer.critical), *_both(finer.ending), *size, _ratio(limit, finer.critical))
    line = (
        *(row.axis.name, row.label, _short(limit), *_both(trace.ending), _short(trace.growth)),
        *(" ".join(f"{one:.6g}" for one in trace.snaps), trace.triangles, trace.layers),
        *(trace.unknowns, *fine, _short(exact), _ratio(limit, exact)),
    )
    return [line]


def _validity(row: MapRow) -> list[tuple[object, ...]]:
    trace = row.trace
    if trace is None or not trace.track:
        return []
    intervals = intervals_of(trace.track)
    if not intervals:
        return [(row.axis.name, row.label, "nowhere", None, None, None)]
    return [
        (
            *(row.axis.name, row.label, "between", _short(one.low), _short(one.high)),
            "where it stops being valid" if one.ends else "the end of the path",
        )
        for one in intervals
    ]


def timing_csv(axes: Mapping[str, Axis], results: Mapping[Key, Result]) -> str:
    """Seconds of every task."""
    names = {TRACE: "path", FINER: "path on the finer mesh"}
    lines = []
    for (name, column, number), result in sorted(results.items()):
        axis = axes[name]
        label = " ".join(axis.columns[column].label.split())
        task = names.get(number) or f"{axis.pressures[number]:g} kPa"
        lines.append((name, label, task, float(f"{result.seconds:.3g}")))
    return csv_text(TIMES, lines)


def _both(ending: MapEnding) -> tuple[str, str]:
    """Cells of "status" and "ended": the text for people, the name for programs."""
    return ending.value, ending.name


def _ratio(value: float | None, by: float | None) -> float | None:
    return None if value is None or by is None else _short(value / by)


def _short(value: float | None) -> float | None:
    """Six digits: more differ from one processor to the next."""
    return None if value is None or not isfinite(value) else float(f"{value:.6g}")
