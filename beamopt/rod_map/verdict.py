"""What a method's answer is worth, where the right one is known."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.rod.status import RodStatus

__all__ = ["NEAR", "RIGHT", "MethodAnswer", "MethodVerdict", "Truth", "Witness", "apart", "judged"]

RIGHT, NEAR = 0.01, 0.05  # shares: distances from the truth


class MethodVerdict(Enum):
    """The value is the text shown to people."""

    RIGHT = "right"
    REFUSED_RIGHTLY = "refused rightly"
    INACCURATE = "inaccurate"
    REFUSED_WRONGLY = "refused wrongly"
    TOO_SLOW = "too slow"
    WRONG_BRANCH = "wrong branch"
    NO_SUCH_TIP = "tip without equilibrium"
    UNDECIDED = "undecided"

    @property
    def is_success(self) -> bool:
        """Whether a person is told what is so."""
        return self in (MethodVerdict.RIGHT, MethodVerdict.REFUSED_RIGHTLY)

    @property
    def is_wrong_tip(self) -> bool:
        """Whether a person is told what is not so: the worst that a method can do."""
        return self in (MethodVerdict.WRONG_BRANCH, MethodVerdict.NO_SUCH_TIP)


@dataclass(frozen=True, eq=False)
class MethodAnswer:
    """What a method said of one rod, after how many seconds. tip : (3,) [mm], NaN without one."""

    status: RodStatus
    tip: FloatArray
    seconds: float


class Witness(Enum):
    """Who knows the truth."""

    BOTH = "both"
    ELEMENTS = "elements"
    MODES = "modes"
    NEITHER = "neither"


@dataclass(frozen=True, eq=False)
class Truth:
    """The equilibrium that growing loads lead to from rest, through stable ones.

    status : CONVERGED, or why there is none. tip : (3,) [mm], NaN where there is none.
    gap : how far the witnesses' tips are `apart`.
    """

    witness: Witness
    status: RodStatus
    tip: FloatArray
    gap: float

    @property
    def known(self) -> bool:
        """Whether there is a witness."""
        return self.witness is not Witness.NEITHER


def judged(
    answer: MethodAnswer, truth: Truth, length: float, limit: float
) -> tuple[MethodVerdict, float]:
    """A verdict, and how far the tip is `apart` from the truth (NaN without one).

    limit : seconds after which an answer is too slow.
    """
    distance = apart(answer.tip, truth.tip, length)
    if not truth.known:
        return MethodVerdict.UNDECIDED, np.nan
    if answer.status is RodStatus.TOO_SLOW or answer.seconds > limit:
        return MethodVerdict.TOO_SLOW, distance
    has_tip, has_truth = (one.status is RodStatus.CONVERGED for one in (answer, truth))
    if not has_tip:
        return (
            MethodVerdict.REFUSED_WRONGLY if has_truth else MethodVerdict.REFUSED_RIGHTLY
        ), np.nan
    if not has_truth:
        return MethodVerdict.NO_SUCH_TIP, np.nan
    if distance <= RIGHT:
        return MethodVerdict.RIGHT, distance
    return (MethodVerdict.INACCURATE if distance <= NEAR else MethodVerdict.WRONG_BRANCH), distance


def apart(tip: FloatArray, other: FloatArray, length: float) -> float:
    """Distance of two tips as a share of the length, or of the tip's from the base if greater.

    Loads beyond sense draw a rod out to many times its length.
    """
    return float(np.linalg.norm(tip - other) / max(length, float(np.linalg.norm(other))))
