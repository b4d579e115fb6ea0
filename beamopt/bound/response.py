"""The least loss over all response matrices: nine numbers that decide a whole workspace."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.bound.fit import ArcFit
from beamopt.bound.wanted import Wanted

__all__ = ["ResponseBound", "arc_strains", "response_bound"]

SEED = 0xB0D
PERTURBED = (0.1, 0.1, 0.2, 0.2, 0.4, 0.4, 0.7, 0.7, 1.0, 1.0)  # rad and stretch, at full pressure
LARGEST_TURN = 1.9 * np.pi  # beyond, a tip says nothing about the stretch


@dataclass(frozen=True, eq=False)
class ResponseBound:
    """The lowest L that was found over all response matrices; numerical, not proven.

    It is the lowest of local minima from a dozen starts: global only as far as these find it.

    matrix : B (3, 3) [1/kPa; 1/(mm·kPa) in rows 1 and 2].
    loss : L [mm²].
    starts : (k,) L [mm²] where each start ended, in the order of the starts.
    tips : (n, 3) the ideal tips [mm]. distances : (n,) of them from the wanted ones [mm].
    """

    matrix: FloatArray
    loss: float
    starts: FloatArray
    tips: FloatArray
    distances: FloatArray

    @property
    def agreeing(self) -> int:
        """Starts that ended within a millionth of the lowest L (and of 10⁻⁹ mm²)."""
        return int((self.starts <= self.loss * (1 + 1e-6) + 1e-9).sum())

    def rms_distance(self, wanted: Wanted) -> float:
        """√(L/Σ w) [mm]."""
        return float(np.sqrt(self.loss / wanted.weights.sum()))


def response_bound(wanted: Wanted) -> ResponseBound:
    """Minimise L(B) = Σ w_j |h(B P_j) − t_j|² over all 3 × 3 matrices B.

    Starts: the matrix that fits the strains of each wanted tip by itself (`arc_strains`), no
    response at all, and seeded perturbations of the first; always the same ones.
    """
    fit = ArcFit(
        wanted.pressures / wanted.largest_pressure,
        wanted.tips / wanted.length,
        wanted.weights,
        wanted.curvature * wanted.length,
    )
    found, _ = fit.solve(_starts(fit))
    scale = np.array([1.0, 1 / wanted.length, 1 / wanted.length])[:, None]
    matrices = found * scale / wanted.largest_pressure
    losses = np.array([wanted.loss_of(matrix) for matrix in matrices])
    best = int(losses.argmin())
    tips = wanted.tips_of(matrices[best])
    distances = np.linalg.norm(tips - wanted.tips, axis=1)
    return ResponseBound(matrices[best], float(losses[best]), losses, tips, distances)


def arc_strains(tips: FloatArray) -> FloatArray:
    """(…, 3) strains (ε, κ1 H, κ2 H) of the arcs that end at tips (…, 3) [H].

    The chord to the tip leans by half the turn: tan(θ/2) = ρ/z, and its length is
    (1 + ε) sin(θ/2)/(θ/2). Turns are cut at 1.9 π, where the chord vanishes.
    """
    x, y, z = np.moveaxis(tips, -1, 0)
    across = np.hypot(x, y)
    turn = np.minimum(2 * np.arctan2(across, z), LARGEST_TURN)
    stretch = np.linalg.norm(tips, axis=-1) / np.sinc(turn / (2 * np.pi)) - 1
    share = np.divide(turn, across, out=np.zeros_like(turn), where=across > 0)
    return np.stack([stretch, -share * y, share * x], axis=-1)


def _starts(fit: ArcFit) -> FloatArray:
    strains = arc_strains(fit.tips)
    strains[:, 1:] -= fit.rest
    root = np.sqrt(fit.weights)[:, None]
    fitted = np.linalg.lstsq(root * fit.parameters, root * strains, rcond=None)[0].T
    rng = np.random.default_rng(SEED)
    sizes = np.array(PERTURBED)[:, None, None]
    perturbed = fitted + sizes * rng.standard_normal((len(PERTURBED), 3, 3))
    return np.concatenate([fitted[None], np.zeros((1, 3, 3)), perturbed])
