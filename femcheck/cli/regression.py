"""`femcheck baseline` and `femcheck regress`."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from time import perf_counter

import typer
from rich.markup import escape
from rich.table import Table

from beamopt.cli.exit_codes import ExitCode, end_with
from beamopt.cli.findings import say_findings
from beamopt.cli.progress import console, counted, say_workers
from beamopt.storage.writing import check_replaceable, csv_text, write_atomic
from femcheck.cli.verdicts import code_of
from femcheck.continuation.ended import Ended
from femcheck.regression.held_design import HeldDesign
from femcheck.regression.moved import Moved, said
from femcheck.regression.regression import ContradictionError, Regression, hold_designs, regress

__all__ = ["baseline_command", "regress_command"]

HEADER = "design,rung,resolution,law,quantity,row,held,now,moved,tolerance,unit"
MOST_ROWS = 30  # of the table on the terminal
WIDE = 160  # characters of the table where there is no terminal
LINES = 10  # of progress, where there is no terminal to draw a bar on


def baseline_command(
    designs: list[str], out: Path, meshes: Path, workers: int, *, force: bool
) -> None:
    """Write baselines, and end with 1 if rungs contradict each other."""
    started = perf_counter()
    say_workers(workers)
    try:
        with _parts() as tell:
            files = hold_designs(
                designs,
                out,
                meshes,
                force=force,
                workers=workers,
                callback=tell,
                named=_findings_of(designs),
            )
    except ContradictionError as error:
        console.print(f"nothing is written: {error}", soft_wrap=True, markup=False)
        raise typer.Exit(ExitCode.DOES_NOT_HOLD) from None
    seconds = perf_counter() - started
    many = "s" if len(files) > 1 else ""
    console.print(f"{len(files)} baseline{many} in {out}/, {seconds:.0f} s", markup=False)


def regress_command(
    designs: list[str],
    baseline: Path,
    meshes: Path,
    workers: int,
    out: Path | None,
    *,
    force: bool = False,
) -> None:
    """Compute what is held anew; end with 1 and a table if anything moved."""
    if out is not None:
        check_replaceable(out, HEADER, "femcheck regress", force=force)
    started = perf_counter()
    say_workers(workers)
    with _parts() as tell:
        found = regress(
            designs,
            baseline,
            meshes,
            workers=workers,
            callback=tell,
            named=_findings_of(designs),
        )
    if out is not None:
        write_atomic(out, csv_text(HEADER, map(_cells, found.moved + found.late)))
    seconds = perf_counter() - started
    about = f"{found.rungs} rungs of {len(found.designs)} designs, {found.rows} rows"
    if found.holds:
        console.print(f"{about}: nothing moved, {seconds:.0f} s", soft_wrap=True, markup=False)
        return
    if found.moved:
        _report(found)
    console.print(f"{about}: {len(found.moved)} moved, {seconds:.0f} s", markup=False)
    if found.late:
        _say_late(found.late)
    if found.moved:
        console.print(f"lowest rung that moved: {found.lowest}", soft_wrap=True, markup=False)
    end_with(code_of(found))


def _findings_of(designs: Sequence[str]) -> Callable[[HeldDesign], None]:
    """Say what is wrong with a design, with its name where there are several."""
    several = len(designs) > 1
    return lambda one: say_findings(one.design, one.name if several else "")


def _say_late(late: Sequence[Moved]) -> None:
    """What was interrupted, a line each: it is no move, and nothing is known of it."""
    statuses = {one.now.status: None for one in late if isinstance(one.now, Ended)}
    why = ", ".join(status.value for status in statuses)
    shown = f"{len(late)} not compared, {why} (another load on this machine?):"
    console.print(shown, soft_wrap=True, markup=False)
    for one in late[:MOST_ROWS]:
        held = one.held
        place = f"  {held.rung} of {one.design}: {held.quantity} at {one.row}"
        console.print(place, soft_wrap=True, markup=False)


def _report(found: Regression) -> None:
    table = Table(title="moved", title_justify="left")
    for name in ("design", "rung", "resolution", "at", "held", "now", "moved", "tolerance"):
        table.add_column(name, overflow="fold")
    for one in found.moved[:MOST_ROWS]:
        held = one.held
        table.add_row(
            escape(one.design),
            escape(held.rung),
            escape(held.resolution),
            escape(f"{held.quantity}, {one.row}"),
            escape(said(one.before)),
            escape(said(one.now)),
            f"{one.distance:.3g} {held.unit}",
            f"{held.tolerance:.2g}",
        )
    # a file has lines of any length; numbers broken in two can not be read
    console.print(table, width=None if console.is_terminal else WIDE, soft_wrap=True)
    left = len(found.moved) - MOST_ROWS
    if left > 0:
        console.print(f"… and {left} more: --out FILE.csv has all of them", markup=False)


def _cells(one: Moved) -> tuple[object, ...]:
    held = one.held
    place = (one.design, held.rung, held.resolution, held.law, held.quantity, one.row)
    moved = (said(one.before), said(one.now), one.distance, held.tolerance, held.unit)
    return (*place, *moved)


@contextmanager
def _parts() -> Iterator[Callable[[str, str, int], None]]:
    """A function to call with each part that is done: design, part, number of all parts."""
    done = 0
    with counted("parts", "rungs", lines=LINES) as show:

        def tell(design: str, part: str, total: int) -> None:
            nonlocal done
            done += 1
            show(done, total, f"{design}: {part}")

        yield tell
