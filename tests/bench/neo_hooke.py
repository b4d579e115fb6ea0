"""A law that FElupe has too, so that assembly is compared on the same one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from beamopt.arrays import FloatArray

PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))


@dataclass(frozen=True)
class NeoHooke:
    """W = μ/2 (tr C − 3) − μ ln J + λ/2 (ln J)²; FElupe's NeoHookeCompressible.

    mu, lmbda : Lamé's constants [kPa].
    """

    mu: float = 100.0
    lmbda: float = 1000.0

    @property
    def name(self) -> str:
        return "neo-Hooke"

    def energy(self, C: FloatArray) -> FloatArray:
        _, log_J = _inverse(C)
        trace = C[:, :3].sum(axis=1)
        return np.asarray(self.mu / 2 * (trace - 3) - self.mu * log_J + self.lmbda / 2 * log_J**2)

    def stress(self, C: FloatArray) -> FloatArray:
        """S = μ (1 − C⁻¹) + λ ln J C⁻¹."""
        B, log_J = _inverse(C)
        S = (self.lmbda * log_J - self.mu)[:, None] * B
        S[:, :3] += self.mu
        return S

    def stiffness(self, C: FloatArray) -> FloatArray:
        """λ C⁻¹ ⊗ C⁻¹ + (μ − λ ln J) (C⁻¹ᵢₖ C⁻¹ⱼₗ + C⁻¹ᵢₗ C⁻¹ⱼₖ)."""
        B, log_J = _inverse(C)
        shear = self.mu - self.lmbda * log_J
        D = self.lmbda * B[:, :, None] * B[:, None, :]
        full = B[:, [0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(-1, 3, 3)
        for u, (i, j) in enumerate(PAIRS):
            for v, (k, m) in enumerate(PAIRS[u:], u):
                more = full[:, i, k] * full[:, j, m] + full[:, i, m] * full[:, j, k]
                D[:, u, v] += shear * more
                D[:, v, u] = D[:, u, v]
        return D


def _inverse(C: FloatArray) -> tuple[FloatArray, FloatArray]:
    """C⁻¹ (n, 6) and ln J (n,)."""
    a, b, c, d, e, f = C.T
    minors = [b * c - e * e, a * c - f * f, a * b - d * d, e * f - d * c, d * f - a * e]
    minors.append(d * e - b * f)
    determinant = a * minors[0] + d * minors[3] + f * minors[5]
    return np.stack(minors, axis=1) / determinant[:, None], np.log(determinant) / 2
