"""Yeoh's law: a cubic in the first invariant, the usual fit of silicones."""

from __future__ import annotations

from dataclasses import dataclass, field

from beamopt.base.arrays import FloatArray
from femcheck.material.isotropic import Isotropic, Moduli, require

__all__ = ["Yeoh"]


@dataclass(frozen=True)
class Yeoh(Isotropic):
    """W = Σ Cᵢ (I1 − 3)ⁱ − 2 C1 ln J + Λ/2 (ln J)², i = 1, 2, 3, C1 = μ/2. More in `Isotropic`.

    Yeoh, Rubber Chemistry and Technology 66 (1993) 754.

    Parameters
    ----------
    C2_ratio, C3_ratio : C2/C1 and C3/C1; where one is negative it describes stretches up to
        `stretch_range`, if there is an end.
    """

    C2_ratio: float = field(kw_only=True)
    C3_ratio: float = field(kw_only=True)

    @property
    def name(self) -> str:
        """The name that files and reports use."""
        return "yeoh"

    @property
    def moduli(self) -> Moduli:
        """Derivatives of W at rest."""
        C1 = self.shear_modulus / 2
        return Moduli(C1=C1, C2=0.0, bend=2 * self.C2_ratio * C1)

    @property
    def _symbols(self) -> str:
        C1 = self.moduli.C1
        constants = f"C1 = {C1:.4g} kPa, C2 = {self.C2_ratio * C1:.4g} kPa"
        energy = "C1 (I1 − 3) + C2 (I1 − 3)² + C3 (I1 − 3)³ − 2 C1 ln J"
        return f"{energy}, {constants}, C3 = {self.C3_ratio * C1:.4g} kPa"

    def _check_shape(self) -> None:
        for name in ("C2_ratio", "C3_ratio"):
            require(name, getattr(self, name), True, "a finite number")

    def _stretching(self, x: FloatArray) -> FloatArray:
        return self.moduli.C1 * x * (1 + x * (self.C2_ratio + x * self.C3_ratio))

    def _slopes(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        C1, second, third = self.moduli.C1, self.C2_ratio, self.C3_ratio
        slope = C1 * (1 + x * (2 * second + x * 3 * third))
        return slope, C1 * (2 * second + 6 * third * x)
