"""`beamopt tips`."""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import typer
from rich.markup import escape
from rich.table import Table

from beamopt.base.arrays import FloatArray
from beamopt.base.errors import InputError, NoEquilibriumError
from beamopt.cli.exit_codes import ExitCode, end_with, joined
from beamopt.cli.findings import say_findings
from beamopt.cli.progress import console
from beamopt.rod.ladder import Tips
from beamopt.rod.status import RodStatus
from beamopt.scene.named import named_design
from beamopt.target.workspace import pressure_grid, tips_csv

__all__ = ["tips_command"]


def tips_command(source: str, combinations: Sequence[str], as_csv: bool) -> None:
    """Print tips as a table for people or as CSV for programs."""
    _, design = named_design(source)
    pressures = _parsed(combinations) if combinations else pressure_grid(design.pressures)
    found = design.solve(pressures)
    has_tip = np.array([status is RodStatus.CONVERGED for status in found.status])
    if as_csv:
        sys.stdout.write(tips_csv(pressures[has_tip], found.positions[has_tip]))
    else:
        _print_table(Path(source).name, pressures, found)
    say_findings(design)
    for at, status in zip(pressures, found.status, strict=True):
        if status is not RodStatus.CONVERGED:
            typer.echo(f"beamopt: {NoEquilibriumError(at, status)}", err=True)
    lost = [status for status in found.status if status is not RodStatus.CONVERGED]
    end_with(
        joined(
            ExitCode.DOES_NOT_HOLD if status.is_settled else ExitCode.NOT_COMPUTED
            for status in lost
        )
    )


def _print_table(name: str, pressures: FloatArray, found: Tips) -> None:
    table = Table(title=f"tips of {escape(name)}")
    for column in ("p1", "p2", "p3"):
        table.add_column(f"{column} \\[kPa]", justify="right")
    for column in ("x", "y", "z"):
        table.add_column(f"{column} \\[mm]", justify="right", style="bold")
    for row, tip, status in zip(pressures, found.positions, found.status, strict=True):
        there = status is RodStatus.CONVERGED
        cells = (f"{value:.3f}" if there else "–" for value in tip + 0.0)
        table.add_row(*(f"{p:g}" for p in row), *cells)
    console.print(table)


def _parsed(combinations: Sequence[str]) -> FloatArray:
    rows = []
    for text in combinations:
        try:
            row = [float(part) for part in text.split(",")]
        except ValueError:
            row = []
        if len(row) != 3 or not all(math.isfinite(value) and 0 <= value <= 2000 for value in row):
            raise InputError("--pressures", "", text, "three numbers 0 … 2000 kPa, as 0,50,100")
        rows.append(row)
    return np.array(rows)
