"""A thread that pulls and does not push."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from beamopt.base.arrays import FloatArray

__all__ = ["Thread"]


@dataclass(frozen=True, slots=True)
class Thread:
    """Energy k ψ(e) of a strain e = λ − 1, per area of the surface that is wound.

    ψ'' is 0 for e ≤ 0, rises linearly to 1 over the toe t, and stays there: slack in compression,
    two times continuously differentiable, and beyond the toe a spring that is t/2 too long.

    Parameters
    ----------
    stiffness : k [N/m], the same as mN/mm: axial stiffness E A of the thread [N] times the turns
        per metre along the axis.
    toe : t, a strain.

    Raises
    ------
    ValueError : a stiffness or toe that is not positive.

    Examples
    --------
    >>> import femcheck
    >>> femcheck.Thread(stiffness=2e4).toe
    0.004
    """

    stiffness: float
    toe: float = 4e-3

    def __post_init__(self) -> None:
        for name in ("stiffness", "toe"):
            value = getattr(self, name)
            if not 0 < value < np.inf:
                raise ValueError(f"{name} = {value}: must be above 0")

    def energy(self, strain: FloatArray) -> FloatArray:
        """K ψ [mN mm/mm²]."""
        within, t = np.clip(strain, 0, self.toe), self.toe
        beyond = np.maximum(strain - t, 0)
        energy = within**3 / (6 * t) + beyond * t / 2 + beyond**2 / 2
        return np.asarray(self.stiffness * energy)

    def tension(self, strain: FloatArray) -> FloatArray:
        """K ψ' [mN/mm]: the force per undeformed length along the axis."""
        within, beyond = np.clip(strain, 0, self.toe), np.maximum(strain - self.toe, 0)
        return np.asarray(self.stiffness * (within**2 / (2 * self.toe) + beyond))

    def slope(self, strain: FloatArray) -> FloatArray:
        """K ψ'' [mN/mm]."""
        return np.asarray(self.stiffness * np.clip(strain / self.toe, 0, 1))
