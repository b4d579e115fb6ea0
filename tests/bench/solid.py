"""The solid: assembly, direct solvers, growth, whole checks. `sh run bench solid`.

- Assembly speed of our kernels beside FElupe and a plain scikit-fem form (`solid_assembly`).
- PARDISO against SuperLU on tangents of a loaded actuator (`solid_direct`).
- Growth of an iteration with layers and with triangles, and its chart (`solid_growth`).
- Two whole checks, each beside its budget (`solid_runs`).

FElupe (GPL) is no dependency: it is measured where it is installed, `pip install '.[bench]'`, or
found on PYTHONPATH; the row "felupe installed" says so. Best kept out of the environment:
`pip install --target DIR --no-deps felupe tensortrax einsumt`, then PYTHONPATH=DIR.

BENCH_QUICK=1 takes small sizes, to try the benchmark itself; BENCH_PARTS names parts to measure, of
assembly, direct, growth, drawn, voronoi. Either writes to runs/bench-quick/.
BENCH_DESIGN names a sealed design or run folder to check in place of the one that is searched.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

from tests.bench.measured import QUICK, Measured
from tests.bench.solid_assembly import assembly
from tests.bench.solid_direct import direct_solvers
from tests.bench.solid_growth import growth
from tests.bench.solid_runs import three_chamber_check, voronoi_check

SIZES = (1.0, 0.7, 0.5, 0.35, 0.25)
"""Of the section's triangles, over the standard ones; coarser is not to be had, since all edges of
the outline are kept: 2.0 gives as many triangles as 1.0."""

Part = Callable[[], Iterator[Measured]]


def measure() -> Iterator[Measured]:
    with tempfile.TemporaryDirectory() as folder:
        parts = _quick(Path(folder)) if QUICK else _full(Path(folder))
        for name in os.environ.get("BENCH_PARTS", ",".join(parts)).split(","):
            yield from parts[name]()


def _full(folder: Path) -> dict[str, Part]:
    return {
        "assembly": partial(assembly, 20_000, repeats=9),
        "direct": partial(direct_solvers, ((1, 4), (2, 6)), repeats=3),
        "growth": partial(growth, (2, 4, 8, 16), SIZES, (4, 1.0), repeats=5),
        "drawn": partial(three_chamber_check, folder, []),
        "voronoi": partial(voronoi_check, folder, _given(), []),
    }


def _quick(folder: Path) -> dict[str, Part]:
    few = ["--layers", "3", "--size", "2"]
    return {
        "assembly": partial(assembly, 3_000, repeats=2),
        "direct": partial(direct_solvers, ((1, 2), (1, 4)), repeats=1),
        "growth": partial(growth, (2, 3), (1.0, 0.5), (2, 2.0), repeats=2),
        "drawn": partial(three_chamber_check, folder, few),
        "voronoi": partial(voronoi_check, folder, _given(), few),
    }


def _given() -> Path | None:
    named = os.environ.get("BENCH_DESIGN")
    return Path(named) if named else None
