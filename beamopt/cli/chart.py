"""`beamopt chart`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.table import Table

from beamopt.chart.chart import RodChart, run_chart
from beamopt.chart.measure import MeasuredMethod
from beamopt.cli.progress import console, progress_bar
from beamopt.comparators.methods import all_methods
from beamopt.scene.scene import load_scene

__all__ = ["chart_command"]


def chart_command(
    scene_name: str, out: Path | None, seed: int | None, overrides: Sequence[str]
) -> None:
    """Measure all methods on a scene, and say which is the fastest."""
    scene = load_scene(scene_name, overrides)
    folder = out or Path("charts") / scene.name
    with progress_bar("measurements") as bar:
        total = 2 + sum(len(method.resolutions) for method in all_methods())
        task = bar.add_task(scene.name, total=total, said="starting (compiles once on a machine)")

        def show(row: MeasuredMethod) -> None:
            bar.update(task, advance=1, said=f"{row.method} {row.resolution or ''}")

        chart = run_chart(scene, folder, seed=seed, callback=show)
    _report(chart, folder)


def _report(chart: RodChart, folder: Path) -> None:
    title = f"{chart.scene}: the fastest of each method that is within {chart.tolerance:g} mm"
    table = Table(title=title)
    for name in ("method", "resolution", "error [mm]", "time [ms]"):
        table.add_column(name, justify="left" if name == "method" else "right")
    for name in dict.fromkeys(row.method for row in chart.rows):
        own = [row for row in chart.rows if row.method == name]
        within = [row for row in own if row.is_whole and row.error <= chart.tolerance]
        best = min(within, key=lambda row: row.seconds, default=None)
        if best is None:
            missed = own[-1].status.value if not own[-1].is_whole else "not within it"
            table.add_row(name, "", missed, "")
        else:
            at = "" if best.resolution is None else str(best.resolution)
            table.add_row(name, at, f"{best.error:.2g}", f"{1e3 * best.seconds:.3g}")
    console.print(table)
    console.print(chart.verdict, soft_wrap=True, markup=False)
    console.print(f"reference: ± {chart.uncertainty:.1g} mm", markup=False)
    console.print(f"files: {folder}/ (chart.csv, chart.png, …)", soft_wrap=True, markup=False)
