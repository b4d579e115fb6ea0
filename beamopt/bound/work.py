"""How much a bound may take, counted in work: what it has proven by then is valid."""

from __future__ import annotations

from collections.abc import Callable

__all__ = ["MOST_WORK", "Progress", "WorkLeft"]

MOST_WORK = 5 * 10**8
"""Tips of arcs that a bound computes at most, unless more is asked for: a minute or two. The
bundled scenes take at most a million."""

ROUND = 1000  # tips that one step of any iteration counts on top of its own
PASS = 3  # one round of bounds over all rays may take one part in so many of what is left

Progress = Callable[[str, float], None]
"""Gets the part of the work that goes on, and the share of the work allowed that is spent."""


class WorkLeft:
    """The rest of the work that is allowed.

    most : tips to compute. short : whether anything was cut short for want of it.
    """

    def __init__(self, most: float = MOST_WORK, callback: Progress | None = None) -> None:
        self.most = most
        self.spent = 0.0
        self.short = False
        self._callback = callback

    @property
    def left(self) -> float:
        """Tips that may be computed still."""
        return max(0.0, self.most - self.spent)

    @property
    def of_a_pass(self) -> float:
        """Tips that the next round of bounds over all rays may take."""
        return self.left / PASS

    def spend(self, part: str, tips: float) -> None:
        """Take work that was done, and say how far it is."""
        self.spent += tips
        if self._callback is not None:
            self._callback(part, min(1.0, self.spent / self.most))
