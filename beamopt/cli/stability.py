"""`beamopt stability`."""

from __future__ import annotations

from pathlib import Path

from rich.table import Table

from beamopt.cli.progress import console, counted
from beamopt.rod_map.sampling import Sample
from beamopt.rod_map.stability import run_stability
from beamopt.rod_map.summary import rates_of

__all__ = ["stability_command"]

LINES = 20  # of progress, where there is no terminal to draw a bar on


def stability_command(out: Path, samples: int, workers: int, seed: int, resume: bool) -> None:
    """Make a stability map, show progress, and print the rates of success."""
    starting = "starting (compiles once on a machine)"
    with counted("cases", "map", samples, said=starting, lines=LINES) as tell:

        def show(sample: Sample, done: int) -> None:
            tell(done, samples, f"{sample.case.kind.value} {sample.case.size:g}")

        found = run_stability(
            out, samples, workers=workers, seed=seed, resume=resume, callback=show
        )
    _report(found)
    console.print(f"files: {out}/ (reading.md, stability.png, …)", soft_wrap=True, markup=False)


def _report(samples: list[Sample]) -> None:
    table = Table(title=f"{len(samples):,} random sections under load")
    for name in ("method", "success", "wrong tips", "undecided", "median [ms]"):
        table.add_column(name, justify="left" if name == "method" else "right")
    rows = [row for sample in samples for row in sample.rows]
    for method in dict.fromkeys(row.method for row in rows):
        rates = rates_of([row for row in rows if row.method == method])
        undecided = str(rates.cases - rates.decided)
        shares = (f"{rates.success:.1%}", f"{rates.wrong_tips:.1%}", undecided)
        table.add_row(method, *shares, f"{1e3 * rates.seconds:.3g}")
    console.print(table)
