"""Whole checks through the command line, as a person waits for them, and what they are worth."""

from __future__ import annotations

import csv
import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from tests.bench.measured import Measured
from tests.bench.solid_cases import LENGTH, three_chambers

WORKERS = 2


def three_chamber_check(folder: Path, options: Sequence[str]) -> Iterator[Measured]:
    """The drawn chambers at 27 pressures."""
    design = three_chambers().save(folder / "three-chambers.json")
    yield from _check("drawn check", design, folder / "drawn", options, 120)


def voronoi_check(folder: Path, design: Path | None, options: Sequence[str]) -> Iterator[Measured]:
    """A sealed section of feature points, found now unless it is given."""
    if design is None:
        design = folder / "search"
        arguments = ["sealed-section", "--seed", "0", "--out", str(design)]
        took, _ = _command("beamopt", "optimize", *arguments)
        yield Measured("beamopt optimize sealed-section --seed 0", took, "s")
    yield from _check("Voronoi check", design, folder / "found", options, 360)


def _check(
    name: str, design: Path, out: Path, options: Sequence[str], budget: float
) -> Iterator[Measured]:
    """`femcheck run`: seconds, unknowns, iterations, errors as shares of the tip's displacement.

    Where the tip moves by less than a thousandth of the length, over a thousandth of the length.
    """
    took, code = _command(
        "femcheck", "run", str(design), "--workers", str(WORKERS), "--out", str(out), *options
    )
    yield Measured(f"{name}, {WORKERS} workers", took, "s")
    yield Measured(f"{name}, budget", budget, "s")
    yield Measured(f"{name}, exit code", code, "")
    summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    for solid in summary.get("solids", []):
        at = f"{name}, {solid['mesh']}, c = {solid['c']:g}"
        yield Measured(f"{at}: degrees of freedom", solid["unknowns"], "")
        yield Measured(f"{at}: triangles", solid["triangles"], "")
        yield Measured(f"{at}: layers", solid["layers"], "")
        yield Measured(f"{at}: converged", solid["converged"], "of 27")
        yield Measured(f"{at}: iterations a case", solid["iterations"] / 27, "")
    with (out / "table.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    yield from _shares(name, rows)


def _shares(name: str, rows: Sequence[dict[str, str]]) -> Iterator[Measured]:
    def column(key: str) -> np.ndarray:
        return np.array([float(row[key] or "nan") for row in rows])

    beam = np.column_stack([column(f"beam_{axis}") for axis in "xyz"])
    moved = np.linalg.norm(beam - [0, 0, LENGTH], axis=1)
    is_loaded = np.any([column(f"p{supply}") > 0 for supply in (1, 2, 3)], axis=0)
    for key, said in (
        ("discretisation_mm", "discretisation error"),
        ("penalty_mm", "penalty, extrapolated away"),
        ("difference_mm", "difference of beam and solid"),
    ):
        shares = (column(key) / np.maximum(moved, 1e-3 * LENGTH))[is_loaded]
        for what, of in (("worst", np.nanmax), ("median", np.nanmedian)):
            yield Measured(f"{name}, {said}, {what}", 100 * of(shares), "% of displacement")


def _command(program: str, *arguments: str) -> tuple[float, int]:
    """Seconds and exit code; 1 is a check that does not agree, which is an answer too."""
    code = f"import sys; from {program}.cli import main; sys.exit(main())"
    began = time.monotonic()
    done = subprocess.run(
        [sys.executable, "-c", code, *arguments], capture_output=True, text=True, env=os.environ
    )
    took = time.monotonic() - began
    if done.returncode not in (0, 1):
        raise RuntimeError(f"{program} {' '.join(arguments)}: {done.stderr[-500:]}")
    return took, done.returncode
