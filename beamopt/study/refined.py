"""What refining the best design of every search of a study came to, beside how low L can be."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from beamopt.bound.certificate import Certificate, certificate
from beamopt.plot.study import refined_figure
from beamopt.plot.style import save_figure
from beamopt.scene.design import load_design
from beamopt.scene.scene import load_scene
from beamopt.storage.writing import csv_text, write_atomic
from beamopt.study.plan import COMBINATIONS, Plan
from beamopt.study.table import Outcome, RefinedOutcome, row, targets_of, title

__all__ = ["write_refined"]

NOTHING = 1e-9  # mm²; less than this is rounding


def write_refined(folder: Path, outcomes: Sequence[Outcome], plan: Plan, *, figures: bool) -> None:
    """Write tables, the best refined design of each target, and the figure.

    Times stand in `timing.csv`.
    """
    bounds = {target: _bound(target, plan) for target in targets_of(outcomes)}
    write_atomic(folder / "bounds.csv", _bounds_csv(bounds))
    write_atomic(folder / "refined.csv", _refined_csv(outcomes, bounds))
    write_atomic(folder / "refined.md", _markdown(outcomes, bounds, plan))
    for target in bounds:
        done = [one for one in outcomes if one.run.target == target and one.refined is not None]
        if done:
            best = min(done, key=lambda one: _refinement(one).L)
            design = load_design(folder / "runs" / best.run.name / "refined.json")
            design.save(folder / f"{target}-refined.json")
    if figures:
        points = {
            target: np.array([_four(one) for one in outcomes if one.run.target == target])
            for target in bounds
        }
        lows = {target: _lowest(bound) for target, bound in bounds.items()}
        drawn = refined_figure(points, lows, {target: title(target) for target in bounds})
        save_figure(drawn, folder / "refined.svg", folder / "refined.png")


def _bound(target: str, plan: Plan) -> Certificate:
    scene = load_scene(target, plan.overrides)
    return certificate(scene, scene.load_target())


def _lowest(bound: Certificate) -> float | None:
    """What a ring section can realise at best [mm²]; None where there is no bound."""
    return None if bound.ring is None else bound.ring.outer


def _bounds_csv(bounds: dict[str, Certificate]) -> str:
    rows: list[tuple[object, ...]] = []
    for target, bound in bounds.items():
        said = bound.status.value, bound.status.name
        if bound.ring is None or bound.proven is None or bound.response is None:
            rows.append((target, "", "", "", "", *said))
        else:
            ring = bound.ring.outer, bound.ring.inner
            values = bound.proven.loss, bound.response.loss, *ring
            rows.append((target, *values, *said))
    return csv_text("target,proven_L,response_L,ring_L,ring_attained_L,status,ended", rows)


def _refinement(one: Outcome) -> RefinedOutcome:
    assert one.refined is not None
    return one.refined


def _four(one: Outcome) -> tuple[float, float, float, float]:
    """L before and after, ratio before and after; NaN where nothing was refined."""
    if one.refined is None:
        return (np.nan,) * 4
    found = one.refined
    return found.L_before, found.L, found.ratio_before, found.ratio


def _refined_csv(outcomes: Sequence[Outcome], bounds: dict[str, Certificate]) -> str:
    rows: list[tuple[object, ...]] = []
    for one in outcomes:
        bound = _lowest(bounds[one.run.target])
        about = one.run.target, one.run.combination, one.run.iteration
        after = () if one.refined is None else (*_four(one), one.refined.evaluations)
        rows.append((*about, "" if bound is None else bound, *(after or ("",) * 5)))
    header = (
        "target,combination,iteration,bound,L,refined_L,ratio,refined_ratio,refined_evaluations"
    )
    return csv_text(header, rows)


COLUMNS: dict[str, Callable[[Sequence[Outcome]], str]] = {
    "runs": lambda some: str(len(some)),
    "L before, mean": lambda some: f"{np.mean([_refinement(o).L_before for o in some]):.2f}",
    "refined L, mean": lambda some: f"{np.mean([_refinement(o).L for o in some]):.4g}",
    "worst": lambda some: f"{max(_refinement(o).L for o in some):.4g}",
    "ratio before": lambda some: f"{np.mean([_refinement(o).ratio_before for o in some]):.3f}",
    "after": lambda some: f"{np.mean([_refinement(o).ratio for o in some]):.3f}",
    "after/before, mean": lambda some: f"{np.mean(_shares(some)):.3f}",
    "largest": lambda some: f"{max(_shares(some)):.3f}",
    "evaluations": lambda some: f"{np.mean([_refinement(o).evaluations for o in some]):.0f}",
}


def _shares(some: Sequence[Outcome]) -> list[float]:
    return [_refinement(one).ratio / max(_refinement(one).ratio_before, 1e-300) for one in some]


def _markdown(outcomes: Sequence[Outcome], bounds: dict[str, Certificate], plan: Plan) -> str:
    lines = [
        row(["target", "combination", "bound [mm²]", *COLUMNS]),
        row(["---", "---", *["---:"] * (1 + len(COLUMNS))]),
    ]
    for target, bound in bounds.items():
        low = _lowest(bound)
        said = "none" if low is None else f"{low:.6g}" if low > NOTHING else "0"
        mine = [one for one in outcomes if one.run.target == target and one.refined is not None]
        for combination in (*COMBINATIONS, "all"):
            some = [one for one in mine if combination in (one.run.combination, "all")]
            cells = [make(some) for make in COLUMNS.values()] if some else [""] * len(COLUMNS)
            lines.append(row([title(target), combination, said, *cells]))
    table = "\n".join(lines)
    return f"""# The best design of each search, refined

`L before` is that of the best design that the search ever judged, of its outline where sealed;
`bound` is what chambers in the ring can have at best (numerical; `bounds.csv` has the others).
Ratios are neighbour ratios. How long the searches and their refinements took stands in
`timing.csv`. Made by `{plan.command} --out DIR`.

{table}
"""
