"""The end of a ray on two meshes, and the pressure up to which both may be relied on."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np

from femcheck.continuation.outcome import Status
from femcheck.prediction.ray_trace import RayResult
from femcheck.prediction.rays import Ray
from femcheck.prediction.work import RayKey

__all__ = ["AGREE", "GROWTH", "MARGIN", "Agreement", "RayEnds", "SafeBox", "Why", "safe_box"]

AGREE = 1.1
"""Largest ratio of a ray's ends on two meshes with which these agree."""
MARGIN = 1.5
"""Lowest end of any ray, on either mesh, over the pressure that is advised."""
GROWTH = 1.5
"""Volume of a chamber over that at rest up to which a pressure is advised."""


class Agreement(Enum):
    """Agreement of two meshes on one ray; the value is the text shown to people."""

    AGREE = "the meshes agree"
    DIFFER = "the meshes differ"
    UNKNOWN = "not known on both meshes"
    ONE_MESH = "one mesh only"


@dataclass(frozen=True, eq=False)
class RayEnds:
    """One ray on both meshes. coarse : None where it was not followed there."""

    ray: Ray
    standard: RayResult
    coarse: RayResult | None

    @property
    def loads(self) -> tuple[float, float]:
        """Loads [kPa] up to which the standard and the coarse mesh are stable; NaN: not known."""
        coarse = math.nan if self.coarse is None else _stable_up_to(self.ray, self.coarse)
        return _stable_up_to(self.ray, self.standard), coarse

    @property
    def ratio(self) -> float:
        """The larger load over the smaller one; NaN where that can not be said.

        Where only the smaller one is the end of a stable part it is a lower bound.
        """
        low, high = sorted(self.loads)
        if self.coarse is None or not self._ends_at(low):
            return math.nan
        return high / low if low > 0 else math.inf

    @property
    def is_bound(self) -> bool:
        """True if the ratio is a lower bound: a mesh has no end as far as it was followed."""
        results = (self.standard, self.coarse)
        return (
            not math.isnan(self.ratio)
            and self.ratio != 1
            and not all(one is not None and one.status.is_settled for one in results)
        )

    @property
    def agreement(self) -> Agreement:
        """Agreement of the two loads."""
        if self.coarse is None:
            return Agreement.ONE_MESH
        if self.ratio > AGREE:
            return Agreement.DIFFER
        known = all(
            one.status.is_settled or one.status is Status.CONVERGED
            for one in (self.standard, self.coarse)
        )
        return Agreement.AGREE if known else Agreement.UNKNOWN

    def _ends_at(self, load: float) -> bool:
        """Whether a mesh's stable part ends there, or both reach the last load."""
        results = [one for one in (self.standard, self.coarse) if one is not None]
        if all(one.status is Status.CONVERGED for one in results):
            return True
        return any(one.status.is_settled and one.critical == load for one in results)


def _stable_up_to(ray: Ray, result: RayResult) -> float:
    """Load up to which a ray is known to be stable [kPa]."""
    return ray.stops[-1] if result.status is Status.CONVERGED else result.critical


class Why(Enum):
    """Limit of a safe box."""

    END = "end of a ray"
    GROWTH = "growth of a chamber"
    ASKED = "largest pressure asked for"


@dataclass(frozen=True, slots=True)
class SafeBox:
    """Pressures 0…P in every supply, as far as the rays tell.

    pressure : P [kPa]. why : what limits it.
    at : the end on which the margin is, or the load at which the chamber has grown so far [kPa].
    key : mesh and number of the ray that limits it; None where none does.
    """

    pressure: float
    why: Why
    at: float
    key: RayKey | None = None


def safe_box(rays: Sequence[Ray], results: Mapping[RayKey, RayResult], largest: float) -> SafeBox:
    """The pressure that may be advised.

    `MARGIN` below the lowest end of any ray on any mesh, or the first jump to another shape; and
    so that along no ray a chamber under pressure grows to more than `GROWTH` times its volume at
    rest. largest : pressure asked for [kPa].
    """
    found = [SafeBox(largest, Why.ASKED, largest)]
    for key, result in sorted(results.items(), key=lambda item: item[0][::-1]):
        ray = rays[key[1]]
        end = min((_stable_up_to(ray, result), *result.snaps))
        if result.status is not Status.CONVERGED or result.snaps:
            found.append(SafeBox(end / MARGIN, Why.END, end, key))
        grown = _grown_at(ray, result)
        if grown < end:
            found.append(SafeBox(grown, Why.GROWTH, grown, key))
    return min(found, key=lambda one: one.pressure)


def _grown_at(ray: Ray, result: RayResult) -> float:
    """Load at which the first chamber under pressure has grown by `GROWTH`; infinite: none."""
    track = result.track
    if not len(track):
        return math.inf
    track = track[: int(np.argmax(track[:, 0])) + 1]
    first = math.inf
    for supply in ray.supplies:
        volume, rest = track[:, supply], track[0, supply]
        past = np.flatnonzero(volume >= GROWTH * rest)
        if rest > 0 and past.size:
            row = int(past[0])
            between = slice(max(row - 1, 0), row + 1)
            load = np.interp(GROWTH * rest, volume[between], track[between, 0])
            first = min(first, float(load))
    return first
