"""What the isotropic laws share: moduli, the choice of formulation, stress and stiffness."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.compiled import compiled
from beamopt.base.errors import InputError
from femcheck.material.stretch_range import StretchRange, stretch_range
from femcheck.material.tensors import invariants, inverse, log_ratio, subtract_products

__all__ = ["Isotropic", "Moduli", "require"]

MIXED_ABOVE = 0.45
"""Poisson's ratio above which displacements alone would lock and the mixed form is taken."""


class Moduli(NamedTuple):
    """C1 and C2 [kPa]: derivatives of W by I1 and I2 at rest; bend: the second by I1 there."""

    C1: float
    C2: float
    bend: float


def require(key: str, value: float, holds: bool, allowed: str) -> None:
    """Raise InputError unless the value is finite and `holds`."""
    if not (math.isfinite(value) and holds):
        raise InputError("", key, value, allowed)


@dataclass(frozen=True)
class Isotropic(ABC):
    """W = f(I1) + C2 (I2 − 3) − (2 C1 + 4 C2) ln J + Λ/2 (ln J)², C1 = f′(3), invariants of C.

    E and ν are those of small strains: μ = E/(2 (1 + ν)) = 2 (C1 + C2), and Λ is what
    λ = 2 μ ν/(1 − 2 ν) leaves, Λ = λ − 4 C2 − 4 f″(3). In the mixed form the last term is left to
    a pressure field, but for what Λ has more than λ.

    Parameters
    ----------
    youngs_modulus : E [kPa].
    poisson_ratio : ν, 0 … 0.5.
    mixed : whether in the mixed form; None takes it if ν > 0.45.

    Raises
    ------
    InputError (a ValueError) : a value that can not be used, with what is allowed.
    """

    youngs_modulus: float
    poisson_ratio: float = 0.5
    mixed: bool | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        E, nu = self.youngs_modulus, self.poisson_ratio
        require("youngs_modulus", E, E > 0, "above 0 kPa")
        require("poisson_ratio", nu, 0 <= nu <= 0.5, "0 … 0.5")
        self._check_shape()
        if self.volumetric_modulus < 0:
            taken = 4 * (self.moduli.C2 + self.moduli.bend)
            least = taken / (2 * (taken + self.shear_modulus))
            raise InputError("", "poisson_ratio", nu, f"{least:.4g} … 0.5 with these constants")
        if self.mixed is False and nu == 0.5:
            said = "an incompressible law (poisson_ratio = 0.5) takes the mixed form: True or none"
            raise InputError("", "mixed", self.mixed, said)
        if self.mixed and self.volumetric_modulus == self._spare_modulus:
            said = f"with poisson_ratio = {nu:g} there is no volumetric term to mix: False or none"
            raise InputError("", "mixed", self.mixed, said)

    @property
    @abstractmethod
    def name(self) -> str:
        """The name that files and reports use."""

    @property
    @abstractmethod
    def moduli(self) -> Moduli:
        """Derivatives of W at rest."""

    @property
    @abstractmethod
    def _symbols(self) -> str:
        """The energy without its volumetric term; the constants with their values."""

    @abstractmethod
    def _check_shape(self) -> None:
        """Refuse constants that can not be used."""

    @abstractmethod
    def _stretching(self, x: FloatArray) -> FloatArray:
        """The energy f (n,) by x = I1 − 3; NaN or ∞ where there is none."""

    @abstractmethod
    def _slopes(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """f′ and f″ (n,) by x = I1 − 3."""

    @property
    def shear_modulus(self) -> float:
        """μ [kPa]."""
        return self.youngs_modulus / (2 * (1 + self.poisson_ratio))

    @property
    def lame_modulus(self) -> float:
        """λ of small strains [kPa]; ∞ if incompressible."""
        gap = 1 - 2 * self.poisson_ratio
        return 2 * self.shear_modulus * self.poisson_ratio / gap if gap > 0 else math.inf

    @property
    def volumetric_modulus(self) -> float:
        """Λ [kPa], the factor of ½ (ln J)²; ∞ if incompressible."""
        return self.lame_modulus - 4 * (self.moduli.C2 + self.moduli.bend)

    @property
    def is_mixed(self) -> bool:
        """Whether a pressure field stands for the volumetric term."""
        return self.poisson_ratio > MIXED_ABOVE if self.mixed is None else self.mixed

    @property
    def volumetric_compliance(self) -> float | None:
        """Of the part of Λ that a pressure field stands for [1/kPa]; None in displacements alone.

        0 if incompressible.
        """
        return 1 / (self.volumetric_modulus - self._own_modulus) if self.is_mixed else None

    @cached_property
    def stretch_range(self) -> StretchRange:
        """Stretches up to which its responses rise at constant volume."""
        return stretch_range(self._slopes, self.moduli.C2)

    @property
    def most_stretch(self) -> float:
        """The largest principal stretch that it describes; ∞ where it describes all."""
        return self.stretch_range.least

    @property
    def text(self) -> str:
        """Energy with constants, treatment of volume, and range, as reports print them."""
        modulus, rises = self.volumetric_modulus, self.stretch_range.text
        end = f"; rises up to a stretch of {rises}" if rises else ""
        if math.isinf(modulus):
            return f"{self._symbols}; incompressible, mixed displacement–pressure{end}"
        how = "mixed displacement–pressure" if self.is_mixed else "displacements only"
        return f"{self._symbols}; Λ/2 (ln J)², Λ = {modulus:.4g} kPa, {how}{end}"

    def energy(self, C: FloatArray) -> FloatArray:
        """W (n,) [kPa] at C (n, 6); +∞ where the law has none."""
        x, y, log_ratio = invariants(C)
        with np.errstate(all="ignore"):
            W = self._stretching(x) + self.moduli.C2 * y - self._at_rest * log_ratio
            W += self._own_modulus / 2 * log_ratio**2
        return np.where(np.isnan(W), np.inf, W)

    def stress(self, C: FloatArray) -> FloatArray:
        """S (n, 6) [kPa]."""
        slope, _ = self._slopes(C[:, :3].sum(axis=1) - 3)
        S = np.empty_like(C)
        fill_stress(C, slope, self.moduli.C2, self._at_rest, self._own_modulus, S)
        return S

    def stiffness(self, C: FloatArray) -> FloatArray:
        """∂S/∂E (n, 6, 6) [kPa]."""
        _, bend = self._slopes(C[:, :3].sum(axis=1) - 3)
        D = np.empty((len(C), 6, 6))
        fill_stiffness(C, bend, self.moduli.C2, self._at_rest, self._own_modulus, D)
        return D

    @property
    def _at_rest(self) -> float:
        """2 C1 + 4 C2: what −ln J takes so that there is no stress at rest."""
        return 2 * self.moduli.C1 + 4 * self.moduli.C2

    @property
    def _own_modulus(self) -> float:
        """The part of Λ that the law has itself [kPa]: all of it, or in the mixed form little.

        With negative constants W without its volumetric term falls where the volume changes; as a
        pressure field keeps the volume in the mean only, what Λ has more than λ stays in the law.
        """
        return self._spare_modulus if self.is_mixed else self.volumetric_modulus

    @property
    def _spare_modulus(self) -> float:
        return max(0.0, -4 * (self.moduli.C2 + self.moduli.bend))


@compiled
def fill_stress(
    C: FloatArray, slope: FloatArray, C2: float, a: float, modulus: float, S: FloatArray
) -> None:
    """S (n, 6) = 2 f′ 1 + 2 C2 (I1 1 − C) + (Λ ln J − a) C⁻¹, slope f′ (n,)."""
    b = np.empty(6)
    for n in range(C.shape[0]):
        c, s = C[n], S[n]
        inverse(c, b)
        volumetric = (modulus * log_ratio(c) if modulus != 0.0 else 0.0) - a
        normal = 2.0 * slope[n]
        s[0] = normal + 2.0 * C2 * (c[1] + c[2]) + volumetric * b[0]
        s[1] = normal + 2.0 * C2 * (c[0] + c[2]) + volumetric * b[1]
        s[2] = normal + 2.0 * C2 * (c[0] + c[1]) + volumetric * b[2]
        for k in range(3, 6):
            s[k] = volumetric * b[k] - 2.0 * C2 * c[k]


@compiled
def fill_stiffness(
    C: FloatArray, bend: FloatArray, C2: float, a: float, modulus: float, D: FloatArray
) -> None:
    """D (n, 6, 6) = 4 f″ 1⊗1 + 4 C2 (1⊗1 − I) + Λ C⁻¹⊗C⁻¹ − (Λ ln J − a) (…), bend f″ (n,).

    I is the identity of symmetric tensors, the last bracket that of `subtract_products`.
    """
    b = np.empty(6)
    for n in range(C.shape[0]):
        c, d = C[n], D[n]
        inverse(c, b)
        volumetric = (modulus * log_ratio(c) if modulus != 0.0 else 0.0) - a
        for u in range(6):
            scaled = modulus * b[u]
            for v in range(u, 6):
                d[u, v] = scaled * b[v]
                d[v, u] = d[u, v]
        for u in range(3):
            for v in range(3):
                d[u, v] += 4.0 * bend[n] + (4.0 * C2 if u != v else 0.0)
            d[u + 3, u + 3] -= 2.0 * C2
        subtract_products(b, volumetric, d)
