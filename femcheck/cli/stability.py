"""`femcheck stability`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

from rich.markup import escape
from rich.table import Table

from beamopt.base.errors import InputError
from beamopt.base.provenance import thread_settings
from beamopt.cli.exit_codes import end_with
from beamopt.cli.progress import console, progress_bar
from femcheck.cli.verdicts import code_of
from femcheck.stability.axes import AXES
from femcheck.stability.found import AxisFound, agreement_of
from femcheck.stability.stability_map import redraw_map, run_map
from femcheck.stability.work import Key, Result

__all__ = ["StabilityRequest", "stability_command"]

LINES = 40  # of progress, where there is no terminal to draw a bar on


@dataclass(frozen=True, slots=True)
class StabilityRequest:
    """The options as they were given."""

    out: Path
    axes: list[str]
    workers: int
    resume: bool
    redraw: bool


def stability_command(request: StabilityRequest) -> None:
    """Make the map or draw it again, show progress, and print how cells and lines agree."""
    _check(request)
    found = redraw_map(request.out, AXES) if request.redraw else _computed(request)
    _report(found)
    files = f"files: {request.out}/ (reading.md, stability.png, …)"
    console.print(files, soft_wrap=True, markup=False)
    end_with(code_of(found))


def _check(request: StabilityRequest) -> None:
    for name in request.axes:
        if name not in AXES:
            raise InputError("--axis", "", name, f"one of {', '.join(AXES)}")
        if request.redraw:
            raise InputError("--axis", "", name, "--redraw draws all that is there")


def _computed(request: StabilityRequest) -> list[AxisFound]:
    """Solve with a bar; without a terminal a line now and then, with the time that is left."""
    threads = " ".join(f"{key}={value}" for key, value in thread_settings().items())
    console.print(f"{request.workers} at once, {threads}", soft_wrap=True)
    started, first = perf_counter(), 0
    with progress_bar("tasks") as bar:
        task = bar.add_task("map", total=None, said="starting")

        def show(key: Key, result: Result, done: int, total: int) -> None:
            nonlocal first
            first = first or done - 1
            name, column, _ = key
            label = " ".join(AXES[name].columns[column].label.split())
            said = f"{name} {label}: {result.ending.value}"
            bar.update(task, completed=done, total=total, said=escape(said))
            if bar.disable and done * LINES // total > (done - 1) * LINES // total:
                left = (perf_counter() - started) / (done - first) * (total - done)
                console.print(f"{done} of {total} tasks, {left / 60:.1f} min left")

        try:
            return run_map(
                request.out,
                AXES,
                wanted=request.axes or None,
                workers=request.workers,
                resume=request.resume,
                progress=show,
            )
        except KeyboardInterrupt:
            said = f"{request.out}: the same with --resume goes on where it was"
            console.print(said, soft_wrap=True, markup=False)
            raise


def _report(found: Sequence[AxisFound]) -> None:
    rows = [row for one in found for row in one.rows]
    table = Table(title="How the cases end")
    table.add_column("panel")
    endings = Counter(cell.ending for row in rows for _, cell in row.solved)
    for ending in endings:
        table.add_column(ending.value, justify="right")
    for one in found:
        counts = Counter(cell.ending for row in one.rows for _, cell in row.solved)
        table.add_row(one.axis.name, *(str(counts[ending]) for ending in endings))
    console.print(table)
    said = agreement_of(rows)
    text = f"{said.agree} cells say what the line says, {len(said.against)} the opposite"
    console.print(f"{text}, {len(said.neither)} neither, {said.near} are not judged")
