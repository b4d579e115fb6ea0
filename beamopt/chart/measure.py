"""Error and time of methods on one workload."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from time import perf_counter

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.errors import InputError
from beamopt.comparators.methods import limited
from beamopt.comparators.workload import Workload
from beamopt.rod.ladder import Rung
from beamopt.rod.modes import StrainModes
from beamopt.rod.pressure_tree import parents_on_grid
from beamopt.rod.solution import Method, RodSolution
from beamopt.rod.status import RodStatus

__all__ = [
    "MeasuredMethod",
    "RodReference",
    "TimeLimits",
    "measure_method",
    "measure_rungs",
    "reference_of",
]

FINEST, NEXT = 24, 20
"""Modes of the reference and of the one that it is held against."""


@dataclass(frozen=True)
class TimeLimits:
    """seconds : a method may take in all. repeats, spent : of a solve, at least, with seconds."""

    seconds: float = 20.0
    repeats: int = 3
    spent: float = 0.3


@dataclass(frozen=True)
class MeasuredMethod:
    """One method at one resolution.

    error : largest distance of a tip from the reference [mm]; NaN without a tip.
    seconds : the fastest of several solves of all cases; NaN where it was too slow.
    converged, of : cases. status : the commonest reason why one has no tip, or that all have one.
    """

    method: str
    resolution: int | None
    error: float
    seconds: float
    converged: int
    of: int
    status: RodStatus

    @property
    def is_whole(self) -> bool:
        """Whether all cases have a tip."""
        return self.converged == self.of


@dataclass(frozen=True, eq=False)
class RodReference:
    """solution : the finest. between : largest distance from the next coarser one's tips [mm]."""

    solution: RodSolution
    between: float

    def error_of(self, tips: FloatArray) -> float:
        """Largest distance of tips (n, 3) from the reference [mm], where both have one."""
        distances = np.linalg.norm(tips - self.solution.tips, axis=1)
        known = distances[np.isfinite(distances)]
        return float(known.max()) if known.size else np.nan

    def uncertainty(self, rows: Sequence[MeasuredMethod]) -> float:
        """Its own largest error [mm]: as far as it is from itself, coarser, and from others.

        rows : of which the most exact one that is not in modes counts.
        """
        others = [
            row.error
            for row in rows
            if row.method not in {"adaptive", "modes", *(rung.value for rung in Rung)}
            and row.is_whole
            and np.isfinite(row.error)
        ]
        return max([self.between, min(others)]) if others else self.between


def reference_of(load: Workload) -> RodReference:
    """Tips with the most modes.

    Raises
    ------
    InputError : the rod has no equilibrium at any of the pressures.
    """
    method = StrainModes(parents=parents_on_grid())
    finest = method.solve(load.rod, load.rest, FINEST)
    if not finest.converged.any():
        status = finest.status[0].value
        raise InputError(load.scene, "", None, f"no equilibrium at any pressure: {status}")
    coarser = method.solve(load.rod, load.rest, NEXT)
    reference = RodReference(finest, np.nan)
    return RodReference(finest, reference.error_of(coarser.tips))


def measure_method(
    method: Method, load: Workload, reference: RodReference, limits: TimeLimits
) -> Iterator[MeasuredMethod]:
    """A method from coarse to fine, until its time is up."""
    rod, rest, n = load.rod, load.rest, len(load.rest)
    method.solve(rod, rest, method.resolutions[0])  # compiles
    left = limits.seconds
    for resolution in method.resolutions:
        if left <= 0:
            yield MeasuredMethod(method.name, resolution, np.nan, np.nan, 0, n, RodStatus.TOO_SLOW)
            continue
        method = limited(method, left / n)
        started = perf_counter()
        found = method.solve(rod, rest, resolution)
        left -= perf_counter() - started
        seconds, spent = _fastest(partial(method.solve, rod, rest, resolution), left, limits)
        left -= spent
        wrong = Counter(one for one in found.status if one is not RodStatus.CONVERGED)
        status = wrong.most_common(1)[0][0] if wrong else RodStatus.CONVERGED
        error, count = reference.error_of(found.tips), int(found.converged.sum())
        yield MeasuredMethod(method.name, resolution, error, seconds, count, n, status)


def _fastest(solve: Callable[[], object], left: float, limits: TimeLimits) -> tuple[float, float]:
    """The fastest of several calls, and how long they took together [s]."""
    times: list[float] = []
    while len(times) < limits.repeats or sum(times) < limits.spent:
        if sum(times) > left:
            break
        started = perf_counter()
        solve()
        times.append(perf_counter() - started)
    return min(times, default=np.nan), sum(times)


def measure_rungs(
    load: Workload, reference: RodReference, limits: TimeLimits
) -> Iterator[MeasuredMethod]:
    """The ladder's lower rungs: without loads, the arc also without what varies along the rod."""
    model, section, pressures, n = load.model, load.section, load.pressures, len(load.rest)
    # tips of rungs are material centroids, those of methods the axis
    solution = reference.solution
    centroids = model.centroids(section, solution.tips, solution.rotations)
    for rung in (Rung.ARC, Rung.CHAIN):
        lower = model.on(rung)
        tips = lower.tips(section, pressures).positions
        seconds, _ = _fastest(partial(lower.tips, section, pressures), np.inf, limits)
        error = reference.error_of(tips + solution.tips - centroids)
        yield MeasuredMethod(rung.value, None, error, seconds, n, n, RodStatus.CONVERGED)
