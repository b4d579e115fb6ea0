"""`beamopt reach`."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import typer
from rich.table import Table

from beamopt.base.errors import InputError
from beamopt.cli.exit_codes import ExitCode
from beamopt.cli.findings import say_findings
from beamopt.cli.progress import console
from beamopt.judge.answer_tables import paths_csv
from beamopt.reach.reach import Reach, ReachStatus, reach
from beamopt.scene.named import named_design
from beamopt.target.trajectory import read_path

__all__ = ["reach_command"]


def reach_command(source: str, path: Path, as_csv: bool, tolerance: float, step: float) -> None:
    """Print the pressures that bring a design's tip along a trajectory."""
    for name, value in (("--tolerance", tolerance), ("--step", step)):
        if not 0 < value < math.inf:
            raise InputError(name, "", value, "a finite number of mm above 0")
    _, design = named_design(source)
    points = read_path(path, design.actuator.length, step)
    low, _, high = design.pressures
    found = reach(design.climb.model, design.values, points, low, high)
    statuses = found.statuses(tolerance)
    if as_csv:
        sys.stdout.write(paths_csv(found, [len(points)]))
    else:
        _print_table(path, found, statuses)
    say_findings(design)
    outside = sum(status is not ReachStatus.REACHED for status in statuses)
    if outside:
        said = f"{outside} of {len(points)} points are not reached within {tolerance:g} mm"
        typer.echo(f"beamopt: {said} at {low:g} … {high:g} kPa", err=True)
        raise typer.Exit(ExitCode.DOES_NOT_HOLD)


def _print_table(path: Path, found: Reach, statuses: tuple[ReachStatus, ...]) -> None:
    table = Table(title=f"pressures for {path.name}")
    for name in ("x", "y", "z"):
        table.add_column(f"{name} \\[mm]", justify="right")
    for name in ("p1", "p2", "p3"):
        table.add_column(f"{name} \\[kPa]", justify="right", style="bold")
    table.add_column("status")
    rows = zip(found.points, found.pressures, found.distances.tolist(), statuses, strict=True)
    for point, pressures, distance, status in rows:
        away = f" by {distance:.3g} mm" if status is ReachStatus.OUTSIDE else ""
        numbers = [*(f"{value:.3f}" for value in point + 0.0)]
        there = status is not ReachStatus.NO_TIP
        numbers += [f"{value:.3f}" if there else "–" for value in pressures]
        table.add_row(*numbers, f"{status.value}{away}")
    console.print(table)
