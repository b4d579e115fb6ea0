"""Where the beam is within a share of the solid: crossings along the path of each specimen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from beamopt.base.arrays import FloatArray
from femcheck.stability.solve import TRACK

__all__ = ["AGREE", "Interval", "intervals_of", "stable_part"]

AGREE = 0.05
"""Difference between the tips, as a share of the beam's displacement, up to which it is valid."""

LOAD, UNSTABLE = TRACK.index("load"), TRACK.index("unstable")
APART = slice(TRACK.index("apart_x"), TRACK.index("apart_z") + 1)


@dataclass(frozen=True, slots=True)
class Interval:
    """Pressures at which the beam is valid.

    low, high : [kPa].
    ends : whether the beam stops being valid at `high`; else the path ends there.
    """

    low: float
    high: float
    ends: bool

    @property
    def begins(self) -> bool:
        """Whether the beam becomes valid at `low` only, not from rest on."""
        return self.low > 0


def stable_part(track: Sequence[Sequence[float]]) -> FloatArray:
    """(n, 8) points of a track that are stable, by rising pressure; rest is the first."""
    kept: list[Sequence[float]] = []
    for point in track:
        if point[UNSTABLE] <= 0 and (not kept or point[LOAD] > kept[-1][LOAD]):
            kept.append(point)
    return np.array(kept, dtype=np.float64).reshape(-1, len(TRACK))


def intervals_of(track: Sequence[Sequence[float]], agree: float = AGREE) -> tuple[Interval, ...]:
    """Where the tips are at most `agree` apart.

    Between two points of the track the way from tip to tip, as a share, is linear in the pressure:
    not its length, which has a corner where the solid's tip passes the beam's and would be missed.
    At rest nothing moves and there is no share: that of the first point holds down to there.
    """
    points = stable_part(track)
    points = points[np.isfinite(points[:, APART]).all(axis=1)]
    if not len(points):
        return ()
    loads = np.concatenate([[0.0], points[:, LOAD]])
    apart = np.concatenate([points[:1, APART], points[:, APART]])
    found: list[Interval] = []
    low: float | None = 0.0 if np.linalg.norm(apart[0]) <= agree else None
    for k in range(1, len(loads)):
        for share in _crossings(apart[k - 1], apart[k], agree):
            at = float(loads[k - 1] + share * (loads[k] - loads[k - 1]))
            if low is None:
                low = at
            else:
                found.append(Interval(low, at, True))
                low = None
    if low is not None:
        found.append(Interval(low, float(loads[-1]), False))
    return tuple(found)


def _crossings(a: FloatArray, b: FloatArray, radius: float) -> list[float]:
    """Shares of the way from a to b, above 0 and at most 1, at which it crosses a sphere."""
    along = b - a
    square, half, rest = along @ along, a @ along, a @ a - radius**2
    inside = half**2 - square * rest
    if square == 0 or inside <= 0:  # it stays where it is, or passes by
        return []
    root = np.sqrt(inside)
    return [float(t) for t in ((-half - root) / square, (-half + root) / square) if 0 < t <= 1]
