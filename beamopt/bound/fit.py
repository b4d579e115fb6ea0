"""Least squares of arcs' tips: from many starts at once, by Levenberg and Marquardt's method."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.rod.arc import arc_tip_jacobian, arc_tips

__all__ = ["ArcFit"]

MOST_STEPS = 300
STALLED = 1e-13  # share of the sum by which a step must lower it, or its start has ended
EXACT = 1e-26  # a mean square of residuals, over H², that is rounding alone
LEAST_DAMPING, MOST_DAMPING = 1e-12, 1e8


@dataclass(frozen=True, eq=False)
class ArcFit:
    """Tips of arcs whose strains are linear in unknowns, against wanted ones; without units.

    parameters : (n, m) t of each row: strains are X t + rest, with unknowns X (3, m).
    tips : (n, 3) wanted, over H. weights : (n,).
    rest : (2,) turns at rest κ1 H, κ2 H [rad]. Strains are (ε, κ1 H, κ2 H).
    """

    parameters: FloatArray
    tips: FloatArray
    weights: FloatArray
    rest: FloatArray

    def strains(self, unknowns: FloatArray) -> FloatArray:
        """(…, n, 3) strains of unknowns (…, 3, m)."""
        strains = np.einsum("...im,nm->...ni", unknowns, self.parameters)
        strains[..., 1:] += self.rest
        return np.asarray(strains)

    def loss(self, unknowns: FloatArray) -> FloatArray:
        """(…,) Σ w |h − t|²/H² of unknowns (…, 3, m)."""
        away = arc_tips(self.strains(unknowns), 1.0) - self.tips
        return np.asarray(np.einsum("n,...nx,...nx->...", self.weights, away, away))

    def solve(self, starts: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Unknowns (k, 3, m) where the iteration ends from starts (k, 3, m), and losses (k,).

        Each start has its own damping and ends by itself: where its steps no longer lower the sum.
        """
        found, losses = starts.copy(), self.loss(starts)
        damping = np.full(len(starts), 1e-3)
        running = np.arange(len(starts))
        exact = EXACT * float(self.weights.sum())
        for _ in range(MOST_STEPS):
            trial = found[running] + self._steps(found[running], damping[running])
            before = losses[running]
            with np.errstate(over="ignore", invalid="ignore"):  # a step may lead anywhere
                loss = self.loss(trial)
                better = loss < before  # false for one that is not finite
                ended = better & (before - loss <= STALLED * before)
            found[running[better]], losses[running[better]] = trial[better], loss[better]
            factor = np.where(better, 0.2, 5.0)
            damping[running] = np.maximum(damping[running] * factor, LEAST_DAMPING)
            ended |= (damping[running] > MOST_DAMPING) | (losses[running] <= exact)
            running = running[~ended]
            if not running.size:
                break
        return found, losses

    def _steps(self, unknowns: FloatArray, damping: FloatArray) -> FloatArray:
        strains = self.strains(unknowns)
        root = np.sqrt(self.weights)[:, None]
        away = root * (arc_tips(strains, 1.0) - self.tips)
        by_strain = root[..., None] * arc_tip_jacobian(strains, 1.0)
        count = unknowns.shape[1] * unknowns.shape[2]
        slopes = np.einsum("knxi,nm->knxim", by_strain, self.parameters)
        slopes = slopes.reshape(len(unknowns), -1, count)
        normal = slopes.swapaxes(1, 2) @ slopes
        gradient = (slopes.swapaxes(1, 2) @ away.reshape(len(unknowns), -1, 1))[..., 0]
        diagonal = np.einsum("kii->ki", normal)
        # unknowns that no row depends on keep a small part of the others' weight, and do not move
        floor = 1e-9 * diagonal.max(axis=1, keepdims=True) + 1e-300
        normal = normal + (damping[:, None] * np.maximum(diagonal, floor))[..., None] * np.eye(
            count
        )
        normal += (1e-12 * floor)[..., None] * np.eye(count)
        step = np.linalg.solve(normal, -gradient[..., None])[..., 0]
        return np.asarray(step.reshape(unknowns.shape))
