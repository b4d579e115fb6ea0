"""The Mooney–Rivlin law: the second invariant softens in tension what the first stiffens."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from beamopt.base.arrays import FloatArray
from femcheck.material.isotropic import Isotropic, Moduli, require

__all__ = ["MooneyRivlin"]


@dataclass(frozen=True)
class MooneyRivlin(Isotropic):
    """W = C1 (I1 − 3) + C2 (I2 − 3) − (2 C1 + 4 C2) ln J + Λ/2 (ln J)², C1 + C2 = μ/2.

    More in `Isotropic`.

    Parameters
    ----------
    C2_share : C2/(C1 + C2); outside 0 … 1 it describes stretches up to `stretch_range`.
    """

    C2_share: float = field(kw_only=True)

    @property
    def name(self) -> str:
        """The name that files and reports use."""
        return "mooney-rivlin"

    @property
    def moduli(self) -> Moduli:
        """Derivatives of W at rest."""
        both = self.shear_modulus / 2
        return Moduli(C1=(1 - self.C2_share) * both, C2=self.C2_share * both, bend=0.0)

    @property
    def _symbols(self) -> str:
        C1, C2, _ = self.moduli
        energy = "C1 (I1 − 3) + C2 (I2 − 3) − (2 C1 + 4 C2) ln J"
        return f"{energy}, C1 = {C1:.4g} kPa, C2 = {C2:.4g} kPa"

    def _check_shape(self) -> None:
        require("C2_share", self.C2_share, True, "a finite number")

    def _stretching(self, x: FloatArray) -> FloatArray:
        return self.moduli.C1 * x

    def _slopes(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        return np.full_like(x, self.moduli.C1), np.zeros_like(x)
