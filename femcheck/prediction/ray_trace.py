"""One ray of one solid: the unit of work that processes share."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from beamopt.base.arrays import FloatArray
from femcheck.continuation.limits import Limits
from femcheck.continuation.mode import LOCAL
from femcheck.continuation.outcome import Statistics, Status
from femcheck.continuation.path import Path
from femcheck.continuation.trace import PathSteps
from femcheck.prediction.answer import Answer, read_off
from femcheck.prediction.rays import Ray
from femcheck.solid.equilibrium import Equilibrium
from femcheck.solved.case import Solid, workshop

__all__ = ["RayResult", "RayTask", "stopped_ray", "trace_ray"]

TRACK = ("load", "volume_1", "volume_2", "volume_3", "x", "y", "z", "unstable")
"""Columns of a track: P [kPa], volumes [mm³], tip from the base's material centroid [mm], unstable
directions (−1: not known)."""


@dataclass(frozen=True, eq=False)
class RayTask:
    """A ray to be followed."""

    solid: Solid
    ray: Ray
    limits: Limits = field(default_factory=Limits)


@dataclass(frozen=True, eq=False)
class RayResult:
    """What was found along a ray.

    status : CONVERGED where every stop has a stable equilibrium, else what ended the stable part.
    critical : load at which the stable part ends [kPa]; NaN where it does not.
    answers : at the stops; None where there is none.
    last : the last stable equilibrium; None where not even rest could be computed.
    track : (n, 8) all equilibria, see `TRACK`.
    growth : volume of the chambers that are loaded over that at rest where the stable part ends.
    snaps : loads at which it jumped to another stable shape [kPa].
    mode_at : (3,) where stability is lost, undeformed [mm]. mode_share : of the nodes that take
        part. NaN where it is not lost, or where that is not known.
    """

    status: Status
    critical: float
    answers: tuple[Answer | None, ...]
    last: Answer | None
    track: FloatArray
    growth: float = float("nan")
    snaps: tuple[float, ...] = ()
    mode_at: FloatArray = field(default_factory=lambda: np.full(3, np.nan))
    mode_share: float = float("nan")
    statistics: Statistics = field(default_factory=Statistics)

    def is_final(self, limits: Limits) -> bool:
        """True if it would end alike if it was followed again under these limits."""
        return not limits.repeats(self.status, self.statistics)

    @property
    def is_local(self) -> bool:
        """Whether stability is lost by a small part of the section, and not by the actuator."""
        return self.mode_share < LOCAL


def trace_ray(task: RayTask) -> RayResult:
    """Follow a ray; whatever happens, a result with a status."""
    shop = workshop(task.solid)
    direction, budget = np.array(task.ray.direction), task.limits.begin()
    path = PathSteps().trace(
        shop.problem, shop.shapes, direction, task.ray.stops, shop.solver, budget=budget
    )
    answers = tuple(
        None if point is None else read_off(shop.problem, shop.shapes, point)
        for point in path.stops
    )
    last = read_off(shop.problem, shop.shapes, path.last) if path.last else None
    base = np.append(task.solid.section.moments.centroid, 0.0)
    found = RayResult(
        path.status,
        path.critical,
        answers,
        last,
        _track(shop.problem, base, path),
        growth=path.growth,
        snaps=path.snaps,
        statistics=path.statistics,
    )
    if path.mode is None:
        return found
    return replace(found, mode_at=path.mode.place, mode_share=path.mode.share)


def _track(problem: Equilibrium, base: FloatArray, path: Path) -> FloatArray:
    rows = [
        [
            point.load,
            *problem.volumes(point.state),
            *(point.state.tip - base),
            -1 if point.unstable is None else point.unstable,
        ]
        for point in path.points
    ]
    return np.array(rows, dtype=np.float64).reshape(-1, len(TRACK))


def stopped_ray(ray: Ray) -> RayResult:
    """The result of a ray whose process ended under it."""
    nothing = np.empty((0, len(TRACK)))
    return RayResult(Status.STOPPED, 0.0, (None,) * len(ray.stops), None, nothing)
