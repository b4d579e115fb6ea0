"""What a benchmark measured, printed and kept."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from beamopt.files import csv_text, write_atomic
from beamopt.plot.style import save_figure
from beamopt.provenance import thread_settings

QUICK = bool(os.environ.get("BENCH_QUICK"))
"""Small sizes, to try a benchmark itself: its report is kept apart from the measured ones."""

ROOT = Path(__file__).resolve().parents[2]
PARTIAL = QUICK or bool(os.environ.get("BENCH_PARTS"))  # must not replace a whole report
REPORTS = ROOT / "runs" / "bench-quick" if PARTIAL else ROOT / "reports" / "bench"


@dataclass(frozen=True)
class Measured:
    what: str
    value: float
    unit: str


def report(name: str, measured: Iterable[Measured]) -> None:
    """Print a table with the thread settings and write reports/bench/NAME.csv."""
    rows = list(measured)
    threads = " ".join(f"{key}={value}" for key, value in thread_settings().items())
    table = Table(title=f"{name}\n{threads}", title_justify="left")
    table.add_column("what")
    table.add_column("value", justify="right")
    table.add_column("unit")
    for row in rows:
        table.add_row(row.what, f"{row.value:.4g}", row.unit)
    Console().print(table)
    REPORTS.mkdir(parents=True, exist_ok=True)
    cells = [(row.what, row.value, row.unit) for row in rows]
    write_atomic(REPORTS / f"{name}.csv", csv_text("what,value,unit", cells))


def save_growth(figure: Any, name: str) -> None:
    REPORTS.mkdir(parents=True, exist_ok=True)
    save_figure(figure, REPORTS / f"{name}.svg", REPORTS / f"{name}.png")
