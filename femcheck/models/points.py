"""Pressure combinations that need not lie on a grid, each solved from rest."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor, Future
from dataclasses import dataclass, field

from beamopt.base.arrays import FloatArray
from beamopt.base.tasks import Work
from femcheck.continuation.limits import Limits
from femcheck.solved.case import Case, CaseResult, Solid, solve_case, stopped

__all__ = ["PointKey", "PointWork"]

PointKey = tuple[int, int]
"""The number of a solid, and the row of a combination."""


@dataclass
class PointWork(Work[PointKey, CaseResult]):
    """What is to be solved; see `beamopt.base.tasks`.

    solids : of one mesh; each begins at the shapes of the one before.
    pressures : (n, 3) [kPa]. limits : of a case.
    """

    solids: Sequence[Solid]
    pressures: FloatArray
    limits: Limits
    results: dict[PointKey, CaseResult] = field(default_factory=dict)

    @property
    def keys(self) -> list[PointKey]:
        """Solid by solid."""
        rows = range(len(self.pressures))
        return [(number, row) for number in range(len(self.solids)) for row in rows]

    def is_ready(self, key: PointKey) -> bool:
        """As soon as the solid before has its shape."""
        number, row = key
        return number == 0 or (number - 1, row) in self.results

    def submit(self, executor: Executor, key: PointKey) -> Future[CaseResult]:
        """Have a case solved."""
        number, row = key
        guess = None if number == 0 else self.results[number - 1, row].shape
        case = Case(self.solids[number], self.pressures[row], guess, None, self.limits)
        return executor.submit(solve_case, case)

    def stopped(self, key: PointKey) -> CaseResult:
        """The result of a case whose process died."""
        return stopped()
