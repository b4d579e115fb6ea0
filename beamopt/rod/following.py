"""From rest to full load step by step, where the direct way fails; and why it ends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from beamopt.arrays import FloatArray
from beamopt.rod.balance import reaction_of
from beamopt.rod.newton import CLOSE, FOUND, UNSTABLE, evaluate, largest_turn, newton
from beamopt.rod.packed import RodArrays, Stations
from beamopt.rod.shape import Shape
from beamopt.rod.status import RodStatus
from beamopt.rod.tangent import tangent_into

__all__ = ["Follower"]

FIRST_STEP = 0.25
SMALLEST_STEP = 2e-4  # of the full load
LARGEST_JUMP = 0.5  # rad that the iteration may turn the tip by beyond what was predicted
MOST_STEPS = 400
SOFT = 0.15  # of its stiffness at rest: a mode with less than this is critical
AT_WORK = 0.02  # cosine between critical mode and the load's change: more than this is work


@dataclass(frozen=True, eq=False)
class Follower:
    """One case of a rod. start, turn : (3,) see `newton.evaluate`."""

    rod: RodArrays
    at: Stations
    rest: FloatArray
    start: FloatArray
    turn: FloatArray
    conservative: bool
    shape: Shape

    def follow(self, unknowns: FloatArray) -> tuple[RodStatus, float, int]:
        """Let the load grow from nothing through stable equilibria.

        The last of them is left in `unknowns`; returns how it ended, the share of the load that was
        reached and the iterations that it took.
        """
        now, step, total = 0.0, FIRST_STEP, 0
        here, slope = np.zeros_like(unknowns), np.zeros_like(unknowns)
        beyond = FOUND
        for _ in range(MOST_STEPS):
            after = min(1.0, now + step)
            predicted = here + (after - now) * slope
            unknowns[:] = predicted
            ended, count = self._iterate(after, unknowns)
            total += count
            jump = largest_turn(self.at, unknowns - predicted, len(self.rod.free))
            if ended == FOUND and jump < LARGEST_JUMP:
                slope = (unknowns - here) / (after - now)
                here[:], now = unknowns, after
                step *= 2.0 if count <= 5 else 1.0
                if now == 1.0:
                    return RodStatus.CONVERGED, 1.0, total
            else:
                beyond = ended
                step *= 0.5
                if step < SMALLEST_STEP:
                    break
        unknowns[:] = here
        return self._why(now, unknowns, beyond == UNSTABLE), now, total

    def _iterate(self, factor: float, unknowns: FloatArray) -> tuple[int, int]:
        held = (self.rod, self.at, self.rest, self.start, self.turn, self.conservative)
        return newton(*held, False, CLOSE, factor, unknowns, self.shape)

    def _why(self, now: float, unknowns: FloatArray, unstable_beyond: bool) -> RodStatus:
        """What stopped the load: at a limit point the mode that softens does work with the load."""
        more, residual = (
            self._residual(now + SMALLEST_STEP, unknowns),
            self._residual(now, unknowns),
        )
        if not self.shape.stretch.min() > 0.0:
            return RodStatus.CRUSHED
        tangent = np.empty((unknowns.size, unknowns.size))
        reaction = reaction_of(self.rod, self.at, unknowns)
        tangent_into(self.rod, self.at, self.shape, now, reaction, tangent)
        if not np.isfinite(tangent).all():
            return RodStatus.DIVERGED
        moving = self._moving(tangent)
        held = moving.T @ (tangent + tangent.T)[: len(moving), : len(moving)] @ moving / 2
        self._residual(0.0, np.zeros_like(unknowns))
        tangent_into(self.rod, self.at, self.shape, 0.0, np.zeros(6), tangent)
        at_rest = moving.T @ (tangent + tangent.T)[: len(moving), : len(moving)] @ moving / 2
        values, modes = scipy.linalg.eigh(held, at_rest)
        softest = int(np.argmin(np.abs(values)))
        if abs(values[softest]) > SOFT:
            return RodStatus.STEPS_TOO_SMALL
        work, mode = moving.T @ (more - residual)[: len(moving)], modes[:, softest]
        size = float(np.linalg.norm(work) * np.linalg.norm(mode))
        cosine = abs(mode @ work) / max(size, 1e-300)
        if cosine > AT_WORK:
            return RodStatus.LIMIT_POINT
        return RodStatus.BUCKLED if unstable_beyond else RodStatus.STEPS_TOO_SMALL

    def _moving(self, tangent: FloatArray) -> FloatArray:
        """(k, k − held) what amplitudes and hinge can do while the tip is held, in columns."""
        held = 3 * (len(self.rod.held_position) + len(self.rod.held_rotation))
        free = len(tangent) - held
        if not held:
            return np.eye(free)
        return np.asarray(scipy.linalg.null_space(tangent[free:, :free]))

    def _residual(self, factor: float, unknowns: FloatArray) -> FloatArray:
        out = np.empty(unknowns.size)
        held = (self.rod, self.at, self.rest, self.start, self.turn)
        evaluate(*held, factor, unknowns, self.shape, out)
        return out
