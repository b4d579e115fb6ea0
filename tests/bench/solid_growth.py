"""Seconds of one Newton iteration over layers, and over triangles of the section.

In displacements alone (rigid-section law) and in the mixed form (incompressible neo-Hooke).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from beamopt.plot.style import SERIES_COLOURS, new_figure, styled
from femcheck.material.law import Law
from femcheck.material.neo_hookean import NeoHookean
from femcheck.solid.equilibrium import Equilibrium
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
    sections = {factor: section_of(factor) for factor in (fixed[1], *factors)}
    triangles = {factor: len(section.triangles) for factor, section in sections.items()}
    names = (f"layers, {triangles[fixed[1]]} triangles", f"triangles, {fixed[0]} layers")
    tables: list[dict[str, list[Cost]]] = [{}, {}]
    for form, law in FORMS.items():
        over_layers = [(count, fixed[1]) for count in layers]
        over_factors = [(fixed[0], factor) for factor in factors]
        costs = {
            (count, factor): _cost(problem_of(sections[factor], count, law), repeats)
            for count, factor in dict.fromkeys((*over_layers, *over_factors))
        }
        tables[0][form] = [Cost(at[0], *costs[at]) for at in over_layers]
        tables[1][form] = [Cost(triangles[at[1]], *costs[at]) for at in over_factors]
    for name, table in zip(names, tables, strict=True):
        for form, row in table.items():
            yield from _rows(name, form, row)
    save_growth(_figure(names, tables), "solid")


def _rows(name: str, form: str, costs: Sequence[Cost]) -> Iterator[Measured]:
    over, held = name.split(", ")
    for cost in costs:
        at = f"iteration, {form}, {cost.count} {over}, {held}"
        yield Measured(f"{at}: unknowns", cost.unknowns, "")
        for part, seconds in zip(PARTS, cost.seconds, strict=True):
            yield Measured(f"{at}: {part}", seconds, "s")
    for part, slope in zip(PARTS, _slopes(costs), strict=True):
        yield Measured(f"iteration, {form}, over {over}: power of {part}", slope, "")


def _cost(problem: Equilibrium, repeats: int) -> tuple[int, np.ndarray]:
    """Unknowns, and (3,) seconds at an equilibrium with its pattern analysed: the best."""
    state, solver = loaded(problem)
    rounds = [iteration(problem, state, LOAD, solver) for _ in range(repeats)]
    return problem.unknowns, np.min(rounds, axis=0)


def _slopes(costs: Sequence[Cost]) -> np.ndarray:
    """(3,) powers: slopes of straight lines through the logarithms."""
    counts = np.log([cost.count for cost in costs])
    return np.polyfit(counts, np.log([cost.seconds for cost in costs]), 1)[0]


@styled
def _figure(names: Sequence[str], tables: Sequence[dict[str, list[Cost]]]) -> object:
    figure = new_figure(9.0, 5.6)
    for axes, name, table in zip(figure.subplots(1, 2, sharey=True), names, tables, strict=True):
        for (form, costs), marker in zip(table.items(), MARKERS, strict=True):
            counts = np.array([cost.count for cost in costs], dtype=float)
            seconds = np.array([cost.seconds for cost in costs])
            for k, (part, slope) in enumerate(zip(PARTS, _slopes(costs), strict=True)):
                label = f"{form}, {part}: power {slope:.2f}"
                axes.loglog(counts, seconds[:, k], marker, color=SERIES_COLOURS[k], label=label)
        over, held = name.split(", ")
        axes.set(xlabel=f"{over} ({held})")
        axes.set_xticks(counts, [f"{count:.0f}" for count in counts])
        axes.xaxis.minorticks_off()
        axes.grid(True)
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.15))
        if axes.get_subplotspec().is_first_col():
            axes.set_ylabel("time per iteration [s]")
    return figure
