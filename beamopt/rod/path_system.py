"""The equations of a path of equilibria, and what is known of a point on it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.rod.balance import reaction_of, unknown_count
from beamopt.rod.newton import evaluate, is_stable
from beamopt.rod.packed import pack, stations_of
from beamopt.rod.rod import Rod
from beamopt.rod.shape import empty_shape
from beamopt.rod.tangent import tangent_into

__all__ = ["BEND", "MOST_ITERATIONS", "PathState", "PathSystem"]

CLOSE = 1e-9  # of the step, where an iteration has arrived
ROUNDING = 1e-11  # rad, or share of the load; near a critical point no iteration comes nearer
DRIFT = 0.5  # of a step, that its equilibrium may be off the tangent that led there
BEND = 0.8  # cosine between successive tangents at least
MOST_ITERATIONS = 12


@dataclass(frozen=True, eq=False)
class PathState:
    """An equilibrium on a path.

    here : (n,) unknowns, scaled. at : factor of the loads. direction : (n + 1,) unit tangent,
    onwards. unstable : see `LoadPath`. sign : of the determinant of the tangent bordered by load
    and direction, which changes at bifurcations and not at limits. iterations : that it took.
    """

    here: FloatArray
    at: float
    direction: FloatArray
    ends: FloatArray
    stable: bool
    unstable: int
    sign: float
    iterations: int

    @property
    def place(self) -> FloatArray:
        """(n + 1,) unknowns and factor."""
        return np.append(self.here, self.at)

    def turns(self, other: PathState) -> bool:
        """True if the load has an extremum between here and there."""
        return bool(self.direction[-1] * other.direction[-1] < 0)

    def parted(self, other: PathState) -> bool:
        """True if there is more between here and there than a limit point or nothing."""
        change = abs(other.unstable - self.unstable)
        return self.sign * other.sign < 0 or change != self.turns(other)


class PathSystem:
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
        """(n,) that vanishes in equilibrium; leaves the shape as the unknowns make it."""
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

    def state(
        self, scaled: FloatArray, factor: float, before: FloatArray | None, iterations: int = 0
    ) -> PathState:
        """The equilibrium with all that a path needs to know of it.

        before : (n + 1,) tangent of the path before; None at rest, where the load grows.
        """
        load = self.by_load(scaled, factor)
        tangent, ends = self.tangent(scaled, factor), self.shape.end_position.copy()
        ahead = np.append(np.zeros(self.size), 1.0) if before is None else before
        matrix = np.column_stack([tangent, load])
        found = np.linalg.solve(np.vstack([matrix, ahead]), np.append(np.zeros(self.size), 1.0))
        direction = found / np.linalg.norm(found)
        sign = float(np.linalg.slogdet(np.vstack([matrix, direction]))[0])
        stable, unstable = self._stability(tangent)
        return PathState(scaled, factor, direction, ends, stable, unstable, sign, iterations)

    def _stability(self, tangent: FloatArray) -> tuple[bool, int]:
        """Whether the potential has a minimum, and the directions in which it falls."""
        if self.conservative:
            values = np.linalg.eigvalsh((tangent + tangent.T) / 2)
            unstable = max(int((values < 0).sum()) - self.held, 0)
            return unstable == 0, unstable
        sign = np.linalg.slogdet(tangent)[0] * (-1) ** self.held
        return bool(is_stable(tangent, self.held, False)), int(sign < 0)

    def ahead(self, here: PathState, length: float) -> PathState | None:
        """The equilibrium a step ahead, None where there is none near the tangent."""
        found = self.correct(here.here, here.at, here.direction, length)
        if found is None:
            return None
        drift = np.append(found[0], found[1]) - here.place - length * here.direction
        if np.linalg.norm(drift) > DRIFT * length:
            return None
        try:
            state = self.state(found[0], found[1], here.direction, found[2])
        except np.linalg.LinAlgError:
            return None
        return state if here.direction @ state.direction >= BEND else None

    def settled(self, before: PathState, beyond: PathState, factor: float) -> PathState:
        """The equilibrium at a load between two points."""
        share = (factor - before.at) / (beyond.at - before.at)
        near = before.here + share * (beyond.here - before.here)
        return self.state(self.settle(near, factor), factor, beyond.direction)

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
            if np.linalg.norm(change) < max(CLOSE * length, ROUNDING):
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
