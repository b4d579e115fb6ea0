"""Paths of equilibria as the load grows and falls, by arc-length continuation."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray
from beamopt.rod.path_system import BEND, MOST_ITERATIONS, PathState, PathSystem
from beamopt.rod.rod import Rod

__all__ = ["CriticalKind", "CriticalPoint", "LoadPath", "PathStatus", "Stretch", "follow_path"]

AT_REST = 1e-6  # of the length, or rad, that a held tip may be off at rest
EASY, HARD = 4, 7  # iterations that make the next step longer or shorter
SMALLEST, LARGEST = 1e-5, 8.0  # steps, as multiples of the first one
HALVINGS = 20  # of a step in which a critical point lies
MEET = 1e-3  # of the step, how near the equilibria on both sides of a critical point come


class PathStatus(Enum):
    """How following a path ended; the value is the text shown to people."""

    FULL_LOAD = "the factor that was asked for was reached"
    ENOUGH_STEPS = "as many steps as were asked for"
    STEPS_TOO_SMALL = "the steps became too small"


class CriticalKind(Enum):
    """Kind of a point where the tangent is singular; the value is the text shown to people."""

    LIMIT = "the load has an extremum along the path"
    BIFURCATION = "another branch crosses the path"


@dataclass(frozen=True, eq=False)
class CriticalPoint:
    """A point of a path where the tangent by the rod's shape is singular.

    factor : of the loads. ends : (S, 3) the ends of the segments [mm].
    after : number of the path's point before it.
    directions : unstable directions beyond it less those before it.
    """

    kind: CriticalKind
    factor: float
    ends: FloatArray
    after: int
    directions: int


@dataclass(frozen=True, slots=True)
class Stretch:
    """Points `first` to `last` of a path, between critical points.

    unstable : directions in which the potential falls; 0 is stable.
    bifurcations : that lie between rest and here. Up to the first one the path is the only one
        from rest; beyond it is the branch that goes straight on, and others leave it.
    """

    first: int
    last: int
    unstable: int
    bifurcations: int


@dataclass(frozen=True, eq=False)
class LoadPath:
    """Equilibria along a path, the unloaded one first.

    factors : (m,) of the loads. tips : (m, 3) [mm]. ends : (m, S, 3) ends of the segments [mm].
    stable : (m,) whether each is a minimum of the potential (see `newton.is_stable`).
    unstable : (m,) directions in which the potential falls; of loads without a potential 1 where
        the determinant has not the sign that it has at rest, else 0.
    critical : limit points and bifurcations in their order.
    """

    status: PathStatus
    factors: FloatArray
    tips: FloatArray
    ends: FloatArray
    stable: NDArray[np.bool_]
    unstable: NDArray[np.int64]
    critical: tuple[CriticalPoint, ...]

    @property
    def limits(self) -> FloatArray:
        """(k,) factors at which the load has a maximum or minimum along the path."""
        return np.array([one.factor for one in self._limits])

    @property
    def limit_ends(self) -> FloatArray:
        """(k, S, 3) the ends of the segments there [mm]."""
        return np.array([one.ends for one in self._limits]).reshape(-1, *self.ends.shape[1:])

    @property
    def bifurcations(self) -> FloatArray:
        """(k,) factors at which other branches cross the path."""
        found = [one.factor for one in self.critical if one.kind is CriticalKind.BIFURCATION]
        return np.array(found)

    @property
    def stretches(self) -> tuple[Stretch, ...]:
        """The path from one critical point to the next."""
        last = len(self.factors) - 1
        cuts = [-1, *(one.after for one in self.critical if one.after < last), last]
        crossed = [
            sum(one.kind is CriticalKind.BIFURCATION for one in self.critical if one.after < end)
            for end in cuts[1:]
        ]
        return tuple(
            Stretch(before + 1, end, int(self.unstable[end]), count)
            for (before, end), count in zip(pairwise(cuts), crossed, strict=True)
            if end > before
        )

    @property
    def _limits(self) -> list[CriticalPoint]:
        return [one for one in self.critical if one.kind is CriticalKind.LIMIT]


def follow_path(
    rod: Rod,
    *,
    modes: int = 12,
    step: float = 0.02,
    steps: int = 400,
    factor: float = 1.0,
) -> LoadPath:
    """Follow the equilibria of a rod from rest, through limit points and bifurcations.

    Pseudo-arc-length continuation (Keller 1977) in the modes' amplitudes, scaled to angles, and the
    load factor. A step counts only if its equilibrium is near the tangent that led there and the
    path hardly turns. Where the number of unstable directions or the determinant's sign changes the
    step is halved until the two sides meet, at a critical point, or turn out to be two paths; then
    the one from rest is followed. Through a bifurcation the path goes straight on. A held tip has
    to be held where it is without loads.

    Parameters
    ----------
    modes : Legendre modes a segment. step : first step [rad, or share of the load].
    steps : at most. factor : of the loads, where the path ends.

    Raises
    ------
    ValueError : a tip that is held elsewhere than where it is without loads.
    """
    system = PathSystem(rod, modes)
    here = np.zeros(system.size)
    if np.abs(system.residual(here, 0.0)).max() > AT_REST * rod.length:
        raise ValueError("tip: must be held where it is without loads")
    points, critical = [system.state(here, 0.0, None)], list[CriticalPoint]()
    length, status = step, PathStatus.ENOUGH_STEPS
    while len(points) <= steps:
        taken = _step(system, points[-1], length)
        if taken is None:
            length /= 2
            if length < SMALLEST * step:
                status = PathStatus.STEPS_TOO_SMALL
                break
            continue
        if taken.event is not None:
            critical.append(replace(taken.event, after=len(points) - 1))
        if taken.point.at >= factor:  # back to where it was asked for
            points.append(system.settled(points[-1], taken.point, factor))
            ahead = len(points) - 2  # what lies in the last step, beyond the load asked for
            critical = [one for one in critical if one.factor <= factor or one.after < ahead]
            status = PathStatus.FULL_LOAD
            break
        points.append(taken.point)
        if taken.length < length:
            length = max(taken.length, 2 * SMALLEST * step)
        elif taken.point.iterations <= EASY:
            length = min(1.5 * length, LARGEST * step)
        elif taken.point.iterations >= HARD:
            length /= 1.5
    return LoadPath(
        status,
        np.array([one.at for one in points]),
        np.array([one.ends[-1] for one in points]),
        np.array([one.ends for one in points]),
        np.array([one.stable for one in points]),
        np.array([one.unstable for one in points]),
        tuple(critical),
    )


@dataclass(frozen=True, eq=False)
class _Taken:
    """A step that counts: where it leads, how long it is, and the critical point that it passes."""

    point: PathState
    length: float
    event: CriticalPoint | None = None


def _step(system: PathSystem, here: PathState, length: float) -> _Taken | None:
    """A step of a length, or a shorter one up to where the path turns; None where none is found."""
    ahead = system.ahead(here, length)
    if ahead is None:
        return None
    if not here.parted(ahead):
        event = _limit(system, here, ahead, length) if here.turns(ahead) else None
        return _Taken(ahead, length, event)
    low, high, near, far = 0.0, length, here, ahead
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        found = system.ahead(here, middle)
        if found is None:
            break
        if here.parted(found):
            high, far = middle, found
        else:
            low, near = middle, found
    apart = np.linalg.norm(far.place - near.place) > MEET * length
    if apart or near.direction @ far.direction < BEND:  # two paths that do not meet: the near one
        event = _limit(system, here, near, low) if low > 0 and here.turns(near) else None
        return _Taken(near, low, event) if low > 0 else None
    limit = here.turns(far) and here.sign * far.sign > 0
    kind = CriticalKind.LIMIT if limit else CriticalKind.BIFURCATION
    directions = far.unstable - here.unstable
    return _Taken(far, high, CriticalPoint(kind, far.at, far.ends, 0, directions))


def _limit(system: PathSystem, here: PathState, ahead: PathState, length: float) -> CriticalPoint:
    """The extremum of the load within a step, by the zero of the tangent's share of the load."""
    low, high, near, far = 0.0, length, here, ahead
    for _ in range(MOST_ITERATIONS):
        a, b = near.direction[-1], far.direction[-1]
        share = np.clip(a / (a - b), 0.05, 0.95)
        middle = low + share * (high - low)
        found = system.ahead(here, float(middle))
        if found is None:
            break
        if here.turns(found):
            high, far = middle, found
        else:
            low, near = middle, found
        if high - low < MEET * length:
            break
    best = min(near, far, key=lambda one: abs(one.direction[-1]))
    directions = ahead.unstable - here.unstable
    return CriticalPoint(CriticalKind.LIMIT, best.at, best.ends, 0, directions)
