"""The volumetric term p ln J that a two-field formulation adds to a law, with its derivatives."""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.compiled import compiled
from femcheck.material.tensors import inverse, log_ratio, subtract_products

__all__ = ["add_pressure", "add_pressure_stiffness", "volume_ratio_log"]


@compiled
def volume_ratio_log(C: FloatArray) -> FloatArray:
    """Ln J (n,) of C (n, 6); −∞ where det C ≤ 0.

    C does not tell J from −J: whether an element is turned inside out, only F says.
    """
    found = np.empty(C.shape[0])
    for n in range(C.shape[0]):
        found[n] = log_ratio(C[n])
    return found


@compiled
def add_pressure(C: FloatArray, p: FloatArray, S: FloatArray) -> None:
    """Add p C⁻¹ to S (n, 6) [kPa], p (n,) [kPa]: the derivative of p ln J by E."""
    b = np.empty(6)
    for n in range(C.shape[0]):
        inverse(C[n], b)
        for k in range(6):
            S[n, k] += p[n] * b[k]


@compiled
def add_pressure_stiffness(C: FloatArray, p: FloatArray, D: FloatArray) -> None:
    """Take p (C⁻¹ᵢₖ C⁻¹ⱼₗ + C⁻¹ᵢₗ C⁻¹ⱼₖ) from D (n, 6, 6) [kPa]: the derivative of p C⁻¹ by E."""
    b = np.empty(6)
    for n in range(C.shape[0]):
        inverse(C[n], b)
        subtract_products(b, p[n], D[n])
