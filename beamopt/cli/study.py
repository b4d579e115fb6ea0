"""`beamopt study`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.table import Table

from beamopt.cli.progress import console, progress_bar
from beamopt.study.plan import TARGETS, Plan
from beamopt.study.run import run_study
from beamopt.study.table import SUMMARIES, TITLES, Outcome

__all__ = ["study_command"]


def study_command(
    out: Path, iterations: int, seed: int, workers: int, resume: bool, overrides: Sequence[str]
) -> None:
    """Run a study, show progress, and print the losses by target."""
    plan = Plan(iterations, seed, tuple(overrides))
    with progress_bar("runs") as bar:
        task = bar.add_task("study", total=len(plan.runs()), said="starting")

        def show(outcome: Outcome, done: int, total: int) -> None:
            bar.update(task, completed=done, said=f"{outcome.run.name} L {outcome.final.L:.4g} mm²")

        outcomes = run_study(out, plan, workers=workers, resume=resume, callback=show)
    table = Table(title=f"L in mm² over {len(outcomes)} runs")
    table.add_column("target")
    for name in SUMMARIES:
        table.add_column(name, justify="right")
    for target in TARGETS:
        losses = [one.final.L for one in outcomes if one.run.target == target]
        table.add_row(TITLES[target], *(f"{make(losses):.2f}" for make in SUMMARIES.values()))
    console.print(table)
    console.print(f"files: {out}/ (table.md, table.csv, convergence.png, …)", soft_wrap=True)
