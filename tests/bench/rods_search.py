"""Searches with and without the actuator's weight: wall time, and where it goes."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

import beamopt
from beamopt.judge.judge import Judge
from beamopt.rod.ladder import SectionValues
from beamopt.rod.pressure_tree import parents_on_grid
from beamopt.search.algorithm import GeneticAlgorithm
from beamopt.search.result import Optimisation
from beamopt.section.moments import Moments
from beamopt.section.phenotype import Phenotypes, phenotypes
from beamopt.section.saint_venant import SaintVenant, section_saint_venant
from tests.bench.measured import Measured
from tests.bench.rods_workspaces import fastest

__all__ = ["searches"]

WITHOUT, LOADED, STIFF = "without loads", "gravity", "gravity, stiff in torsion"
SCENES = {
    WITHOUT: ("hand-drawn-section", ()),
    LOADED: ("gravity", ()),
    STIFF: ("gravity", ('rod.twist="stiff"',)),
}


def searches(generations: int, rounds: int) -> Iterator[Measured]:
    """`optimize` on each, the target and the climb of the ladder included, in turn.

    CPU is what counts where others use the machine.
    """
    for name in SCENES:
        _searched(name, 1)  # compiles
    found: dict[str, Optimisation] = {}
    wall, cpu = (dict.fromkeys(SCENES, np.inf) for _ in range(2))
    for name in list(SCENES) * rounds:
        began, spent = time.perf_counter(), time.process_time()
        found[name] = _searched(name, generations)
        wall[name] = min(wall[name], time.perf_counter() - began)
        cpu[name] = min(cpu[name], time.process_time() - spent)
    for name, result in found.items():
        count = result.evaluations
        yield Measured(f"optimize, {name}, {count} sections", wall[name], "s")
        yield Measured(f"optimize, {name}, {count} sections", cpu[name], "s of CPU")
        yield Measured(f"per section, {name}", cpu[name] / count * 1e3, "ms of CPU")
    for name in (LOADED, STIFF):
        yield Measured(f"optimize, {name}", wall[name] / wall[WITHOUT], "times as long")
        yield Measured(f"optimize, {name}", cpu[name] / cpu[WITHOUT], "times the CPU")
    yield from _parts(found[LOADED])


def _searched(name: str, generations: int) -> Optimisation:
    scene, rules = SCENES[name]
    return beamopt.optimize(
        beamopt.load_scene(scene, [*rules, f"search.generations={generations}"])
    )


def _parts(result: Optimisation) -> Iterator[Measured]:
    """Each part on sections of first and last generation that have material and equilibrium."""
    judge = Judge.of_scene(result.scene, result.target)
    first = GeneticAlgorithm(result.scene).ask()
    known = [*zip(first, judge(first), strict=True)]
    known += [(one.points, one.verdict) for one in result.last.population]
    batch = [points for points, verdict in known if np.isfinite(verdict.L)]
    measure = partial(phenotypes, judge.grid, batch, judge.wall_elements, judge.rules, True)
    measured = measure()
    torsion = partial(_torsion, judge, measured)
    values = [
        SectionValues(Moments(raw), known)
        for raw, known in zip(measured.moments.raw, torsion(), strict=True)
    ]

    def modes() -> None:
        for one in values:
            judge.rod.tips(one, judge.aim.pressures, parents_on_grid(), all_or_none=True)

    actions: dict[str, Callable[[], object]] = {
        "all": partial(judge, batch),
        "raster, walls, moments, neighbours": measure,
        "torsion and shear": torsion,
        "rod in modes": modes,
    }
    times = fastest(list(actions.values()), 3)
    for what, seconds in zip(actions, times, strict=True):
        yield Measured(f"part, {LOADED}: {what}", seconds / len(batch) * 1e3, "ms per section")


def _torsion(judge: Judge, measured: Phenotypes) -> list[SaintVenant]:
    nu = judge.rod.poissons_ratio
    return [section_saint_venant(judge.grid, labels, nu) for labels in measured.labels]
