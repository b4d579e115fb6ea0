"""What a study leaves to read: table, comparison, convergence, best and worst designs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.provenance import provenance
from beamopt.judge.judge import JudgeStatus
from beamopt.plot.study import case_figure, losses_figure
from beamopt.plot.style import save_figure
from beamopt.scene.design import Design, load_design
from beamopt.scene.scene import load_scene
from beamopt.storage.writing import csv_text, json_text, still_complete, write_atomic, write_changed
from beamopt.study.plan import COMBINATIONS, TARGETS, Plan
from beamopt.study.refined import write_refined
from beamopt.study.table import (
    Outcome,
    comparison_markdown,
    table_csv,
    table_markdown,
    targets_of,
    title,
)

__all__ = ["names", "write_report"]


def names(plan: Plan) -> tuple[str, ...]:
    """Every file that `write_report` writes."""
    figures = ("convergence", *plan.targets, *(("refined",) if plan.refine else ()))
    return (
        "table.csv",
        "table.md",
        "convergence.csv",
        "best_ever.csv",
        *(("refined.csv", "refined.md", "bounds.csv") if plan.refine else ()),
        *(f"{figure}.{ending}" for figure in figures for ending in ("svg", "png")),
        *(f"{target}-{which}.json" for target in plan.targets for which in ("best", "worst")),
        *(f"{target}-refined.json" for target in plan.targets if plan.refine),
        "timing.csv",
        "provenance.json",
    )


def write_report(
    folder: Path,
    outcomes: Sequence[Outcome],
    plan: Plan,
    seconds: float,
    workers: int,
    *,
    figures: bool,
) -> None:
    """Write everything beside the run folders; each file whole or not at all.

    The times of a study whose tables are there already stay as they are.
    """
    spreads = _spreads(outcomes)
    tables = {
        "table.csv": table_csv(outcomes),
        "table.md": _markdown(outcomes, plan),
        "convergence.csv": _convergence_csv(spreads),
        "best_ever.csv": _best_ever_csv(outcomes),
    }
    complete = still_complete(folder, tables)
    for name, text in tables.items():
        write_changed(folder / name, text)
    cases = {target: _best_and_worst(folder, outcomes, target) for target in plan.targets}
    if figures:
        drawn = losses_figure(spreads, {target: title(target) for target in plan.targets})
        save_figure(drawn, folder / "convergence.svg", folder / "convergence.png")
        for target, designs in cases.items():
            drawn = case_figure(load_scene(target, plan.overrides).load_target(), designs)
            save_figure(drawn, folder / f"{target}.svg", folder / f"{target}.png")
    if plan.refine:
        write_refined(folder, outcomes, plan, figures=figures)
    if complete:
        return
    rows = [("study", seconds, "s"), ("workers", workers, "1")]
    rows += [(one.run.name, one.seconds, "s") for one in outcomes]
    rows += [
        (f"{one.run.name}-refined", one.refined.seconds, "s")
        for one in outcomes
        if one.refined is not None
    ]
    write_atomic(folder / "timing.csv", csv_text("what,value,unit", rows))
    write_atomic(folder / "provenance.json", json_text({"seed": plan.seed, **provenance()}))


def _best_and_worst(
    folder: Path, outcomes: Sequence[Outcome], target: str
) -> list[tuple[str, Design]]:
    """Keep the designs of a target's best and worst search; returns them with their titles.

    A search whose last population could not be judged has none.
    """
    ordered = sorted(
        (
            one
            for one in outcomes
            if one.run.target == target and one.final.status is JudgeStatus.JUDGED
        ),
        key=lambda one: one.final.L,
    )
    designs = []
    for name, one in (("best", ordered[0]), ("worst", ordered[-1])) if ordered else ():
        design = load_design(folder / "runs" / one.run.name / "final.json")
        design.save(folder / f"{target}-{name}.json")
        said = f"{name}: {one.run.combination}, iteration {one.run.iteration}"
        designs.append((f"{said}, L = {one.final.L:.4g} mm²", design))
    return designs


def _spreads(outcomes: Sequence[Outcome]) -> dict[str, dict[str, FloatArray]]:
    """For each target and combination (3, generations + 1): min, mean, max over iterations."""
    spreads: dict[str, dict[str, FloatArray]] = {}
    for target in targets_of(outcomes):
        for combination in COMBINATIONS:
            lines = [
                one.lowest
                for one in outcomes
                if (one.run.target, one.run.combination) == (target, combination)
            ]
            longest = max(len(line) for line in lines)
            # a search that stopped early keeps its last value
            padded = np.array([[*line, *[line[-1]] * (longest - len(line))] for line in lines])
            spread = np.stack([padded.min(axis=0), padded.mean(axis=0), padded.max(axis=0)])
            spreads.setdefault(target, {})[combination] = spread
    return spreads


def _convergence_csv(spreads: dict[str, dict[str, FloatArray]]) -> str:
    rows = [
        (target, combination, generation, *(float(value) for value in values))
        for target, lines in spreads.items()
        for combination, spread in lines.items()
        for generation, values in enumerate(spread.T)
    ]
    return csv_text("target,combination,generation,min_L,mean_L,max_L", rows)


def _best_ever_csv(outcomes: Sequence[Outcome]) -> str:
    rows = [
        (one.run.target, one.run.combination, one.run.iteration, one.final.L, one.best_ever)
        for one in outcomes
    ]
    return csv_text("target,combination,iteration,L,best_ever_L", rows)


def _markdown(outcomes: Sequence[Outcome], plan: Plan) -> str:
    return f"""# Loss L of the best individual at the end of each search [mm²]

Lowest L in the last population, by target, combination of methods and iteration: fixed (F) or
range (R) recombination with direct (D) or weighted (W) mutation. Bold is the lowest of a target,
italics the highest. Made by `{plan.command} --out DIR`.

{table_markdown(outcomes)}{_beside_the_paper(outcomes, plan)}"""


def _beside_the_paper(outcomes: Sequence[Outcome], plan: Plan) -> str:
    if plan.targets != TARGETS:
        return ""
    return f"""
## Beside the paper

Over all runs of a target. The paper's three targets are not published and ours are re-created in
kind, so only magnitudes can be compared: the first two targets belong to a section and can be
reached exactly, the third can not.

{comparison_markdown(outcomes)}"""
