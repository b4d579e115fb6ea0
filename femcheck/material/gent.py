"""Gent's law: chains that can be stretched so far and no farther."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from beamopt.base.arrays import FloatArray
from femcheck.material.isotropic import Isotropic, Moduli, require

__all__ = ["Gent"]


@dataclass(frozen=True)
class Gent(Isotropic):
    """W = −μ Jm/2 ln(1 − (I1 − 3)/Jm) − μ ln J + Λ/2 (ln J)². More in `Isotropic`.

    Gent, Rubber Chemistry and Technology 69 (1996) 59.

    Parameters
    ----------
    Jm : the value of I1 − 3 that is never reached.
    """

    Jm: float = field(kw_only=True)

    @property
    def name(self) -> str:
        """The name that files and reports use."""
        return "gent"

    @property
    def moduli(self) -> Moduli:
        """Derivatives of W at rest."""
        return Moduli(C1=self.shear_modulus / 2, C2=0.0, bend=self.shear_modulus / 2 / self.Jm)

    @property
    def _symbols(self) -> str:
        constants = f"μ = {self.shear_modulus:.4g} kPa, Jm = {self.Jm:.4g}"
        return f"−μ Jm/2 ln(1 − (I1 − 3)/Jm) − μ ln J, {constants}"

    def _check_shape(self) -> None:
        require("Jm", self.Jm, self.Jm > 0, "above 0")

    def _stretching(self, x: FloatArray) -> FloatArray:
        energy: FloatArray = -self.moduli.C1 * self.Jm * np.log1p(-x / self.Jm)
        return energy

    def _slopes(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        left = np.where(x < self.Jm, 1 - x / self.Jm, np.nan)
        slope = self.moduli.C1 / left
        return slope, slope / (left * self.Jm)
