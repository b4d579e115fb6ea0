"""The limit pressure of a long tube with closed ends, by quadrature: a witness of the map."""

from __future__ import annotations

import numpy as np

__all__ = ["closed_tube_limit"]

POINTS = 40  # Gauss's; the integrands are smooth, so that is exact to rounding


def closed_tube_limit(inner_radius: float, outer_radius: float, shear_modulus: float) -> float:
    """Largest pressure [kPa] of an incompressible neo-Hookean tube, free along its axis.

    A particle at R moves to r with r² = a² + (R² − A²)/λ; its stretches are r/R around, R/(λ r)
    through the wall and λ along. Balance of the wall gives P = ∫ (σ_around − σ_through)/r dr, that
    of the ends λ, by ∫ (2 σ_along − σ_through − σ_around) r dr = 0. The largest P over the deformed
    inner radius a is the limit.
    """
    from scipy.optimize import brentq, minimize_scalar

    A, B = inner_radius, outer_radius
    place, weight = np.polynomial.legendre.leggauss(POINTS)
    R = (A + B) / 2 + (B - A) / 2 * place
    dR = (B - A) / 2 * weight

    def out_of_balance(along: float, a: float) -> float:
        r2 = a**2 + (R**2 - A**2) / along
        return float(((2 * along**2 - r2 / R**2 - R**2 / (along**2 * r2)) * R) @ dR)

    def pressure(a: float) -> float:
        along = float(brentq(out_of_balance, 0.2, 10.0, args=(a,), xtol=1e-13))
        r2 = a**2 + (R**2 - A**2) / along
        return float(((r2 / R**2 - R**2 / (along**2 * r2)) * R / (along * r2)) @ dR)

    bounds = (1.02 * A, 4 * A)
    found = minimize_scalar(lambda a: -pressure(a), bounds=bounds, options={"xatol": 1e-9 * A})
    return -shear_modulus * float(found.fun)
