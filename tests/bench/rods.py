"""Rods under loads: against scipy and PyElastica, in a search, and how they grow.

`python -m tests.bench rods`.

- 27 tips of two loaded scenes to 0.1 % of the length: `solve_rod` as a search calls it, beside
  scipy's `solve_bvp`, compiled and plain (`rods_bvp`), at the setting that is fastest for it.
- The same beside PyElastica, relaxed to rest (`rods_elastica`).
- `beamopt.optimize` of a scene with its weight beside the one without, and where the time goes
  (`rods_search`).
- 27 tips by modes and by segments.

Times are the fastest of several, what is compared in turn. PyElastica (MIT) is no dependency: it is
measured where it is installed, `pip install '.[bench]'`, or found on PYTHONPATH.

BENCH_QUICK=1 takes small sizes, to try the benchmark itself; BENCH_PARTS names parts to measure, of
solvers, elastica, search, growth. Either writes to runs/bench-quick/.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import product

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.comparators.workload import workload_of
from beamopt.rod.equilibrium import solve_rod
from beamopt.rod.ladder import RodPiece
from beamopt.rod.modes import StrainModes
from beamopt.rod.pressure_tree import parents_on_grid
from beamopt.scene.scene import load_scene
from tests.bench.measured import QUICK, Measured
from tests.bench.rods_bvp import Start, compiled_tips, plain_tips
from tests.bench.rods_elastica import Clamp, Relaxation, fewest_elements, installed
from tests.bench.rods_search import searches
from tests.bench.rods_workspaces import (
    SCENES,
    SHARE,
    Workspace,
    as_shipped,
    fastest,
    workspace,
)

NODES, TOLERANCES = (4, 5, 7, 9), (0.3, 0.1, 0.03, 0.01, 0.001)
"""Settings that `solve_bvp` may choose from."""
CASES = (2, 13, 26)
"""Of the 27, for PyElastica: one, three half, three full pressures."""
ELEMENTS = {
    Clamp.CENTRED: (6, 8, 9, 10, 11, 12, 14, 16, 20),
    Clamp.MANUAL: (40, 80, 160, 240, 320, 340, 360, 400, 480),
}

Part = Callable[[], Iterator[Measured]]


def measure() -> Iterator[Measured]:
    parts = _quick() if QUICK else _full()
    names = os.environ.get("BENCH_PARTS", ",".join(parts)).split(",")
    unknown = [name for name in names if name not in parts]
    if unknown:
        raise ValueError(f"BENCH_PARTS: no part {unknown[0]!r}; one of: {', '.join(parts)}")
    for name in names:
        yield from parts[name]()


def _full() -> dict[str, Part]:
    return {
        "solvers": partial(solvers, SCENES, NODES, TOLERANCES, rounds=7),
        "elastica": partial(elastica, CASES, ELEMENTS),
        "search": partial(searches, 100, rounds=3),
        "growth": partial(growth, rounds=10),
    }


def _quick() -> dict[str, Part]:
    return {
        "solvers": partial(solvers, SCENES[:1], (5,), (1e-1, 1e-2), rounds=1),
        "elastica": partial(elastica, CASES[:1], {Clamp.CENTRED: (10, 12)}),
        "search": partial(searches, 3, rounds=1),
        "growth": partial(growth, rounds=2),
    }


def solvers(
    scenes: Sequence[str], nodes: Sequence[int], tolerances: Sequence[float], rounds: int
) -> Iterator[Measured]:
    """Ours and scipy's on each scene, with the errors that they reach."""
    for scene in scenes:
        on = workspace(scene)
        ours = partial(as_shipped, on.rod, on.rest)
        others = {
            "compiled, " + start.value: partial(compiled_tips, on.rod, on.rest, start)
            for start in Start
        }
        others["plain, from straight"] = partial(plain_tips, on.rod, on.rest)
        chosen = {
            name: _fastest_setting(on, solve, nodes, tolerances) for name, solve in others.items()
        }
        actions = [partial(others[name], *setting) for name, setting in chosen.items()]
        mine, *times = fastest([ours, *actions], rounds)
        yield Measured(f"{scene}: solve_rod", mine * 1e3, "ms per 27 tips")
        yield Measured(f"{scene}: solve_rod, largest error", 100 * on.error_of(ours()), "% of L")
        for (name, setting), action, taken in zip(chosen.items(), actions, times, strict=True):
            text = f"{scene}: solve_bvp {name}, {setting[0]} nodes, tol {setting[1]:g}"
            yield Measured(text, taken * 1e3, "ms per 27 tips")
            yield Measured(f"{text}, largest error", 100 * on.error_of(action()), "% of L")
            yield Measured(f"{scene}: solve_bvp {name}", taken / mine, "times as long")


def _fastest_setting(
    on: Workspace,
    solve: Callable[[int, float], FloatArray],
    nodes: Sequence[int],
    tolerances: Sequence[float],
) -> tuple[int, float]:
    """First nodes and tolerance with which scipy is fastest among those that are exact enough.

    Raises
    ------
    RuntimeError : none is.
    """
    exact = [
        setting for setting in product(nodes, tolerances) if on.error_of(solve(*setting)) <= SHARE
    ]
    if not exact:
        raise RuntimeError(f"{on.name}: solve_bvp is not exact enough at any setting")
    times = fastest([partial(solve, *setting) for setting in exact], 1)
    return exact[times.index(min(times))]


def elastica(cases: Sequence[int], elements: Mapping[Clamp, Sequence[int]]) -> Iterator[Measured]:
    """PyElastica on a few of the 27 pressures, each for itself; and all 27 in one simulator.

    Nothing where it is not installed.
    """
    if not installed():
        return
    on = workspace(SCENES[0]).without_coupling()
    ours = partial(as_shipped, on.rod, on.rest)
    for clamp, counts in elements.items():
        (before,) = fastest([ours], 20)
        each = [[k] for k in cases]
        count, steps, seconds, error = _relaxed(on, each, clamp, counts)
        (after,) = fastest([ours], 20)
        mine, text = min(before, after), f"elastica, {clamp.value}"
        yield Measured(f"{text}: solve_rod", mine * 1e3, "ms per 27 tips")
        yield Measured(f"{text}: elements", count, "")
        yield Measured(f"{text}: steps, mean of {len(cases)} cases", steps, "")
        yield Measured(f"{text}: largest error", 100 * error, "% of L")
        yield Measured(f"{text}: 27 × mean of {len(cases)} cases", 27 * seconds * 1e3, "ms")
        yield Measured(text, 27 * seconds / mine, "times as long")
        if clamp is Clamp.CENTRED:
            everything = [list(range(len(on.rest)))]
            count, _, seconds, _ = _relaxed(on, everything, clamp, counts)
            text = f"{text}, 27 rods of {count} elements in one simulator"
            yield Measured(text, seconds * 1e3, "ms per 27 tips")
            yield Measured(text, seconds / mine, "times as long")


def _relaxed(
    on: Workspace, groups: Sequence[list[int]], clamp: Clamp, counts: Sequence[int]
) -> tuple[int, float, float, float]:
    """Elements; steps and seconds, means of the groups; largest error over the length.

    groups : cases that share a simulator.
    """
    rods = [Relaxation(on.rod, on.rest[group, 0], on.density, 0, clamp) for group in groups]
    tips = [on.truth[group] for group in groups]
    near = SHARE * on.rod.length
    count, steps = fewest_elements(list(zip(rods, tips, strict=True)), counts, near)
    times, errors = [], []
    for rod, tip, needed in zip(rods, tips, steps, strict=True):
        seconds, found = replace(rod, elements=count).timed(needed)
        times.append(seconds)
        errors.append(np.linalg.norm(found - tip, axis=1).max() / on.rod.length)
    return count, float(np.mean(steps)), float(np.mean(times)), float(max(errors))


def growth(rounds: int) -> Iterator[Measured]:
    """27 tips of `gravity` by modes; and of it in pieces, each of a section turned further."""
    on = workspace(SCENES[0])
    counts = (2, 4, 8, 16)
    tree = StrainModes(parents=parents_on_grid())
    actions = [partial(tree.solve, on.rod, on.rest, count) for count in counts]
    for count, action, seconds in zip(counts, actions, fastest(actions, rounds), strict=True):
        yield Measured(f"{count} modes", seconds * 1e3, "ms per 27 tips")
        error = on.error_of(action().tips)
        yield Measured(f"{count} modes, largest error", 100 * error, "% of L")
    load = workload_of(load_scene(SCENES[0]))
    parts = (1, 2, 4)
    actions = []
    for count in parts:
        pieces = tuple(RodPiece(1 / count, 0.5 * k) for k in range(count))
        model = replace(load.model, pieces=pieces)
        rod, rest = model.rod(load.section), model.rest(load.section, load.pressures)
        actions.append(partial(solve_rod, rod, rest, SHARE * rod.length, parents_on_grid()))
    for count, seconds in zip(parts, fastest(actions, rounds), strict=True):
        yield Measured(f"solve_rod, segments: {count}", seconds * 1e3, "ms per 27 tips")
