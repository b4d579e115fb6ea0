"""Stress and stiffness of W = f(I1) + C2 (I2 − 3) − a ln J + Λ/2 (ln J)², point by point."""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.compiled import compiled
from femcheck.material.tensors import inverse, log_ratio, subtract_products

__all__ = ["fill_stiffness", "fill_stress"]


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
