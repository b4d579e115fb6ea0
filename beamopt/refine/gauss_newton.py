"""Levenberg-Marquardt on the positions of feature points, each step judged on the true section."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.judge.judge import Judge
from beamopt.refine.edges import moment_slopes
from beamopt.refine.orbits import Orbits
from beamopt.refine.sensitivity import moment_sizes, residual_of, residual_slopes
from beamopt.refine.truth import Judged, Truth

__all__ = ["DescentLimits", "Linearised", "descend", "linearised"]

DAMPING, TRIES, HARDER, EASIER = 1e-4, 5, 8.0, 5.0
SHAKES, SHAKE = 8, 0.5  # tries with other positions of the same moments; of a row's height
FARTHEST = 0.04  # of the outer radius, that a point goes in one step
SLACK = 0.1  # by which the neighbour ratio may grow at a time
SETTLED = 1e-3  # a loss this share above the linear model's least is as good as it gets


@dataclass(frozen=True, slots=True)
class DescentLimits:
    """How far a descent may go.

    evaluations : most sections judged. second : most K [mm²] that may be given in exchange for L.
    good_enough : a loss [mm²] at which there is nothing more to do.
    """

    evaluations: int
    second: float
    good_enough: float = 0.0


@dataclass(frozen=True, eq=False)
class Linearised:
    """The loss near a section, |residual + slopes · moved|².

    residual (rows,) [mm]. slopes (rows, 24) by the raw moments, each over its size.
    shape (2 g, 24) : change of the raw moments, over their sizes, by the generators' places [1/mm].
    """

    residual: FloatArray
    slopes: FloatArray
    shape: FloatArray

    def step(self, damping: float) -> FloatArray:
        """(g, 2) the step that minimises |residual + slopes · shapeᵀ d|² + μ |d|² [mm].

        d = −S (JᵀJ SᵀS + μ 1)⁻¹ Jᵀ r: twenty-four unknowns, however many points. μ is `damping`
        times the trace of JᵀJ SᵀS. No step where moving points changes nothing.
        """
        system = self.slopes.T @ self.slopes @ (self.shape.T @ self.shape)
        trace = np.trace(system)
        if not trace > 0:
            return np.zeros((len(self.shape) // 2, 2))
        system[np.diag_indices(24)] += damping * trace
        moved = np.linalg.solve(system, self.slopes.T @ self.residual)
        return np.asarray(-(self.shape @ moved).reshape(-1, 2))

    def least(self) -> float:
        """The loss [mm²] that the linear model says steps of any size can reach."""
        jacobian = self.slopes @ self.shape.T
        moved = np.linalg.lstsq(jacobian, self.residual, rcond=1e-6)[0]
        return float(((self.residual - jacobian @ moved) ** 2).sum())

    def unfelt(self, noise: FloatArray) -> FloatArray:
        """What of a step (g, 2) leaves all moments as they are, to first order."""
        flat = noise.reshape(-1)
        felt = np.linalg.lstsq(self.shape.T @ self.shape, self.shape.T @ flat, rcond=1e-9)[0]
        return np.asarray((flat - self.shape @ felt).reshape(-1, 2))


def linearised(judge: Judge, judged: Judged, orbits: Orbits) -> Linearised:
    """The loss near a section; walls and rounded corners are taken to move along."""
    sizes = np.tile(moment_sizes(judge.grid, judged.section.moments), 4)
    shape = orbits.gathered(moment_slopes(judge.grid, judged.points, judge.rules.skin))
    slopes = residual_slopes(judge, judged).reshape(-1, 24) * sizes
    return Linearised(
        residual_of(judged.aim, judged.answers), slopes, shape.reshape(-1, 24) / sizes
    )


def descend(
    judge: Judge,
    truth: Truth,
    start: Judged,
    orbits: Orbits,
    limits: DescentLimits,
    rng: np.random.Generator,
) -> tuple[Judged, int, bool]:
    """Move points until the loss falls no more.

    A step counts only where the true section's loss falls and its K stays below what it was at
    first by a little; where that alone holds it up, by a little more, up to `limits.second`.

    Returns
    -------
    The section with the lowest loss, sections judged, and whether it settled: at what the linear
    model says is the least, or at `good_enough`.
    """
    best, judged, damping = start, 0, DAMPING
    slack = SLACK * judge.neighbour_weight
    second = min(start.verdict.K + slack, limits.second)
    farthest = FARTHEST * judge.grid.outer_radius
    shaken = SHAKE * (judge.grid.outer_radius - judge.grid.inner_radius) / judge.grid.radial
    while judged < limits.evaluations and best.loss > limits.good_enough:
        model = linearised(judge, best, orbits)
        blocked, found = False, None
        for trial in range(TRIES + SHAKES):
            if judged >= limits.evaluations:
                break
            step = model.step(damping)
            if trial >= TRIES:
                step = step + model.unfelt(rng.normal(0.0, shaken, step.shape))
            step *= min(1.0, farthest / max(float(np.abs(step).max()), 1e-300))
            tried = truth(orbits.moved(best.points, step))
            judged += 1
            if tried.loss < best.loss:
                if second >= tried.verdict.K:
                    found = tried
                    break
                blocked = True
            if trial < TRIES - 1:
                damping *= HARDER
            elif trial == TRIES - 1:
                damping = DAMPING
        if found is not None:
            best, damping = found, max(damping / EASIER, 1e-9)
        elif blocked and second < limits.second:
            second = min(second + slack, limits.second)
        else:
            break
    return best, judged, _settled(judge, best, orbits, limits)


def _settled(judge: Judge, best: Judged, orbits: Orbits, limits: DescentLimits) -> bool:
    if best.loss <= limits.good_enough:
        return True
    least = linearised(judge, best, orbits).least() + best.verdict.R
    return best.loss <= (1 + SETTLED) * least + limits.good_enough
