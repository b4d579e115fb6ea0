"""Seconds of one Newton iteration over layers, and over triangles of the section."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from beamopt.plot.style import ASIDE_COLOUR, SERIES_COLOURS, new_figure, styled
from femcheck.mesh.section_mesh import SectionMesh
from tests.bench.measured import Measured, save_growth
from tests.bench.solid_cases import LOAD, loaded, problem_of, section_of

PARTS = ("assembly", "factor", "solve")


@dataclass(frozen=True, eq=False)
class Cost:
    """Of an iteration.

    count : layers or triangles. seconds : (3,) of its parts.
    """

    count: int
    unknowns: int
    seconds: np.ndarray


def growth(
    layers: Sequence[int], factors: Sequence[float], fixed: tuple[int, float], repeats: int
) -> Iterator[Measured]:
    """Over `layers` at the sizes fixed[1], and over `factors` of the sizes at fixed[0] layers."""
    section = section_of(fixed[1])
    by_layers = [_cost(section, count, count, repeats) for count in layers]
    sections = [section_of(factor) for factor in factors]
    by_triangles = [_cost(one, fixed[0], len(one.triangles), repeats) for one in sections]
    names = (f"layers, {len(section.triangles)} triangles", f"triangles, {fixed[0]} layers")
    for name, costs in zip(names, (by_layers, by_triangles), strict=True):
        over, held = name.split(", ")
        for cost in costs:
            at = f"iteration, {cost.count} {over}, {held}"
            yield Measured(f"{at}: unknowns", cost.unknowns, "")
            for part, seconds in zip(PARTS, cost.seconds, strict=True):
                yield Measured(f"{at}: {part}", seconds, "s")
        for part, slope in zip(PARTS, _slopes(costs), strict=True):
            yield Measured(f"iteration over {over}: power of {part}", slope, "")
    save_growth(_figure(names, (by_layers, by_triangles)), "solid")


def _cost(section: SectionMesh, layers: int, count: int, repeats: int) -> Cost:
    """At an equilibrium, with its pattern analysed: the best of `repeats`, part by part."""
    problem = problem_of(section, layers)
    state, solver = loaded(problem)
    rounds = []
    for _ in range(repeats):
        began = time.perf_counter()
        forces = problem.forces(state, LOAD)
        tangent = problem.tangent(state, LOAD, forces)
        assembled = time.perf_counter()
        solver.factor(tangent)
        factored = time.perf_counter()
        solver.solve(-forces.reduced)
        rounds.append(np.diff([began, assembled, factored, time.perf_counter()]))
    return Cost(count, problem.body.unknowns, np.min(rounds, axis=0))


def _slopes(costs: Sequence[Cost]) -> np.ndarray:
    """(3,) powers: slopes of straight lines through the logarithms."""
    counts = np.log([cost.count for cost in costs])
    return np.polyfit(counts, np.log([cost.seconds for cost in costs]), 1)[0]


@styled
def _figure(names: Sequence[str], tables: Sequence[Sequence[Cost]]) -> object:
    figure = new_figure(9.0, 3.8)
    for axes, name, costs in zip(figure.subplots(1, 2, sharey=True), names, tables, strict=True):
        counts = np.array([cost.count for cost in costs], dtype=float)
        seconds = np.array([cost.seconds for cost in costs])
        for k, (part, slope) in enumerate(zip(PARTS, _slopes(costs), strict=True)):
            label = f"{part}: power {slope:.2f}"
            axes.loglog(counts, seconds[:, k], "o-", color=SERIES_COLOURS[k], label=label)
            middle = np.log(seconds[:, k]).mean() + slope * (np.log(counts) - np.log(counts).mean())
            axes.loglog(counts, np.exp(middle), "--", color=ASIDE_COLOUR, lw=0.8)
        over, held = name.split(", ")
        axes.set(xlabel=f"{over} ({held})")
        axes.set_xticks(counts, [f"{count:.0f}" for count in counts])
        axes.xaxis.minorticks_off()
        axes.grid(True)
        axes.legend()
        if axes.get_subplotspec().is_first_col():
            axes.set_ylabel("time per iteration [s]")
    return figure
