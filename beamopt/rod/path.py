"""Paths of equilibria as the load grows and falls, past limit points: arc-length continuation."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from beamopt.arrays import FloatArray
from beamopt.rod.balance import reaction_of, unknown_count
from beamopt.rod.newton import evaluate, is_stable
from beamopt.rod.packed import pack, stations_of
from beamopt.rod.rod import Rod
from beamopt.rod.shape import empty_shape
from beamopt.rod.tangent import tangent_into

__all__ = ["LoadPath", "PathStatus", "follow_path"]

CLOSE = 1e-9  # of the step, where an iteration has arrived
AT_REST = 1e-6  # of the length, or rad, that a held tip may be off at rest
MOST_ITERATIONS = 12
EASY, HARD = 4, 7  # iterations that make the next step longer or shorter
SMALLEST, LARGEST = 1e-4, 8.0  # steps, as multiples of the first one


class PathStatus(Enum):
    """How following a path ended; the value is the text shown to people."""

    FULL_LOAD = "the factor that was asked for was reached"
    ENOUGH_STEPS = "as many steps as were asked for"
    STEPS_TOO_SMALL = "the steps became too small"


@dataclass(frozen=True, eq=False)
class LoadPath:
    """Equilibria along a path, the unloaded one first.

    factors : (m,) of the loads. tips : (m, 3) [mm]. ends : (m, S, 3) ends of the segments [mm].
    stable : (m,) whether each is a minimum of the potential (see `newton.is_stable`).
    limits : factors at which the load has a maximum or minimum along the path, by the parabola
        through the three points there.
    limit_ends : (k, S, 3) the ends of the segments there.
    """

    status: PathStatus
    factors: FloatArray
    tips: FloatArray
    ends: FloatArray
    stable: NDArray[np.bool_]
    limits: FloatArray
    limit_ends: FloatArray


def follow_path(
    rod: Rod,
    *,
    modes: int = 12,
    step: float = 0.02,
    steps: int = 400,
    factor: float = 1.0,
) -> LoadPath:
    """Follow the equilibria of a rod from rest, through limit points.

    Pseudo-arc-length continuation (Keller 1977) in the modes' amplitudes, scaled to angles, and the
    load factor. A held tip has to be held where it is without loads.

    Parameters
    ----------
    modes : Legendre modes a segment. step : first step [rad, or share of the load].
    steps : at most. factor : of the loads, where the path ends.

    Raises
    ------
    ValueError : a tip that is held elsewhere than where it is without loads.
    """
    system = _System(rod, modes)
    here, at = np.zeros(system.size), 0.0
    if np.abs(system.residual(here, at)).max() > AT_REST * rod.length:
        raise ValueError("tip: must be held where it is without loads")
    points = [system.point(here, at)]
    direction = system.direction(here, at, None)
    length, status = step, PathStatus.ENOUGH_STEPS
    for _ in range(steps):
        found = system.correct(here, at, direction, length)
        if found is None:
            length /= 2
            if length < SMALLEST * step:
                status = PathStatus.STEPS_TOO_SMALL
                break
            continue
        last = np.append(here, at)
        here, at, count = found
        if at >= factor:  # back to where it was asked for
            share = (factor - last[-1]) / (at - last[-1])
            here = system.settle(last[:-1] + share * (here - last[:-1]), factor)
            points.append(system.point(here, factor))
            status = PathStatus.FULL_LOAD
            break
        points.append(system.point(here, at))
        direction = system.direction(here, at, direction)
        if count <= EASY:
            length = min(1.5 * length, LARGEST * step)
        elif count >= HARD:
            length /= 1.5
    factors, tips, ends, stable = (np.array(column) for column in zip(*points, strict=True))
    limits, limit_ends = _extremes(factors, ends)
    return LoadPath(status, factors, tips, ends, stable.astype(bool), limits, limit_ends)


class _System:
    """Residual and tangent of a rod's first case, in unknowns scaled to angles."""

    def __init__(self, rod: Rod, modes: int) -> None:
        self.rod, self.rest = pack(rod), rod.rest
        self.conservative = rod.is_conservative
        self.at = stations_of(tuple(one.length for one in rod.segments), modes)
        self.shape = empty_shape(len(self.at.at), len(rod.segments), len(self.at.step))
        self.size = unknown_count(self.rod, self.at)
        bending = float(np.max(np.abs(self.rod.bending[:, rod.free, rod.free])))
        amplitudes = modes * len(rod.segments) * len(rod.free)
        hinges = amplitudes + len(rod.base.hinges)
        self.held = self.size - hinges
        self.scale = np.full(self.size, 1 / rod.length)
        self.scale[amplitudes:hinges] = 1.0
        self.scale[hinges : hinges + 3] = bending / rod.length**2  # forces, then moments
        self.scale[hinges + 3 :] = bending / rod.length
        if rod.tip.position is None:
            self.scale[hinges:] = bending / rod.length
        # a held tip is held where it is all along, not led there
        self.start = self.rod.held_position[0] if len(self.rod.held_position) else np.zeros(3)
        self.turn = np.zeros(3)

    def residual(self, scaled: FloatArray, factor: float) -> FloatArray:
        out = np.empty(self.size)
        unknowns = scaled * self.scale
        held = (self.rod, self.at, self.rest, self.start, self.turn)
        evaluate(*held, factor, unknowns, self.shape, out)
        return np.asarray(out * self.scale)

    def tangent(self, scaled: FloatArray, factor: float) -> FloatArray:
        """(n, n) by the unknowns, at the shape of the last residual."""
        out = np.empty((self.size, self.size))
        reaction = reaction_of(self.rod, self.at, scaled * self.scale)
        tangent_into(self.rod, self.at, self.shape, factor, reaction, out)
        return np.asarray(out * self.scale[:, None] * self.scale)

    def by_load(self, scaled: FloatArray, factor: float) -> FloatArray:
        """(n,) derivative by the factor, in which the residual is quadratic; the shape is at it."""
        above, below = self.residual(scaled, factor + 1.0), self.residual(scaled, factor - 1.0)
        self.residual(scaled, factor)
        return (above - below) / 2

    def direction(self, scaled: FloatArray, factor: float, before: FloatArray | None) -> FloatArray:
        """(n + 1,) unit tangent of the path, onwards."""
        load = self.by_load(scaled, factor)
        matrix = np.column_stack([self.tangent(scaled, factor), load])
        ahead = np.append(np.zeros(self.size), 1.0) if before is None else before
        bordered = np.vstack([matrix, ahead])
        found = np.linalg.solve(bordered, np.append(np.zeros(self.size), 1.0))
        return np.asarray(found / np.linalg.norm(found))

    def correct(
        self, here: FloatArray, at: float, direction: FloatArray, length: float
    ) -> tuple[FloatArray, float, int] | None:
        """The equilibrium a step ahead; None where the iteration does not arrive near there."""
        start = np.append(here, at)
        now = start + length * direction
        for count in range(1, MOST_ITERATIONS + 1):
            residual = self.residual(now[:-1], now[-1])
            tangent = self.tangent(now[:-1], now[-1])
            load = self.by_load(now[:-1], float(now[-1]))
            bordered = np.vstack([np.column_stack([tangent, load]), direction])
            missing = np.append(residual, direction @ (now - start) - length)
            try:
                change = np.linalg.solve(bordered, missing)
            except np.linalg.LinAlgError:
                return None
            now = now - change
            if not np.isfinite(now).all() or np.linalg.norm(now - start) > 3 * length:
                return None
            if np.linalg.norm(change) < CLOSE * length:
                return now[:-1], float(now[-1]), count
        return None

    def settle(self, near: FloatArray, factor: float) -> FloatArray:
        """The equilibrium at a load, from one near it."""
        for _ in range(MOST_ITERATIONS):
            residual = self.residual(near, factor)
            change = np.linalg.solve(self.tangent(near, factor), residual)
            near = near - change
            if np.linalg.norm(change) < CLOSE:
                break
        return near

    def point(
        self, scaled: FloatArray, factor: float
    ) -> tuple[float, FloatArray, FloatArray, bool]:
        """Factor, tip, ends of segments, stability."""
        self.residual(scaled, factor)
        ends = self.shape.end_position.copy()
        stable = is_stable(self.tangent(scaled, factor), self.held, self.conservative)
        return factor, ends[-1], ends, stable


def _extremes(factors: FloatArray, ends: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Turning points of the load, by parabolas in the number of the point."""
    rises = np.diff(factors)
    limits, places = [], []
    for k in range(1, len(factors) - 1):
        if rises[k - 1] * rises[k] < 0:
            second = rises[k] - rises[k - 1]
            t = -(rises[k] + rises[k - 1]) / 2 / second
            weights = np.array([t * (t - 1) / 2, 1 - t * t, t * (t + 1) / 2])
            limits.append(weights @ factors[k - 1 : k + 2])
            places.append(np.tensordot(weights, ends[k - 1 : k + 2], axes=1))
    return np.array(limits), np.array(places).reshape(-1, *ends.shape[1:])
