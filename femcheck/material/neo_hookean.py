"""The neo-Hookean law: rubber at moderate stretches, nothing but E and ν."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from beamopt.base.arrays import FloatArray
from femcheck.material.isotropic import Isotropic, Moduli

__all__ = ["NeoHookean"]


@dataclass(frozen=True)
class NeoHookean(Isotropic):
    """W = μ/2 (I1 − 3 − 2 ln J) + Λ/2 (ln J)²; here Λ = λ. More in `Isotropic`."""

    @property
    def name(self) -> str:
        """The name that files and reports use."""
        return "neo-hookean"

    @property
    def moduli(self) -> Moduli:
        """Derivatives of W at rest."""
        return Moduli(C1=self.shear_modulus / 2, C2=0.0, bend=0.0)

    @property
    def _symbols(self) -> str:
        return f"μ/2 (I1 − 3 − 2 ln J), μ = {self.shear_modulus:.4g} kPa"

    def _check_shape(self) -> None:
        pass

    def _stretching(self, x: FloatArray) -> FloatArray:
        return self.moduli.C1 * x

    def _slopes(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        return np.full_like(x, self.moduli.C1), np.zeros_like(x)
