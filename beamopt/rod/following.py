"""From rest to full load step by step, where the direct way fails; and why it ends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from beamopt.base.arrays import FloatArray
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
SAME_STATE = 1e-4  # rad
SAME_WAY = 0.5  # cosine between the path's tangents at both ends of a step, at least
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
        beyond, direction = FOUND, self._onwards(0.0, here)
        for _ in range(MOST_STEPS):
            after = min(1.0, now + step)
            predicted = here + (after - now) * slope
            unknowns[:] = predicted
            ended, count = self._iterate(after, unknowns)
            total += count
            jump = largest_turn(self.rod, self.at, unknowns - predicted)
            if ended == FOUND and now > 0.0 and not self._leads_back(unknowns, now, here):
                ended = UNSTABLE  # it snapped: shallow arches hardly turn
            onwards = self._onwards(after, unknowns) if ended == FOUND else direction
            if ended == FOUND and jump < LARGEST_JUMP and onwards @ direction < SAME_WAY:
                ended = UNSTABLE  # the mirror image of where a bent path leads, or beyond its bend
            if ended == FOUND and jump < LARGEST_JUMP:
                slope, direction = (unknowns - here) / (after - now), onwards
                here[:], now = unknowns, after
                step *= 2.0 if count <= 5 else 1.0
                if now == 1.0:
                    self._residual(now, unknowns)  # the shape of the last one
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

    def _onwards(self, factor: float, unknowns: FloatArray) -> FloatArray:
        """Unit tangent of the path in (angles, share of the load); the load alone if singular."""
        moving = self.at.basis.shape[1] * len(self.rod.free) + len(self.rod.hinge)
        load = self._residual(factor + SMALLEST_STEP, unknowns) - self._residual(factor, unknowns)
        tangent = self._tangent(factor, unknowns)
        try:
            change = -np.linalg.solve(tangent, load / SMALLEST_STEP)[:moving]
        except np.linalg.LinAlgError:
            return np.append(np.zeros(moving), 1.0)
        change[: moving - len(self.rod.hinge)] *= self.at.step.sum()
        direction = np.append(change, 1.0)
        return np.asarray(direction / np.linalg.norm(direction))

    def _leads_back(self, unknowns: FloatArray, before: float, there: FloatArray) -> bool:
        """Whether the iteration from a state finds the equilibrium at the load before it."""
        back = unknowns.copy()
        ended, _ = self._iterate(before, back)
        turned = largest_turn(self.rod, self.at, back - there)
        return ended == FOUND and turned < SAME_STATE

    def _why(self, now: float, unknowns: FloatArray, unstable_beyond: bool) -> RodStatus:
        """What stopped the load: at a limit point the mode that softens does work with the load.

        The softest mode is that in which a given moment bends most: the largest singular value of
        Lᵀ (T⁻¹) L, where T is the tangent, with its multipliers, and L Lᵀ the stiffness at rest.
        """
        self._residual(min(1.0, now + 2 * SMALLEST_STEP), unknowns)
        if not self.shape.stretch.min() > 0.0:
            return RodStatus.CRUSHED
        work = self._residual(now + SMALLEST_STEP, unknowns) - self._residual(now, unknowns)
        tangent = self._tangent(now, unknowns)
        if not np.isfinite(tangent).all():
            return RodStatus.DIVERGED
        root = self._root_of_stiffness(unknowns.size)
        moving = len(root)
        inverse = np.linalg.pinv(tangent, rcond=1e-15)[:moving, :moving]
        _, sizes, modes = np.linalg.svd(root.T @ inverse @ root)
        if sizes[0] * SOFT < 1:
            return RodStatus.STEPS_TOO_SMALL
        works = np.linalg.solve(root, work[:moving])
        if abs(modes[0] @ works) > AT_WORK * np.linalg.norm(works):
            return RodStatus.LIMIT_POINT
        return RodStatus.BUCKLED if unstable_beyond else RodStatus.STEPS_TOO_SMALL

    def _root_of_stiffness(self, size: int) -> FloatArray:
        """L, lower, of the stiffness L Lᵀ at rest; a hinge gets that of the rod's own bending."""
        modes = self.at.basis.shape[1] * len(self.rod.free)
        moving = modes + len(self.rod.hinge)
        self._residual(0.0, np.zeros(size))
        tangent = self._tangent(0.0, np.zeros(size))[:moving, :moving]
        bending = np.abs(self.rod.bending[:, self.rod.free, self.rod.free]).max()
        tangent[modes:], tangent[:, modes:] = 0.0, 0.0
        tangent[range(modes, moving), range(modes, moving)] = bending / self.at.step.sum()
        return np.asarray(np.linalg.cholesky((tangent + tangent.T) / 2))

    def _tangent(self, factor: float, unknowns: FloatArray) -> FloatArray:
        """(n, n) at the shape of the last residual."""
        out = np.empty((unknowns.size, unknowns.size))
        reaction = reaction_of(self.rod, self.at, unknowns)
        tangent_into(self.rod, self.at, self.shape, factor, reaction, out)
        return out

    def _residual(self, factor: float, unknowns: FloatArray) -> FloatArray:
        out = np.empty(unknowns.size)
        held = (self.rod, self.at, self.rest, self.start, self.turn)
        evaluate(*held, factor, unknowns, self.shape, out)
        return out
