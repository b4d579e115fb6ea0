"""What a benchmark measured, printed and kept."""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from beamopt.base.provenance import provenance, thread_settings
from beamopt.plot.style import save_figure
from beamopt.storage.writing import csv_text, json_text, write_atomic
from femcheck.solved.folder import PACKAGES

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
    write_atomic(REPORTS / f"{name}-provenance.json", json_text(provenance(PACKAGES)))


def save_growth(figure: Any, name: str) -> None:
    REPORTS.mkdir(parents=True, exist_ok=True)
    save_figure(figure, REPORTS / f"{name}.svg", REPORTS / f"{name}.png")


def in_own_process(module: str, *arguments: str) -> dict[str, Any]:
    """What `python -m module arguments` prints as its last line, an object in JSON."""
    command = [sys.executable, "-m", module, *arguments]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(command[1:])}: {done.stderr[-500:]}")
    result: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return result


def peak_memory() -> int:
    """Largest memory of this process until now, its ru_maxrss [bytes].

    Linux counts into ru_maxrss what the process was forked from; its own /proc entry does not.
    """
    status = Path("/proc/self/status")
    if status.exists():
        line = next(row for row in status.read_text().splitlines() if row.startswith("VmHWM"))
        return int(line.split()[1]) * 1024
    unit = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit
