"""`python -m tests.validation [NAME …]`: run suites in full, write reports/validation/NAME.csv.

A check that is done is kept under reports/validation/.partial until its suite is complete, so that
a run that was stopped goes on where it was; a change of the code starts anew.
"""

from __future__ import annotations

import hashlib
import json
import sys
from pathlib import Path

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from beamopt.base.provenance import thread_settings
from beamopt.storage.writing import csv_text, write_atomic
from tests.validation.suites import SUITES

ROOT = Path(__file__).resolve().parents[2]
REPORTS = ROOT / "reports" / "validation"
HEADER = "check,source,expected,measured,tolerance,verdict"

console = Console(highlight=False)


def code_digest() -> str:
    """A digest of all code that a suite's result may depend on."""
    state = hashlib.blake2b(digest_size=8)
    for folder in ("beamopt", "femcheck", "tests/validation"):
        for path in sorted((ROOT / folder).rglob("*.py")):
            state.update(path.read_bytes())
    return state.hexdigest()


def run_suite(name: str) -> bool:
    """Run one suite; whether every check holds."""
    partial = REPORTS / ".partial" / f"{name}.json"
    partial.parent.mkdir(parents=True, exist_ok=True)
    digest = code_digest()
    done: dict[str, list[list[object]]] = {}
    if partial.exists():
        kept = json.loads(partial.read_text())
        done = kept["done"] if kept["code"] == digest else {}
    checks = SUITES[name](True)
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=Console(stderr=True)) as bar:
        task = bar.add_task(name, total=len(checks))
        for check in checks:
            bar.update(task, description=f"{name}: {check.name}")
            if check.name not in done:
                done[check.name] = [list(row.cells) for row in check.rows()]
                write_atomic(partial, json.dumps({"code": digest, "done": done}))
            bar.advance(task)
    rows = [row for check in checks for row in done[check.name]]
    write_atomic(REPORTS / f"{name}.csv", csv_text(HEADER, rows))
    partial.unlink()
    failing = [row for row in rows if row[-1] != "holds"]
    console.print(f"{name}: {len(rows) - len(failing)} of {len(rows)} hold")
    for row in failing:
        console.print(f"  FAILS: {row[0]}: expected {row[2]}, measured {row[3]}", markup=False)
    return not failing


def main() -> int:
    names = sys.argv[1:] or list(SUITES)
    unknown = [name for name in names if name not in SUITES]
    if unknown:
        print(f"validate: no suite {unknown[0]!r}; one of: {', '.join(SUITES)}", file=sys.stderr)
        return 2
    console.print("threads: " + " ".join(f"{k}={v}" for k, v in thread_settings().items()))
    holding = [run_suite(name) for name in names]  # all of them, whatever the first ones say
    return 0 if all(holding) else 1


if __name__ == "__main__":
    sys.exit(main())
