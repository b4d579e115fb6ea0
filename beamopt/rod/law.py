"""What a section answers with: moment and strain as functions of curvature and force."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.section.moments import Moments

__all__ = ["SectionLaw", "cross", "poissons_ratio", "section_law"]


@dataclass(frozen=True, eq=False)
class SectionLaw:
    """A linear elastic section in the form that also holds where it is rigid.

    With Δu = u − u*, local moment m and local force n (Cosserat; Simo & Vu-Quoc 1986):

        m = bending · Δu + coupling · n
        v = v* + compliance · n − couplingᵀ · Δu

    This is the 6×6 stiffness [[J, S], [Sᵀ, K]] half inverted: compliance = K⁻¹,
    coupling = S K⁻¹, bending = J − S K⁻¹ Sᵀ. A rod that neither shears nor stretches has no K, but
    a compliance of zero.

    Parameters
    ----------
    bending : (3, 3) [mN·mm²], symmetric; rows of curvatures that are not free are not read.
    compliance : (3, 3) [1/mN], symmetric and not negative.
    coupling : (3, 3) [mm], of axes that are not the centroid's or the shear centre's.
    free : the curvatures that may differ from those at rest: 0 and 1 bend, 2 twists.
    """

    bending: FloatArray
    compliance: FloatArray
    coupling: FloatArray
    free: tuple[int, ...] = (0, 1)

    def turned(self, angle: float) -> SectionLaw:
        """The law of the section turned about its axis by an angle [rad]."""
        if angle == 0.0:
            return self
        cosine, sine = np.cos(angle), np.sin(angle)
        turn = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
        bending, compliance, coupling = (
            turn @ part @ turn.T for part in (self.bending, self.compliance, self.coupling)
        )
        return SectionLaw(bending, compliance, coupling, self.free)

    def about(self, axis: FloatArray) -> SectionLaw:
        """The law about an axis from which this one's axis is seen at (x, y) = `axis` [mm].

        v of the new axis is v − u × (x, y, 0); that goes for the rest strains as well.
        """
        return replace(self, coupling=self.coupling + cross(np.array([*axis, 0.0])))


def cross(vector: FloatArray) -> FloatArray:
    """(3, 3) matrix [a]× with [a]× b = a × b."""
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def poissons_ratio(youngs_modulus: float, shear_modulus: float) -> float:
    """ν of E and G [kPa], as far as an isotropic material can have it: 0 … 0.5."""
    return min(max(youngs_modulus / (2 * shear_modulus) - 1, 0.0), 0.5)


def section_law(
    moments: Moments,
    youngs_modulus: float,
    shear_modulus: float,
    *,
    torsion_constant: float | None = None,
    shear_area: FloatArray | None = None,
    shear_centre: FloatArray | None = None,
) -> SectionLaw:
    """The law about the material centroid, with K = diag(κGA, κGA, EA), J = diag(EI, G I_T).

    Parameters
    ----------
    moments : of one section.
    youngs_modulus, shear_modulus : E, G [kPa].
    torsion_constant : I_T [mm⁴]; None for a section that does not twist, as in the paper.
    shear_area : (2, 2) κA [mm²]; None for κ = 1, as in the paper.
    shear_centre : (2,) from the centroid [mm]; None for the centroid itself. A transverse force
        there bends without twist: m3 = G I_T Δu3 + (e3 × a)·n.
    """
    area = float(moments.area)
    bending = np.zeros((3, 3))
    bending[:2, :2] = youngs_modulus * moments.second_moments
    compliance = np.zeros((3, 3))
    shear = area * np.eye(2) if shear_area is None else shear_area
    compliance[:2, :2] = np.linalg.inv(shear_modulus * shear)
    compliance[2, 2] = 1 / (youngs_modulus * area)
    coupling = np.zeros((3, 3))
    if torsion_constant is None:
        return SectionLaw(bending, compliance, coupling)
    bending[2, 2] = shear_modulus * torsion_constant
    if shear_centre is not None:
        coupling[2, :2] = -shear_centre[1], shear_centre[0]
    return SectionLaw(bending, compliance, coupling, (0, 1, 2))
