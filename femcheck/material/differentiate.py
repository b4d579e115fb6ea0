"""Whether stress and stiffness are the derivatives of an energy, by differences."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from beamopt.base.arrays import FloatArray
from femcheck.material.volumetric import add_pressure, add_pressure_stiffness, volume_ratio_log

__all__ = ["Differentiable", "PressureTerm", "differences", "random_deformations"]

PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))
STEP = 1e-5
"""Of strain: truncation and rounding both leave some 10⁻¹⁰ of the derivative."""


class Differentiable(Protocol):
    """The part of a law that is differentiated."""

    def energy(self, C: FloatArray) -> FloatArray:
        """W (n,)."""
        ...

    def stress(self, C: FloatArray) -> FloatArray:
        """∂W/∂E (n, 6)."""
        ...

    def stiffness(self, C: FloatArray) -> FloatArray:
        """∂S/∂E (n, 6, 6)."""
        ...


@dataclass(frozen=True, eq=False)
class PressureTerm:
    """The volumetric term p ln J of a two-field formulation, differentiated at a fixed p.

    p : (n,) [kPa].
    """

    p: FloatArray

    def energy(self, C: FloatArray) -> FloatArray:
        """P ln J (n,)."""
        return self.p * volume_ratio_log(C)

    def stress(self, C: FloatArray) -> FloatArray:
        """Its derivative by E (n, 6)."""
        S = np.zeros_like(C)
        add_pressure(C, self.p, S)
        return S

    def stiffness(self, C: FloatArray) -> FloatArray:
        """Its second derivative by E (n, 6, 6)."""
        D = np.zeros((*C.shape, 6))
        add_pressure_stiffness(C, self.p, D)
        return D


def differences(law: Differentiable, C: FloatArray) -> tuple[float, float]:
    """Largest errors of stress against energy and of stiffness against stress, at C (n, 6).

    Both are shares: of the largest stress, and of the largest stiffness, at all of C. NaN where a
    law gives NaN.
    """
    S, D = law.stress(C), law.stiffness(C)
    by_energy = np.stack([_slope(law.energy, C, place) for place in range(6)], axis=1)
    by_stress = np.stack([_slope(law.stress, C, place) for place in range(6)], axis=2)
    return _share(S, by_energy), max(_share(D, by_stress), _share(D, np.swapaxes(D, 1, 2)))


def random_deformations(count: int, seed: int) -> FloatArray:
    """C (n, 6) of random deformation gradients, some of them large, none turned inside out."""
    F = np.eye(3) + np.random.default_rng(seed).uniform(-0.25, 0.25, (count, 3, 3))
    C = np.swapaxes(F, 1, 2) @ F
    return np.stack([C[:, i, j] for i, j in PAIRS], axis=1)


def _slope(function: Callable[[FloatArray], FloatArray], C: FloatArray, place: int) -> FloatArray:
    """Derivative by E, or by 2 E of a shear: δC is 2 δE of a normal strain, δ(2 E) of a shear."""
    step = STEP * np.eye(6)[place] * (2 if place < 3 else 1)
    slope: FloatArray = (function(C + step) - function(C - step)) / (2 * STEP)
    return slope


def _share(values: FloatArray, by_differences: FloatArray) -> float:
    return float(np.abs(values - by_differences).max() / np.abs(values).max())
