"""What every hyperelastic law gives: energy, stress and stiffness from the right Cauchy–Green."""

from __future__ import annotations

from typing import Protocol

from beamopt.base.arrays import FloatArray

__all__ = ["Law"]


class Law(Protocol):
    """An energy W(C) per undeformed volume, axis 3 along the undeformed actuator.

    Symmetric tensors are stored as six numbers in the order 11, 22, 33, 12, 23, 13.

    Examples
    --------
    >>> import femcheck
    >>> import numpy as np
    >>> law: femcheck.Law = femcheck.law_by_name("neo-hookean", 300.0, 0.4)
    >>> law.stress(np.array([[1.0, 1.0, 1.0, 0.0, 0.0, 0.0]])).shape
    (1, 6)
    """

    @property
    def name(self) -> str:
        """The name that files and reports use."""
        ...

    @property
    def text(self) -> str:
        """The energy with its constants and how it treats volume, as reports print it."""
        ...

    @property
    def volumetric_compliance(self) -> float | None:
        """None if W is whole; else 1/Λ [1/kPa] of a two-field formulation, 0 if incompressible.

        Of a two-field formulation energy, stress and stiffness leave the volumetric term out: to
        them come p ln J − p²/(2Λ) with a pressure field p and its derivatives.
        """
        ...

    @property
    def most_stretch(self) -> float:
        """The largest principal stretch that it describes; ∞ where it describes all."""
        ...

    def energy(self, C: FloatArray) -> FloatArray:
        """W (n,) [kPa = mN mm/mm³] at C (n, 6)."""
        ...

    def stress(self, C: FloatArray) -> FloatArray:
        """Second Piola–Kirchhoff stress S = 2 ∂W/∂C (n, 6) [kPa]."""
        ...

    def stiffness(self, C: FloatArray) -> FloatArray:
        """∂S/∂E (n, 6, 6) [kPa] by (E11, E22, E33, 2 E12, 2 E23, 2 E13); symmetric."""
        ...
