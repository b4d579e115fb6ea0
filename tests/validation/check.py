"""A check: something expected, something measured, and a verdict."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

__all__ = ["Check", "Row"]


@dataclass(frozen=True)
class Row:
    """One line of a validation table.

    check : what is looked at. source : where the expectation comes from.
    It holds when |measured − expected| ≤ tolerance.
    """

    check: str
    source: str
    expected: float
    measured: float
    tolerance: float

    @property
    def holds(self) -> bool:
        return abs(self.measured - self.expected) <= self.tolerance

    @property
    def cells(self) -> tuple[object, ...]:
        verdict = "holds" if self.holds else "FAILS"
        return (self.check, self.source, self.expected, self.measured, self.tolerance, verdict)


@dataclass(frozen=True)
class Check:
    """A named part of a suite; `rows` may take long and is kept once it is done."""

    name: str
    rows: Callable[[], Iterator[Row]]
