"""`femcheck stability`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from rich.table import Table

from beamopt.base.errors import InputError
from beamopt.cli.exit_codes import end_with
from beamopt.cli.progress import console, counted, say_workers
from femcheck.cli.verdicts import code_of
from femcheck.stability.axes import AXES
from femcheck.stability.found import AxisFound, agreement_of
from femcheck.stability.stability_map import redraw_map, run_map
from femcheck.stability.work import Key, Result

__all__ = ["stability_command"]

LINES = 40  # of progress, where there is no terminal to draw a bar on


def stability_command(
    out: Path, axes: Sequence[str], workers: int, *, resume: bool, redraw: bool
) -> None:
    """Make the map or draw it again, show progress, and print how cells and lines agree."""
    _check(axes, redraw)
    found = redraw_map(out, AXES) if redraw else _computed(out, axes, workers, resume)
    _report(found)
    files = f"files: {out}/ (reading.md, stability.png, …)"
    console.print(files, soft_wrap=True, markup=False)
    end_with(code_of(found))


def _check(axes: Sequence[str], redraw: bool) -> None:
    for name in axes:
        if name not in AXES:
            raise InputError("--axis", "", name, f"one of {', '.join(AXES)}")
        if redraw:
            raise InputError("--axis", "", name, "--redraw draws all that is there")


def _computed(out: Path, axes: Sequence[str], workers: int, resume: bool) -> list[AxisFound]:
    """Solve with a bar; without a terminal a line now and then, with the time that is left."""
    say_workers(workers)
    with counted("tasks", "map", lines=LINES) as tell:

        def show(key: Key, result: Result, done: int, total: int) -> None:
            name, column, _ = key
            label = " ".join(AXES[name].columns[column].label.split())
            tell(done, total, f"{name} {label}: {result.ending.value}")

        try:
            return run_map(
                out,
                AXES,
                wanted=axes or None,
                workers=workers,
                resume=resume,
                progress=show,
            )
        except KeyboardInterrupt:
            said = f"{out}: the same with --resume goes on where it was"
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
