"""Pressure moves rest strains: the map from pressures to strains of the unloaded rod."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.section.moments import Moments

__all__ = ["LinearResponse", "Response", "linear_response"]


class Response(Protocol):
    """Whatever turns pressures into the rest strains of a uniform, torsion-stiff rod.

    Examples
    --------
    >>> import beamopt
    >>> import numpy as np
    >>> response: beamopt.Response = beamopt.LinearResponse(np.eye(3))
    >>> response.strains(np.zeros((27, 3))).shape
    (27, 3)
    """

    def strains(self, pressures: FloatArray) -> FloatArray:
        """Strains (…, n, 3) = (ε, κ1, κ2) [1, 1/mm, 1/mm] at the pressures (n, 3) [kPa].

        ε = v3 − 1 is the stretch of the centroidal axis beyond 1, κ1 and κ2 are the curvatures
        u1, u2 about the grid's axes x and y (R' = R [u]×).
        """
        ...


@dataclass(frozen=True, eq=False)
class LinearResponse:
    """Rest strains proportional to pressure: (ε, κ1, κ2)ᵀ = B P.

    matrix : B (…, 3, 3) [1/kPa; 1/(mm·kPa) in rows 1 and 2], a column a supply; leading axes are
        a batch of sections.

    Examples
    --------
    >>> import beamopt
    >>> import numpy as np
    >>> response = beamopt.LinearResponse(np.eye(3) / 1000)
    >>> response.strains(np.array([[10.0, 0.0, 0.0]])).tolist()
    [[0.01, 0.0, 0.0]]
    """

    matrix: FloatArray

    def __repr__(self) -> str:
        return f"<LinearResponse: B {self.matrix.shape}>"

    def strains(self, pressures: FloatArray) -> FloatArray:
        """Strains (…, n, 3) at the pressures (n, 3) [kPa]; see `Response.strains`."""
        return np.asarray(np.einsum("...ij,nj->...ni", self.matrix, pressures))


def linear_response(moments: Moments, youngs_modulus: float) -> LinearResponse:
    """Response of a linear-elastic rod to chamber pressures.

    The loads f_p, l_p and end loads of the paper (Pressure loads) are the gradient of −Σ P_i V_i'
    with V_i' = A_i (v3 + (u × r_i)·e3); its balance with the elastic energy gives
    ε = Σ P_i A_i / (E A) and (κ1, κ2) = (E I)⁻¹ Σ P_i A_i (r_i × e3), r_i measured from the
    material centroid. Positive pressure stretches, and bends away from the chamber.

    Parameters
    ----------
    moments : of one section or a batch (…).
    youngs_modulus : E [kPa].

    Returns
    -------
    LinearResponse : with a matrix (…, 3, 3), NaN for a section without material.

    Examples
    --------
    >>> import beamopt
    >>> section = beamopt.optimize(beamopt.load_scene("random-section", ["search.generations=0"]))
    >>> beamopt.linear_response(section.best.moments, youngs_modulus=300.0).matrix.shape
    (3, 3)
    """
    (i11, i12), (_, i22) = np.moveaxis(moments.second_moments, (-2, -1), (0, 1))
    sx, sy = np.moveaxis(moments.chamber_first_moments, -1, 0)
    i11, i12, i22 = i11[..., None], i12[..., None], i22[..., None]
    with np.errstate(divide="ignore", invalid="ignore"):
        area = np.where(moments.area > 0, moments.area, np.nan)
        stretch = moments.chamber_areas / area[..., None]
        # (r × e3) = (y, −x): solve the symmetric 2 × 2 system I κ = (sy, −sx)
        determinant = i11 * i22 - i12 * i12
        bend_1 = (i22 * sy + i12 * sx) / determinant
        bend_2 = (-i12 * sy - i11 * sx) / determinant
    return LinearResponse(np.stack([stretch, bend_1, bend_2], axis=-2) / youngs_modulus)
