"""How much one case or one path may take, counted in work; and a clock where one is asked for."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

from femcheck.continuation.outcome import Statistics, Status

__all__ = ["Budget", "Limits"]


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits of one case or one path.

    iterations : most of Newton's iterations, each with one factorisation. How many a path takes
        hardly depends on the mesh; what one of them costs does. The longest path of any report
        takes 362.
    seconds : of a wall clock [s]; infinite: there is none, and results do not depend on what
        else the machine does.
    """

    iterations: int = 2000
    seconds: float = math.inf

    def begin(self) -> Budget:
        """All of it, from now on."""
        return Budget(self)

    def repeats(self, status: Status, spent: Statistics) -> bool:
        """True if a result is to be tried again under these limits.

        The clock or the death of a process ended it, or a work limit below this one.
        """
        less = status is Status.WORK_LIMIT and spent.iterations < self.iterations
        return status.is_interrupted or less


class Budget:
    """Rest of the limits of one case."""

    def __init__(self, limits: Limits) -> None:
        self._left = limits.iterations
        self._end = time.perf_counter() + limits.seconds

    def spend(self) -> Status | None:
        """Take one iteration; or how the case ends, where nothing is left."""
        if self._left <= 0:
            return Status.WORK_LIMIT
        if time.perf_counter() >= self._end:
            return Status.TIME_OUT
        self._left -= 1
        return None
