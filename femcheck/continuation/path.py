"""Equilibria along one load: stable ones, the point where they end, and what lies behind it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from femcheck.continuation.mode import Mode
from femcheck.continuation.outcome import Statistics, Status
from femcheck.solid.state import State

__all__ = ["Path", "PathPoint", "is_limit", "is_past", "summit"]


@dataclass(frozen=True, eq=False)
class PathPoint:
    """An equilibrium on a path.

    load : P; the pressures are P · direction [kPa].
    volume : what P works on, direction · V [mm³].
    growth : d volume / d load [mm³/kPa]; negative past a limit point.
    unstable : directions in which the potential falls at constant pressure; None: not known.
    """

    state: State
    load: float
    volume: float
    growth: float
    unstable: int | None


@dataclass(frozen=True, eq=False)
class Path:
    """What a trace found.

    status : CONVERGED where every load asked for has a stable equilibrium, else what ended the
        stable part.
    critical : load at which the stable part ends [kPa]; NaN where it does not.
    points : all equilibria, in order, from rest.
    stops : the stable equilibria at the loads asked for; None where there is none.
    last : the stable equilibrium with the largest load; None where there is none at all.
    growth : volume over that at rest where the stable part ends; NaN where it does not.
    snaps : loads of limit points behind which the path became stable again at a higher load: the
        body jumps from one stable shape to another there.
    mode : the motion by which stability is lost; None where it is not, or is not known.
    """

    status: Status
    critical: float
    points: tuple[PathPoint, ...]
    stops: tuple[PathPoint | None, ...]
    last: PathPoint | None
    growth: float = float("nan")
    snaps: tuple[float, ...] = ()
    mode: Mode | None = None
    statistics: Statistics = field(default_factory=Statistics)


def is_limit(point: PathPoint) -> bool:
    """Whether what ended the stable part before this point is a limit point and nothing else."""
    return point.growth < 0 and point.unstable in (None, 1)


def is_past(point: PathPoint) -> bool:
    """Whether a point is behind the stable part of its path."""
    return point.growth < 0 or (point.unstable is not None and point.unstable > 0)


def summit(here: PathPoint, there: PathPoint) -> tuple[float, float]:
    """Largest load, and the volume there, of the cubic in the volume through two points."""
    width = there.volume - here.volume
    slopes = np.array([width / here.growth, width / there.growth])
    rise = there.load - here.load
    cubic = np.array(
        [slopes.sum() - 2 * rise, 3 * rise - 2 * slopes[0] - slopes[1], slopes[0], here.load]
    )
    at = np.roots(np.polyder(cubic))
    inside = at.real[(abs(at.imag) < 1e-9) & (at.real >= 0) & (at.real <= 1)]
    places = np.concatenate([[0.0, 1.0], inside])
    loads = np.polyval(cubic, places)
    best = int(np.argmax(loads))
    return float(loads[best]), float(here.volume + places[best] * width)
