"""Time of one evaluation: against the reference, by part, and how it grows."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from beamopt.judge.judge import Judge
from beamopt.plot.style import ASIDE_COLOUR, SERIES_COLOURS, new_figure, styled
from beamopt.rod.ladder import RodModel
from beamopt.rod.response import linear_response
from beamopt.section.delaunay import delaunay_edges
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.moments import moments_of
from beamopt.section.raster import raster
from beamopt.section.walls import add_walls
from beamopt.target.aim import Aim
from beamopt.target.workspace import pressure_grid
from tests.bench.measured import Measured, save_growth
from tests.bench.reference import Reference

LEVELS = (0.0, 50.0, 100.0)
BATCH = 16
GRIDS = ((32, 90), (64, 180), (128, 360), (256, 720), (512, 1440))
COUNTS = (10, 20, 50, 100, 200, 500, 1000)


def judge_for(grid: PolarGrid) -> Judge:
    respond = partial(linear_response, youngs_modulus=300.0)
    rod = RodModel(100.0, 300.0, 100.0, respond)
    aim = Aim(pressure_grid(LEVELS), np.zeros((27, 3)))
    return Judge(grid, 4, rod, LEVELS, aim, 1000.0)


def candidates(grid: PolarGrid, count: int, points: int = 100) -> list[FeaturePoints]:
    return [FeaturePoints.random(grid, points, np.random.default_rng([k])) for k in range(count)]


def seconds(action: Callable[[], object], repeats: int = 15) -> float:
    """Median time of one call, after one that is not counted."""
    action()
    times = []
    for _ in range(repeats):
        started = time.perf_counter()
        action()
        times.append(time.perf_counter() - started)
    return statistics.median(times)


def reference_evaluations(reference: Reference, batch: list[FeaturePoints]) -> Callable[[], None]:
    pressures = pressure_grid(LEVELS)

    def run() -> None:
        for points in batch:
            reference.tips(reference.raw_moments(reference.labels(points)), pressures)
            reference.ratio(points)

    return run


def measure() -> Iterator[Measured]:
    grid = PolarGrid()
    batch = candidates(grid, BATCH)
    judge, reference = judge_for(grid), Reference(grid)
    pairs = []
    for _ in range(7):  # in turn, so that a slow moment of the machine hits both
        slow = seconds(reference_evaluations(reference, batch[:4]), 1) / 4
        fast = seconds(lambda: judge(batch), 5) / BATCH
        one = seconds(lambda: judge(batch[:1]), 5)
        pairs.append((slow, fast, one))
    slow, fast, one = (statistics.median(column) for column in zip(*pairs, strict=True))
    yield Measured("evaluation, reference", slow * 1e3, "ms")
    yield Measured("evaluation, in a batch of 16", fast * 1e3, "ms")
    yield Measured("evaluation, one at a time", one * 1e3, "ms")
    ratios = [(a / b, a / c) for a, b, c in pairs]
    yield Measured("ratio, in a batch", statistics.median(r for r, _ in ratios), "times faster")
    yield Measured("ratio, one at a time", statistics.median(r for _, r in ratios), "times faster")
    yield from parts(grid, batch)
    yield from growth()


def parts(grid: PolarGrid, batch: list[FeaturePoints]) -> Iterator[Measured]:
    """Each part on all of a batch, ours and scipy's."""
    labels = [raster(grid, points) for points in batch]
    reference = Reference(grid)
    for name, action in (
        ("part: nearest points", lambda: [raster(grid, points) for points in batch]),
        ("part: walls", lambda: [add_walls(each.copy(), 2, True) for each in labels]),
        ("part: moments", lambda: [moments_of(grid, each) for each in labels]),
        ("part: Delaunay", lambda: [delaunay_edges(points.x, points.y) for points in batch]),
        ("part: Delaunay and ratio, scipy", lambda: [reference.ratio(p) for p in batch]),
    ):
        yield Measured(name, seconds(action) / BATCH * 1e3, "ms")


def growth() -> Iterator[Measured]:
    """Times over elements and over feature points, and the straight lines through them."""
    cases = [(PolarGrid(radial=r, angular=a), 100) for r, a in GRIDS]
    cases += [(PolarGrid(), count) for count in COUNTS]
    actions = []
    for grid, count in cases:
        judge, batch = judge_for(grid), candidates(grid, BATCH, count)
        actions.append(partial(judge, batch))
    rounds = [[seconds(action, 1) for action in actions] for _ in range(7)]  # in turn
    times = np.median(rounds, axis=0) / BATCH * 1e3
    elements = np.array([grid.radial * grid.angular for grid, _ in cases[: len(GRIDS)]])
    by_elements = np.column_stack([elements, times[: len(GRIDS)]])
    by_points = np.column_stack([COUNTS, times[len(GRIDS) :]])
    for (radial, angular), (_, each) in zip(GRIDS, by_elements, strict=True):
        yield Measured(f"elements {radial} × {angular}, 100 feature points", each, "ms")
    for count, each in by_points:
        yield Measured(f"feature points {count:.0f}, 128 × 360 elements", each, "ms")
    for what, table in (("1000 elements", by_elements), ("100 feature points", by_points)):
        unit = 1000 if "elements" in what else 100
        # least squares of relative residuals: large cases must not hide small ones
        slope, fixed = np.polyfit(*table.T, 1, w=1 / table[:, 1])
        yield Measured(f"growth: fixed part over {what.split(' ', 1)[1]}", fixed, "ms")
        yield Measured(f"growth: for every {what} more", slope * unit, "ms")
    save_growth(_figure(by_elements, by_points), "evaluation")


@styled
def _figure(by_elements: np.ndarray, by_points: np.ndarray) -> object:
    figure = new_figure(9.0, 3.8)
    left, right = figure.subplots(1, 2, sharey=True)
    for axes, table, name in (
        (left, by_elements, "elements (100 feature points)"),
        (right, by_points, "feature points (128 × 360 elements)"),
    ):
        axes.loglog(*table.T, "o-", color=SERIES_COLOURS[0], label="measured")
        axes.set(xlabel=name)
        axes.grid(True, which="both")
    middle = by_elements[2]
    left.loglog(
        by_elements[:, 0],
        middle[1] * by_elements[:, 0] / middle[0],
        ls="--",
        color=ASIDE_COLOUR,
        label="linear",
    )
    left.legend()
    left.set_ylabel("time per evaluation [ms]")
    return figure
