"""One chart: all methods on one scene."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from beamopt.base.provenance import provenance, thread_settings
from beamopt.chart.measure import (
    MeasuredMethod,
    TimeLimits,
    measure_method,
    measure_rungs,
    reference_of,
)
from beamopt.comparators.methods import all_methods
from beamopt.comparators.workload import Workload, workload_of
from beamopt.plot.error_chart import Line, error_figure
from beamopt.plot.style import save_figure
from beamopt.rod.pressure_tree import parents_on_grid
from beamopt.rod.solution import Method
from beamopt.scene.scene import Scene
from beamopt.storage.result_folder import FolderKind, claimed
from beamopt.storage.writing import csv_text, json_text, write_atomic

__all__ = ["RodChart", "run_chart"]

HEADER = "scene,method,resolution,error_mm,seconds,converged,of,status,ended"
FILES = ("chart.csv", "chart.svg", "chart.png")
KIND = FolderKind("a chart of rods", "provenance.json", ("{",), goes_on=False, files=FILES)
BOUNDS = (1e-3, 1e-6)  # mm


@dataclass(frozen=True, eq=False)
class RodChart:
    """What was measured on a scene.

    rows : of every method and resolution. tolerance : the scene's [mm].
    uncertainty : of the reference [mm].
    """

    scene: str
    rows: tuple[MeasuredMethod, ...]
    tolerance: float
    uncertainty: float

    def fastest(self, error: float) -> MeasuredMethod | None:
        """The fastest whose tips are all within `error` [mm]."""
        within = [row for row in self.rows if row.is_whole and row.error <= error]
        return min(within, key=lambda row: row.seconds, default=None)

    @property
    def verdict(self) -> str:
        """Who is fastest at the scene's tolerance and at two finer ones, in one line."""
        said = []
        for bound in (self.tolerance, *BOUNDS):
            best = self.fastest(bound)
            name = f"to {bound:.3g} mm "
            if bound < self.uncertainty:
                said.append(name + f"unknown (reference: {self.uncertainty:.1g} mm)")
            elif best is None:
                said.append(name + "none")
            else:
                at = "" if best.resolution is None else f" {best.resolution}"
                said.append(name + f"{best.method}{at} in {1e3 * best.seconds:.3g} ms")
        return f"{self.scene}: fastest " + ", ".join(said)


def run_chart(
    scene: Scene,
    out: Path,
    *,
    seed: int | None = None,
    methods: Sequence[Method] | None = None,
    limits: TimeLimits | None = None,
    callback: Callable[[MeasuredMethod], None] | None = None,
) -> RodChart:
    """Measure the methods on a scene and write table, figure and provenance to `out`.

    Parameters
    ----------
    seed : of a random section; see `workload_of`.
    methods : all of them if left out. limits : of their time.
    callback : called with each measurement as it comes.

    Raises
    ------
    InputError : `out` holds files, or can not be written; the scene has nothing to solve.
    """
    load, limits = workload_of(scene, seed), limits or TimeLimits()
    chosen = all_methods(parents_on_grid()) if methods is None else methods
    with claimed(out, KIND, resume=False):
        chart = _measured(scene.name, load, chosen, limits, callback)
        _write(chart, out, seed)
    return chart


def _measured(
    name: str,
    load: Workload,
    methods: Sequence[Method],
    limits: TimeLimits,
    callback: Callable[[MeasuredMethod], None] | None,
) -> RodChart:
    reference = reference_of(load)
    rows: list[MeasuredMethod] = []
    for measured in (
        measure_rungs(load, reference, limits),
        *(measure_method(method, load, reference, limits) for method in methods),
    ):
        for row in measured:
            rows.append(row)
            if callback is not None:
                callback(row)
    return RodChart(name, tuple(rows), load.model.tolerance, reference.uncertainty(rows))


def _write(chart: RodChart, out: Path, seed: int | None) -> None:
    cells = [
        (
            *(chart.scene, row.method, row.resolution, _known(row.error), _known(row.seconds)),
            *(row.converged, row.of, row.status.value, row.status.name),
        )
        for row in chart.rows
    ]
    write_atomic(out / "chart.csv", csv_text(HEADER, cells))
    title = f"{chart.scene}: {chart.rows[0].of} tips, {_threads()}"
    figure = error_figure(_lines(chart), chart.tolerance, chart.uncertainty, title)
    save_figure(figure, out / "chart.svg", out / "chart.png")
    about = {"scene": chart.scene, "seed": seed, "uncertainty_mm": chart.uncertainty}
    write_atomic(
        out / "provenance.json", json_text({**about, "verdict": chart.verdict, **provenance()})
    )


def _known(value: float) -> float | None:
    return None if np.isnan(value) else value


def _threads() -> str:
    settings = thread_settings()
    if set(settings.values()) == {"1"}:
        return "one thread"
    return ", ".join(f"{name} {value}" for name, value in settings.items())


def _lines(chart: RodChart) -> list[Line]:
    names = list(dict.fromkeys(row.method for row in chart.rows))
    return [
        Line(
            name,
            [row.resolution for row in chart.rows if row.method == name],
            np.array([row.seconds for row in chart.rows if row.method == name]),
            np.array([row.error for row in chart.rows if row.method == name]),
            np.array([row.is_whole for row in chart.rows if row.method == name]),
        )
        for name in names
    ]
