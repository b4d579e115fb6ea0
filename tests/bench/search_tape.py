"""A judge that keeps a tape: how many sections it has judged, when, and the best so far."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, fields
from typing import Any
from unittest.mock import patch

import numpy as np

from beamopt.judge.judge import Judge, Verdict
from beamopt.refine import annealing
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.phenotype import Phenotypes

__all__ = ["BudgetSpentError", "Mark", "Tape", "TapedJudge", "counted_flips"]


class BudgetSpentError(Exception):
    """As many sections are judged as may be; what a search is ended by, wherever it is."""


@dataclass(frozen=True, slots=True)
class Mark:
    """Where a search is after a number of sections judged.

    seconds : of processor time since the search began. L : lowest so far [mm²].
    ratio, T : that section's neighbour ratio, and the lowest T of any section so far [mm²].
    flips : of types, proposed to a model so far; none of them is a section judged.
    """

    evaluations: int
    seconds: float
    L: float
    ratio: float
    T: float
    flips: int


class Tape:
    """A mark wherever L falls, at each count in `at`, and where the search ends.

    budget : sections that may be judged. The one after the last raises `BudgetSpentError`.
    """

    def __init__(self, budget: int, at: Sequence[int] = ()) -> None:
        self.budget, self.at = budget, frozenset(at)
        self.marks: list[Mark] = []
        self.evaluations = self.flips = 0
        self.L = self.T = self.ratio = np.inf
        self.of_raster: Phenotypes | None = None
        self.began = time.process_time()

    def note(self, verdicts: Sequence[Verdict], weight: float, counts: bool = True) -> None:
        """Take what was judged, in that order; a batch is there when all of it is judged.

        weight : λ of the second objective. counts : whether L may be compared with the others'.
        """
        seconds = time.process_time() - self.began
        for verdict in verdicts:
            if self.evaluations >= self.budget:
                raise BudgetSpentError
            self.evaluations += 1
            falls = counts and verdict.L < self.L
            if falls:
                self.L, self.ratio = verdict.L, verdict.K / weight
            if counts:
                self.T = min(self.T, verdict.T)
            if falls or self.evaluations in self.at:
                self.marks.append(self.mark(seconds))
        if self.evaluations >= self.budget:
            raise BudgetSpentError

    def mark(self, seconds: float) -> Mark:
        return Mark(self.evaluations, seconds, self.L, self.ratio, self.T, self.flips)

    def finished(self) -> tuple[Mark, ...]:
        """All marks, and one more for the end."""
        return (*self.marks, self.mark(time.process_time() - self.began))


@dataclass(frozen=True, eq=False)
class TapedJudge(Judge):
    """The same verdicts as another judge's, on a tape."""

    tape: Tape = field(default_factory=lambda: Tape(0))

    @classmethod
    def of(cls, judge: Judge, tape: Tape) -> TapedJudge:
        """What `judge` is, with a tape."""
        return cls(**{each.name: getattr(judge, each.name) for each in fields(Judge)}, tape=tape)

    def measured(self, candidates: Sequence[FeaturePoints]) -> Phenotypes:
        self.tape.of_raster = super().measured(candidates)
        return self.tape.of_raster

    def verdicts(self, measured: Phenotypes, counts: Sequence[int]) -> list[Verdict]:
        """Outlines of sealed sections are judged too: counted, but not for the lowest L.

        All methods search on rasters; what an outline gives is another number.
        """
        found = super().verdicts(measured, counts)
        self.tape.note(found, self.neighbour_weight, counts=measured is self.tape.of_raster)
        return found


@contextmanager
def counted_flips(tape: Tape) -> Iterator[None]:
    """Count the flips that annealing proposes to its model."""
    walk = annealing.walk

    def counted(*arguments: Any) -> float:
        *_, draws = arguments
        tape.flips += len(draws)
        return walk(*arguments)

    with patch.object(annealing, "walk", counted):
        yield
