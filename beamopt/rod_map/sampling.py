"""All methods on one case of the stability map."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from time import perf_counter, thread_time

import numpy as np

from beamopt.comparators.methods import DEFAULT_RESOLUTIONS, all_methods, limited
from beamopt.rod.solution import Method
from beamopt.rod.status import RodStatus
from beamopt.rod_map.cases import CaseKind, LoadedSection, RodCase, case_of
from beamopt.rod_map.truth import true_equilibrium
from beamopt.rod_map.verdict import MethodAnswer, MethodVerdict, Truth, Witness, judged

__all__ = ["ADAPTIVE", "LIMIT", "METHODS", "MethodSample", "Sample", "solve_sample"]

LIMIT = 0.5
"""Seconds of processor time that a case may take."""
ADAPTIVE = "adaptive"
"""The method that the optimiser uses."""
METHODS = tuple(method.name for method in all_methods())


@dataclass(frozen=True)
class MethodSample:
    """One method on one case.

    distance : how far its tip is `apart` from the truth. seconds : of processor time.
    """

    case: RodCase
    method: str
    resolution: int
    verdict: MethodVerdict
    status: RodStatus
    distance: float
    seconds: float


@dataclass(frozen=True)
class Sample:
    """One case. witness, truth, gap : of its `Truth`. seconds : all of it took."""

    case: RodCase
    witness: Witness
    truth: RodStatus
    gap: float
    rows: tuple[MethodSample, ...]
    seconds: float


def solve_sample(seed: int, index: int, names: Sequence[str] = METHODS) -> Sample:
    """Solve a case from its straight rest, with the methods of those names."""
    methods = _ready(tuple(names))
    case = case_of(seed, index)
    loaded = LoadedSection.of(case)
    started = perf_counter()
    truth = true_equilibrium(loaded.rod, loaded.rest)
    rows = tuple(_row(case, limited(method, LIMIT), loaded, truth) for method in methods)
    seconds = perf_counter() - started
    return Sample(case, truth.witness, truth.status, truth.gap, rows, seconds)


def _row(case: RodCase, method: Method, loaded: LoadedSection, truth: Truth) -> MethodSample:
    """What a method says; it is not asked where nobody knows better."""
    resolution = DEFAULT_RESOLUTIONS[method.name]
    if not truth.known:
        skipped = MethodVerdict.UNDECIDED, RodStatus.SKIPPED
        return MethodSample(case, method.name, resolution, *skipped, np.nan, np.nan)
    started = thread_time()
    found = method.solve(loaded.rod, loaded.rest, resolution)
    answer = MethodAnswer(found.status[0], found.tips[0], thread_time() - started)
    verdict, distance = judged(answer, truth, loaded.rod.length, LIMIT)
    return MethodSample(
        case, method.name, resolution, verdict, answer.status, distance, answer.seconds
    )


@cache
def _ready(names: tuple[str, ...]) -> tuple[Method, ...]:
    """The methods of those names, compiled: a process's first case is not to pay for that."""
    methods = [method for method in all_methods() if method.name in names]
    for kind in CaseKind:
        loaded = LoadedSection.of(RodCase(0, 0, kind, 0.1, 20.0))
        true_equilibrium(loaded.rod, loaded.rest)
        for method in methods:
            method.solve(loaded.rod, loaded.rest, DEFAULT_RESOLUTIONS[method.name])
    return tuple(methods)
