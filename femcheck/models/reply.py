"""What a model replies: a tip or a reason for every combination, and what they cost."""

from __future__ import annotations

import os
import time
from collections import Counter
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray
from femcheck.continuation.ended import FOUND, Ended
from femcheck.models.question import Question

__all__ = ["Model", "Reply", "cpu_seconds", "nothing"]


@dataclass(frozen=True, eq=False)
class Reply:
    """Tips of a question.

    tips : (n, 3) [mm], the base's material centroid at the origin; NaN without an equilibrium.
    endings : n, one a tip: `FOUND`, or why there is none.
    unknowns : of the discretisation; 0 for a closed form.
    size : what was meshed, for people; "" where nothing was.
    errors : (n,) the model's own estimate of its tips' error [mm]; None where it has none.
    """

    tips: FloatArray
    endings: tuple[Ended, ...]
    unknowns: int = 0
    size: str = ""
    errors: FloatArray | None = None

    @property
    def found(self) -> NDArray[np.bool_]:
        """(n,) where there is a tip."""
        return np.array([one.is_found for one in self.endings], dtype=np.bool_)

    @property
    def is_whole(self) -> bool:
        """Whether every combination has a tip."""
        return bool(self.found.all())

    @property
    def ended(self) -> Ended:
        """Of the commonest status without a tip the ending at the lowest load.

        `FOUND` where all tips are there.
        """
        wrong = [one for one in self.endings if not one.is_found]
        if not wrong:
            return FOUND
        usual = Counter(one.status for one in wrong).most_common(1)[0][0]
        alike = (one for one in wrong if one.status is usual)
        return min(alike, key=lambda one: np.inf if one.load is None else one.load)

    def away(self, tips: FloatArray) -> FloatArray:
        """(n,) distances from other tips (n, 3) [mm]; NaN where either has none."""
        return np.asarray(np.linalg.norm(self.tips - tips, axis=1))


class Model(Protocol):
    """A way to answer: a rung of the ladder at one resolution."""

    @property
    def family(self) -> str:
        """What it is called; models of one family differ in resolution alone."""
        ...

    @property
    def resolution(self) -> str:
        """How fine it is, for people."""
        ...

    def refuses(self, question: Question) -> str | None:
        """Why it can not be asked; None where it can."""
        ...

    def reply(self, question: Question, workers: int = 0) -> Reply:
        """Its tips, with so many processes; 0 stays in this one."""
        ...


def nothing(question: Question, why: Ended) -> Reply:
    """No tip at all, and why."""
    n = len(question.pressures)
    return Reply(np.full((n, 3), np.nan), (why,) * n)


def cpu_seconds() -> float:
    """Processor time of this process and of those it waited for [s]."""
    children = os.times()  # to a hundredth of a second
    return time.process_time() + children.children_user + children.children_system
