"""`beamopt tips`."""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from rich.table import Table

from beamopt.arrays import FloatArray
from beamopt.cli.progress import console
from beamopt.design import load_design
from beamopt.errors import InputError
from beamopt.target import tips_csv

__all__ = ["tips_command"]


def tips_command(path: Path, combinations: Sequence[str], as_csv: bool) -> None:
    """Print tips as a table for people or as CSV for programs."""
    design = load_design(path / "best.json" if path.is_dir() else path)
    pressures = _parsed(combinations) if combinations else design.workspace.pressures
    tips = design.tips(pressures)
    if as_csv:
        sys.stdout.write(tips_csv(pressures, tips))
        return
    table = Table(title=f"tips of {path.name}")
    for name in ("p1", "p2", "p3"):
        table.add_column(f"{name} \\[kPa]", justify="right")
    for name in ("x", "y", "z"):
        table.add_column(f"{name} \\[mm]", justify="right", style="bold")
    for row, tip in zip(pressures, tips, strict=True):
        table.add_row(*(f"{p:g}" for p in row), *(f"{value:.3f}" for value in tip + 0.0))
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
