"""The solid: assembly, direct solvers, growth, laws, whole checks. `sh run bench solid`.

- Assembly speed of our kernels beside FElupe and a plain scikit-fem form (`solid_assembly`).
- Forces, tangents and follower pressure of FElupe at an equilibrium of ours (`solid_felupe`).
- PARDISO against SuperLU on tangents of a loaded actuator (`solid_direct`).
- Growth of an iteration with layers and with triangles, in displacements alone and in the mixed
  form, and its chart (`solid_growth`).
- Every law: an iteration, a path from rest to where it ends beside its budget, and memory
  (`solid_laws`).
- Two whole checks, each beside its budget (`solid_runs`).

FElupe (GPL) is no dependency: it is measured where it is installed, `pip install '.[bench]'`, or
found on PYTHONPATH; the row "felupe installed" says so. Best kept out of the environment:
`pip install --target DIR --no-deps felupe tensortrax einsumt`, then PYTHONPATH=DIR.

BENCH_QUICK=1 takes small sizes, to try the benchmark itself; BENCH_PARTS names parts to measure, of
assembly, felupe, direct, growth, laws, drawn, voronoi. Either writes to runs/bench-quick/.
BENCH_DESIGN names a sealed design or run folder to check in place of the one that is searched.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

from tests.bench import felupe_bodies
from tests.bench.measured import QUICK, Measured
from tests.bench.solid_assembly import assembly
from tests.bench.solid_direct import direct_solvers
from tests.bench.solid_felupe import felupe_agreement
from tests.bench.solid_growth import growth
from tests.bench.solid_laws import laws
from tests.bench.solid_runs import three_chamber_check, voronoi_check

SIZES = (1.0, 0.5, 0.35)
"""Of the section's triangles, over the standard ones; coarser is not to be had, since all edges of
the outline are kept: 2.0 gives as many triangles as 1.0."""

WITH_FELUPE = {"assembly", "felupe"}

Part = Callable[[], Iterator[Measured]]


def measure() -> Iterator[Measured]:
    with tempfile.TemporaryDirectory() as folder:
        parts = _quick(Path(folder)) if QUICK else _full(Path(folder))
        names = os.environ.get("BENCH_PARTS", ",".join(parts)).split(",")
        unknown = [name for name in names if name not in parts]
        if unknown:
            raise ValueError(f"BENCH_PARTS: no part {unknown[0]!r}; one of: {', '.join(parts)}")
        if WITH_FELUPE.intersection(names):
            yield Measured("felupe installed", float(felupe_bodies.installed()), "")
        for name in names:
            yield from parts[name]()


def _full(folder: Path) -> dict[str, Part]:
    return {
        "assembly": partial(assembly, 20_000, repeats=9),
        "felupe": partial(felupe_agreement, 20_000),
        "direct": partial(direct_solvers, ((1, 4), (2, 6)), repeats=3),
        "growth": partial(growth, (2, 4, 8), SIZES, (4, 1.0), repeats=3),
        "laws": partial(laws, 4),
        "drawn": partial(three_chamber_check, folder, []),
        "voronoi": partial(voronoi_check, folder, _given(), []),
    }


def _quick(folder: Path) -> dict[str, Part]:
    few = ["--layers", "3", "--size", "2"]
    return {
        "assembly": partial(assembly, 3_000, repeats=2),
        "felupe": partial(felupe_agreement, 3_000),
        "direct": partial(direct_solvers, ((1, 2), (1, 4)), repeats=1),
        "growth": partial(growth, (2, 3), (1.0, 0.5), (2, 2.0), repeats=2),
        "laws": partial(laws, 2),
        "drawn": partial(three_chamber_check, folder, few),
        "voronoi": partial(voronoi_check, folder, _given(), few),
    }


def _given() -> Path | None:
    named = os.environ.get("BENCH_DESIGN")
    return Path(named) if named else None
