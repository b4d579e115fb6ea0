"""PARDISO against SuperLU on the tangent of a loaded actuator: seconds and peak memory.

Each solver works in a process of its own, so that its peak memory is its own:
`python -m tests.bench.solid_direct SOLVER FILE` reads a matrix and prints what it took.
"""

from __future__ import annotations

import json
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from femcheck.assembly.reduction import UpperMatrix
from femcheck.continuation.direct import direct_solver
from femcheck.solid.equilibrium import Equilibrium
from tests.bench.measured import Measured, in_own_process, peak_memory
from tests.bench.solid_cases import LOAD, loaded, problem_of
from tests.femcheck.ring_section import ring_section

MODULE = "tests.bench.solid_direct"
SOLVERS = ("pardiso", "superlu")
TIMES = ("analysis and factor", "factor again", "solve")


def direct_solvers(cases: tuple[tuple[int, int], ...], repeats: int) -> Iterator[Measured]:
    """Both solvers on every case: parts of the section's cells and layers."""
    for parts, layers in cases:
        problem = problem_of(ring_section(parts), layers)
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "tangent.npz"
            _save(file, problem)
            rounds: dict[str, list[dict[str, float]]] = {solver: [] for solver in SOLVERS}
            for _ in range(repeats):  # in turn
                for solver in SOLVERS:
                    rounds[solver].append(in_own_process(MODULE, solver, str(file)))
        size = problem.body.unknowns
        best = {
            solver: {key: min(one[key] for one in each) for key in each[0]}
            for solver, each in rounds.items()
        }
        yield from _rows(f"direct, {size} unknowns", best)


def _rows(name: str, best: dict[str, dict[str, float]]) -> Iterator[Measured]:
    for solver, took in best.items():
        for key in TIMES:
            yield Measured(f"{name}: {solver}, {key}", took[key], "s")
        yield Measured(f"{name}: {solver}, memory beside the matrix", took["memory"], "MB")
        yield Measured(f"{name}: {solver}, peak of the process", took["peak"], "MB")
        yield Measured(f"{name}: {solver}, residual over right-hand side", took["residual"], "")
    for key in TIMES:
        ratio = best["superlu"][key] / best["pardiso"][key]
        yield Measured(f"{name}: pardiso against superlu, {key}", ratio, "times faster")
    ratio = best["superlu"]["memory"] / best["pardiso"]["memory"]
    yield Measured(f"{name}: superlu over pardiso, memory", ratio, "times")


def _save(file: Path, problem: Equilibrium) -> None:
    state, _ = loaded(problem)
    more = 1.1 * LOAD  # the first iteration of the next load
    forces = problem.forces(state, more)
    tangent = problem.tangent(state, more, forces)
    np.savez(
        file,
        starts=tangent.starts,
        indices=tangent.indices,
        data=tangent.data,
        right=-forces.reduced,
    )


def _measure(name: str, file: Path) -> dict[str, float]:
    with np.load(file) as kept:
        matrix = UpperMatrix(kept["starts"], kept["indices"], kept["data"])
        right = kept["right"]
    small = UpperMatrix(np.array([0, 1]), np.array([0]), np.array([1.0]))
    solver = direct_solver(name)
    solver.factor(small)  # loads the library
    solver = direct_solver(name)
    before = peak_memory() / 1e6
    times = {}
    for key in TIMES[:2]:
        began = time.perf_counter()
        solver.factor(matrix)
        times[key] = time.perf_counter() - began
    began = time.perf_counter()
    solution = solver.solve(right)
    times["solve"] = time.perf_counter() - began
    peak = peak_memory() / 1e6
    residual = np.abs(matrix.whole() @ solution - right).max() / np.abs(right).max()
    return times | {"memory": peak - before, "peak": peak, "residual": float(residual)}


if __name__ == "__main__":
    print(json.dumps(_measure(sys.argv[1], Path(sys.argv[2]))))
