"""What moved: rows of now that are farther from the held ones than their tolerance."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from femcheck.continuation.ended import Ended, NoReply
from femcheck.regression.held import LADDER, Held, Row
from femcheck.regression.measure import MeasuredPart

__all__ = ["Moved", "compare", "lowest", "said"]


@dataclass(frozen=True, eq=False)
class Moved:
    """A row that moved.

    design : its name. held : what is held of the row's rung. row : its name.
    before, now : its numbers, or why there are none; None where there is no such row.
    distance : length of the vector of its change, in the unit; infinite where it has no numbers.
    """

    design: str
    held: Held
    row: str
    before: Row | None
    now: Row | None
    distance: float

    def __str__(self) -> str:
        held = self.held
        grid = f" {held.resolution}" if held.resolution else ""
        what = f"{held.rung}{grid} of {self.design}: {held.quantity} at {self.row}"
        if math.isinf(self.distance):
            return f"{what}: {said(self.now)}, held: {said(self.before)}"
        return f"{what} moved by {self.distance:.3g} {held.unit} (tolerance {held.tolerance:.2g})"


def compare(design: str, held: Iterable[Held], measured: MeasuredPart) -> list[Moved]:
    """Every row of a design that moved, from the lowest rung on."""
    now = {one.key: one for one in measured.held}
    found: list[Moved] = []
    for one in held:
        other = now.pop(one.key, None)
        if other is None:
            none = Ended(NoReply.BROKEN, detail=measured.broken)
            found += [Moved(design, one, row, was, none, math.inf) for row, was in one.rows.items()]
        else:
            found += _rows(design, one, other)
    for other in now.values():  # appeared: nothing is held of it
        found += [Moved(design, other, row, None, is_, math.inf) for row, is_ in other.rows.items()]
    return sorted(found, key=_place)


def lowest(moved: Iterable[Moved]) -> Moved | None:
    """Of all designs, what moved by most tolerances on the lowest rung; None where nothing did."""
    found = sorted(moved, key=_place)
    first = [one for one in found if one.held.rung == found[0].held.rung]
    return max(first, key=_tolerances, default=None)


def _place(one: Moved) -> int:
    return LADDER.index(one.held.rung)


def _tolerances(one: Moved) -> float:
    return one.distance / one.held.tolerance if one.held.tolerance > 0 else math.inf


def _rows(design: str, held: Held, now: Held) -> Iterator[Moved]:
    for row in (*held.rows, *(row for row in now.rows if row not in held.rows)):
        before, after = held.rows.get(row), now.rows.get(row)
        distance = _distance(before, after)
        if not distance <= held.tolerance:
            yield Moved(design, held, row, before, after, distance)


def _distance(before: Row | None, now: Row | None) -> float:
    """Length of the change; infinite where statuses differ, or one has numbers."""
    if isinstance(before, tuple) and isinstance(now, tuple) and len(before) == len(now):
        distance = math.dist(before, now)
        return math.inf if math.isnan(distance) else distance
    if isinstance(before, Ended) and isinstance(now, Ended):
        return 0.0 if before.status is now.status else math.inf
    return math.inf


def said(row: Row | None) -> str:
    """A row for people."""
    if row is None:
        return "nothing"
    return str(row) if isinstance(row, Ended) else ", ".join(f"{value:.6g}" for value in row)
