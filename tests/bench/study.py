"""Time of the whole study and of single commands, as a person waits for them."""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from tests.bench.measured import Measured


def seconds(*arguments: str) -> float:
    started = time.monotonic()
    command = [sys.executable, "-c", "from beamopt.cli import main; main()", *arguments]
    subprocess.run(command, check=True, capture_output=True, env=os.environ)
    return time.monotonic() - started


def measure() -> Iterator[Measured]:
    with tempfile.TemporaryDirectory() as root:
        design = Path(root) / "run" / "best.json"
        scene = "hand-drawn-section"
        seconds("optimize", scene, "--out", str(design.parent))  # compiles, once a machine
        for name, arguments in (
            ("beamopt --help", ["--help"]),
            ("beamopt scenes", ["scenes"]),
            ("beamopt tips DESIGN", ["tips", str(design)]),
        ):
            yield Measured(name, statistics.median(seconds(*arguments) for _ in range(5)), "s")
        whole = seconds("optimize", scene, "--out", str(Path(root) / "again"))
        yield Measured("beamopt optimize, figures included", whole, "s")
        for workers in (1, 2):
            out = str(Path(root) / f"study-{workers}")
            took = seconds("study", "--no-refine", "--workers", str(workers), "--out", out)
            yield Measured(f"beamopt study, 48 runs, {workers} workers", took, "s")
