"""The course of a search in numbers: what its tables and figures need, and no genotypes."""

from __future__ import annotations

from array import array
from collections.abc import Sequence
from typing import NamedTuple, overload

import numpy as np

from beamopt.search.algorithm import Generation

__all__ = ["GenerationNumbers", "History"]


class GenerationNumbers(NamedTuple):
    """Losses after a generation [mm²].

    generation : 0 for the initial population.
    evaluations : sections judged so far. rejected : of them, those that could not be judged or may
    not be made.
    lowest_loss, mean_loss, highest_loss, lowest_total : of the population.
    best_loss : of the individual with the lowest L + R in it.
    ever_loss, ever_neighbour_loss, ever_rule_loss : L, K, R of the one with the lowest L + R of all
    that were judged so far.

    Examples
    --------
    >>> import beamopt
    >>> found = beamopt.optimize(beamopt.load_scene("random-section", ["search.generations=1"]))
    >>> numbers: beamopt.GenerationNumbers = found.history[-1]
    >>> numbers.generation, numbers.evaluations
    (1, 38)
    """

    generation: int
    evaluations: int
    rejected: int
    lowest_loss: float
    mean_loss: float
    highest_loss: float
    lowest_total: float
    best_loss: float
    ever_loss: float
    ever_neighbour_loss: float
    ever_rule_loss: float


COUNTS = 3  # whole numbers among them, the first ones
WIDTH = len(GenerationNumbers._fields)


class History(Sequence[GenerationNumbers]):
    """The numbers of every generation, the initial population first; 88 bytes each.

    Examples
    --------
    >>> import beamopt
    >>> found = beamopt.optimize(beamopt.load_scene("random-section", ["search.generations=1"]))
    >>> history: beamopt.History = found.history
    >>> len(history)
    2
    """

    def __init__(self) -> None:
        self._numbers = array("d")

    def add(self, record: Generation) -> None:
        """Take the numbers of a generation."""
        losses = np.array([one.verdict.L for one in record.population])
        ever = record.best_ever.verdict
        numbers = GenerationNumbers(
            record.index,
            record.evaluations,
            sum(record.rejected.values()),
            float(losses.min()),
            float(losses.mean()),
            float(losses.max()),
            min(one.verdict.T for one in record.population),
            record.best.verdict.L,
            ever.L,
            ever.K,
            ever.R,
        )
        self._numbers.extend(numbers)

    def __len__(self) -> int:
        return len(self._numbers) // WIDTH

    @overload
    def __getitem__(self, place: int) -> GenerationNumbers: ...
    @overload
    def __getitem__(self, place: slice) -> list[GenerationNumbers]: ...
    def __getitem__(self, place: int | slice) -> GenerationNumbers | list[GenerationNumbers]:
        if isinstance(place, slice):
            return [self[k] for k in range(*place.indices(len(self)))]
        start = range(0, len(self._numbers), WIDTH)[place]
        numbers = self._numbers[start : start + WIDTH]
        counts = (int(number) for number in numbers[:COUNTS])
        return GenerationNumbers(*counts, *numbers[COUNTS:])

    def __repr__(self) -> str:
        return f"<History: {len(self)} generations>"
