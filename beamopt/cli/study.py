"""`beamopt study`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from rich.table import Table

from beamopt.cli.progress import console, counted
from beamopt.study.plan import Plan
from beamopt.study.study import run_study
from beamopt.study.table import SUMMARIES, Outcome, targets_of, title

__all__ = ["refinement_table", "study_command"]


def study_command(out: Path, plan: Plan, workers: int, resume: bool) -> None:
    """Run a study, show progress, and print the losses by target."""
    with counted("runs", "study", len(plan.runs())) as tell:

        def show(outcome: Outcome, done: int, total: int) -> None:
            tell(done, total, f"{outcome.run.name} L {outcome.final.L:.4g} mm²")

        outcomes = run_study(out, plan, workers=workers, resume=resume, callback=show)
    console.print(_losses(outcomes))
    if plan.refine:
        console.print(refinement_table(outcomes))
    console.print(f"files: {out}/ (table.md, table.csv, convergence.png, …)", soft_wrap=True)


def _losses(outcomes: Sequence[Outcome]) -> Table:
    table = Table(title=f"L in mm² over {len(outcomes)} runs")
    table.add_column("target")
    for name in SUMMARIES:
        table.add_column(name, justify="right")
    for target in targets_of(outcomes):
        losses = [one.final.L for one in outcomes if one.run.target == target]
        table.add_row(title(target), *(f"{make(losses):.2f}" for make in SUMMARIES.values()))
    return table


def refinement_table(outcomes: Sequence[Outcome]) -> Table:
    """What refining came to, with how long it took as a share of the search."""
    table = Table(title="refined: the best design of each search")
    table.add_column("target")
    for name in ("mean L", "refined", "worst", "ratio", "refined", "time", "longest"):
        table.add_column(name, justify="right")
    for target in targets_of(outcomes):
        mine = [one for one in outcomes if one.run.target == target]
        both = [(one, one.refined) for one in mine if one.refined is not None]
        if not both:
            continue
        # a search that was judged by an earlier call has no time of its own
        shares = [found.seconds / one.seconds for one, found in both if one.seconds > 0]
        timed = np.isfinite(shares).all() and bool(shares)
        table.add_row(
            title(target),
            f"{np.mean([found.L_before for _, found in both]):.2f}",
            f"{np.mean([found.L for _, found in both]):.4g}",
            f"{max(found.L for _, found in both):.4g}",
            f"{np.mean([found.ratio_before for _, found in both]):.3f}",
            f"{np.mean([found.ratio for _, found in both]):.3f}",
            f"{np.mean(shares):.0%} of the search" if timed else "–",
            f"{max(shares):.0%}" if timed else "–",
        )
    return table
