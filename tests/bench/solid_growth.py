"""Seconds of one Newton iteration over layers, and over triangles of the section.

In displacements alone (rigid-section law) and in the mixed form (incompressible neo-Hooke).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from beamopt.plot.style import ASIDE_COLOUR, SERIES_COLOURS, new_figure, styled
from femcheck.material.law import Law
from femcheck.material.neo_hookean import NeoHookean
from femcheck.mesh.section_mesh import SectionMesh
from tests.bench.measured import Measured, save_growth
from tests.bench.solid_cases import LOAD, RIGID, iteration, loaded, problem_of, section_of

PARTS = ("assembly", "factor", "solve")
FORMS: Mapping[str, Law] = {"rigid-section": RIGID, "mixed neo-Hooke": NeoHookean(300.0, 0.5)}
MARKERS = ("o-", "s:")


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
    sections = [section_of(factor) for factor in factors]
    names = (f"layers, {len(section.triangles)} triangles", f"triangles, {fixed[0]} layers")
    tables: list[dict[str, list[Cost]]] = [{}, {}]
    for form, law in FORMS.items():
        tables[0][form] = [_cost(section, law, count, count, repeats) for count in layers]
        tables[1][form] = [
            _cost(one, law, fixed[0], len(one.triangles), repeats) for one in sections
        ]
    for name, table in zip(names, tables, strict=True):
        over, held = name.split(", ")
        for form, costs in table.items():
            for cost in costs:
                at = f"iteration, {form}, {cost.count} {over}, {held}"
                yield Measured(f"{at}: unknowns", cost.unknowns, "")
                for part, seconds in zip(PARTS, cost.seconds, strict=True):
                    yield Measured(f"{at}: {part}", seconds, "s")
            for part, slope in zip(PARTS, _slopes(costs), strict=True):
                yield Measured(f"iteration, {form}, over {over}: power of {part}", slope, "")
    save_growth(_figure(names, tables), "solid")


def _cost(section: SectionMesh, law: Law, layers: int, count: int, repeats: int) -> Cost:
    """At an equilibrium, with its pattern analysed: the best of `repeats`, part by part."""
    problem = problem_of(section, layers, law)
    state, solver = loaded(problem)
    rounds = [iteration(problem, state, LOAD, solver) for _ in range(repeats)]
    return Cost(count, problem.unknowns, np.min(rounds, axis=0))


def _slopes(costs: Sequence[Cost]) -> np.ndarray:
    """(3,) powers: slopes of straight lines through the logarithms."""
    counts = np.log([cost.count for cost in costs])
    return np.polyfit(counts, np.log([cost.seconds for cost in costs]), 1)[0]


@styled
def _figure(names: Sequence[str], tables: Sequence[dict[str, list[Cost]]]) -> object:
    figure = new_figure(9.0, 4.2)
    for axes, name, table in zip(figure.subplots(1, 2, sharey=True), names, tables, strict=True):
        for (form, costs), marker in zip(table.items(), MARKERS, strict=True):
            counts = np.array([cost.count for cost in costs], dtype=float)
            seconds = np.array([cost.seconds for cost in costs])
            for k, (part, slope) in enumerate(zip(PARTS, _slopes(costs), strict=True)):
                label = f"{form}, {part}: power {slope:.2f}"
                axes.loglog(counts, seconds[:, k], marker, color=SERIES_COLOURS[k], label=label)
                logs = np.log(seconds[:, k]).mean() - slope * np.log(counts).mean()
                fit = np.exp(logs + slope * np.log(counts))
                axes.loglog(counts, fit, "--", color=ASIDE_COLOUR, lw=0.8)
        over, held = name.split(", ")
        axes.set(xlabel=f"{over} ({held})")
        axes.set_xticks(counts, [f"{count:.0f}" for count in counts])
        axes.xaxis.minorticks_off()
        axes.grid(True)
        axes.legend()
        if axes.get_subplotspec().is_first_col():
            axes.set_ylabel("time per iteration [s]")
    return figure
