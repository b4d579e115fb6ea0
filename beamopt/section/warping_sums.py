"""What the Saint-Venant solves of a section leave behind, and its stiffnesses from that."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from beamopt.base.arrays import FloatArray

__all__ = ["WarpingSums"]


@dataclass(frozen=True, eq=False)
class WarpingSums:
    """Integrals over the section of its three unit stress fields τ_0, τ_1, τ_2.

    τ_0 = ∇ω − (y, −x) is torsion at unit twist over G; τ_1 and τ_2 are the shear that balances a
    bending stress growing as x or y along the beam, ∇·τ_j = −x_j.

    Parameters
    ----------
    gram : (3, 3) ∫ τ_a·τ_b dA [mm⁴, mm⁵, mm⁶].
    warping : (2,) ∫ ω (x, y) dA, (x, y) from the centroid of the piece [mm⁵].
    second : (2, 2) ∫ (x, y)⊗(x, y) dA from the centroids of the pieces [mm⁴].
    pole : (2,) axis that ω turns about, from the material centroid [mm].
    """

    gram: FloatArray
    warping: FloatArray
    second: FloatArray
    pole: FloatArray

    @property
    def torsion_constant(self) -> float:
        """I_T = ∫ τ_0·τ_0 dA [mm⁴]."""
        return float(self.gram[0, 0])

    @property
    def shear_compliance(self) -> FloatArray:
        """(2, 2) ∫ τ_i·τ_j dA of the shear without torsion, orthogonal to τ_0 [mm⁶]."""
        coupling = self.gram[0, 1:]
        return np.asarray(self.gram[1:, 1:] - np.outer(coupling, coupling) / self.gram[0, 0])

    def shear_area(self, compliance: FloatArray) -> FloatArray:
        """(2, 2) κA [mm²]: n = second · k is the force of unit shears k, its energy k·U k / 2G."""
        area = self.second @ np.linalg.inv(compliance) @ self.second
        return np.asarray((area + area.T) / 2)

    def shear_centre(self, warping: FloatArray) -> FloatArray:
        """(2,) pole about which twisting bends nothing, from the material centroid [mm] (Trefftz).

        About the pole p the warping is ω + p_x y − p_y x; its moments with x and y have to vanish.
        """
        return np.asarray(self.pole + TURN @ np.linalg.solve(self.second, warping))


TURN = np.array([[0.0, -1.0], [1.0, 0.0]])
