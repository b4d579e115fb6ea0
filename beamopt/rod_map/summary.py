"""Rates of success, and the commonest verdict of every cell of a map."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from beamopt.rod.status import RodStatus
from beamopt.rod_map.sampling import MethodSample
from beamopt.rod_map.verdict import MethodVerdict

__all__ = ["Rates", "commonest", "median_seconds", "rates_of"]


@dataclass(frozen=True)
class Rates:
    """What became of the rows of one method.

    cases : of which so many are `decided`; counts of verdicts are of those.
    reasons : statuses where it was wrong to refuse. seconds : the median.
    """

    cases: int
    verdicts: Counter[MethodVerdict]
    reasons: Counter[RodStatus]
    seconds: float

    @property
    def decided(self) -> int:
        """Cases whose truth is known."""
        return self.cases - self.verdicts[MethodVerdict.UNDECIDED]

    @property
    def success(self) -> float:
        """Share of decided cases where a person is told what is so; NaN without any."""
        return self._share([one for one in MethodVerdict if one.is_success])

    @property
    def wrong_tips(self) -> float:
        """Share of decided cases where a person is told what is not so."""
        return self._share([one for one in MethodVerdict if one.is_wrong_tip])

    def _share(self, verdicts: Sequence[MethodVerdict]) -> float:
        count = sum(self.verdicts[one] for one in verdicts)
        return count / self.decided if self.decided else np.nan


def rates_of(rows: Sequence[MethodSample]) -> Rates:
    """Rates over rows, of one method as a rule."""
    refused = (row.status for row in rows if row.verdict is MethodVerdict.REFUSED_WRONGLY)
    verdicts = Counter(row.verdict for row in rows)
    return Rates(len(rows), verdicts, Counter(refused), median_seconds(rows))


def commonest(rows: Sequence[MethodSample]) -> MethodVerdict:
    """The commonest verdict of decided cases, the worse of two that are as common."""
    known = Counter(row.verdict for row in rows if row.verdict is not MethodVerdict.UNDECIDED)
    worst_first = list(reversed(MethodVerdict))
    return max(known, key=lambda one: (known[one], -worst_first.index(one)), default=worst_first[0])


def median_seconds(rows: Sequence[MethodSample]) -> float:
    """The median time of what was timed; NaN where nothing was."""
    times = [row.seconds for row in rows if np.isfinite(row.seconds)]
    return float(np.median(times)) if times else np.nan
