"""Closed forms of inflated incompressible neo-Hookean tubes and spheres, W = μ/2 (I1 − 3).

λa and λb are the hoop stretches of the inner and outer surface, A and B their radii at rest.
"""

from __future__ import annotations

import numpy as np

__all__ = ["closed_tube_limit", "sphere_pressure", "tube_pressure"]


def tube_pressure(ratio: float, stretch: float) -> float:
    """P/μ = ln(λa/λb) + ½ (1/λb² − 1/λa²) of a tube in plane strain, b² = B² + a² − A²."""
    outer = np.sqrt(1 + (stretch**2 - 1) / ratio**2)
    return float(np.log(stretch / outer) + (outer**-2 - stretch**-2) / 2)


def sphere_pressure(ratio: float, stretch: float) -> float:
    """P/μ = (2/λb + 1/(2 λb⁴)) − (2/λa + 1/(2 λa⁴)) of a sphere, b³ = B³ + a³ − A³."""
    outer = (1 + (stretch**3 - 1) / ratio**3) ** (1 / 3)
    return float(2 / outer + outer**-4 / 2 - 2 / stretch - stretch**-4 / 2)


def closed_tube_limit(ratio: float) -> float:
    """Largest P/μ of a tube with closed ends that is free along its axis.

    With r² = a² + (R² − A²)/λz the stretches are r/R, R/(λz r) and λz. Equilibrium of the wall
    gives P = ∫ (σθ − σr)/r dr; that of the tube, axial force P π a², ∫ (2 σz − σr − σθ) r dr = 0,
    which determines λz for each a. Gauss's rule with 40 points is exact to rounding.
    """
    from scipy.optimize import brentq, minimize_scalar

    at, weight = np.polynomial.legendre.leggauss(40)
    R = 1 + (ratio - 1) * (at + 1) / 2
    dR = weight * (ratio - 1) / 2

    def squares(a: float, axial: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        r2 = a**2 + (R**2 - 1) / axial
        return r2, r2 / R**2, R**2 / (axial**2 * r2)

    def axial_force(axial: float, a: float) -> float:
        _, hoop, radial = squares(a, axial)
        return float(((2 * axial**2 - radial - hoop) * R) @ dR)

    def pressure(a: float) -> float:
        axial = float(brentq(axial_force, 0.5, 5.0, args=(a,), xtol=1e-14))
        r2, hoop, radial = squares(a, axial)
        return float(((hoop - radial) * R / (axial * r2)) @ dR)

    found = minimize_scalar(lambda a: -pressure(a), bounds=(1.1, 3.0), options={"xatol": 1e-9})
    return -float(found.fun)
