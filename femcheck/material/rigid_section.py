"""The law with the beam's own assumptions: sections that stay rigid in their plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from beamopt.base.arrays import FloatArray

__all__ = ["RigidSection"]


@dataclass(frozen=True)
class RigidSection:
    """W = E/2 (λ3 − 1)² + G/2 (C13² + C23²) + cE/8 [(C11 − 1)² + (C22 − 1)² + 2 C12²], λ3 = √C33.

    Fibres along the axis follow Hooke's law without Poisson's effect, and a penalty c keeps the
    section from deforming in its plane: a solid of it converges to the beam as c grows. It is a
    check of an implementation, not a material.

    Parameters
    ----------
    youngs_modulus : E [kPa].
    penalty : c, 10³…10⁴.
    shear_modulus : G [kPa]; cE/2 if left out. Under pressure alone the beam does not depend on it,
        and a small one lets the section crease locally.

    Raises
    ------
    ValueError : a modulus or penalty that is not positive.

    Examples
    --------
    >>> import femcheck
    >>> femcheck.RigidSection(youngs_modulus=300.0, penalty=1000.0).name
    'rigid-section'
    """

    youngs_modulus: float
    penalty: float
    shear_modulus: float | None = None

    def __post_init__(self) -> None:
        for name in ("youngs_modulus", "penalty", "shear_modulus"):
            value = getattr(self, name)
            if value is not None and not 0 < value < np.inf:
                raise ValueError(f"{name} = {value}: must be above 0")

    @property
    def name(self) -> str:
        """The name that files and reports use."""
        return "rigid-section"

    @property
    def text(self) -> str:
        """The energy with its constants, as reports print it."""
        return (
            "E/2 (λ3 − 1)² + G/2 (C13² + C23²) + cE/8 [(C11 − 1)² + (C22 − 1)² + 2 C12²], "
            f"λ3 = √C33, E = {self.youngs_modulus:g} kPa, G = {self.rigidity:g} kPa, "
            f"c = {self.penalty:g}; volume is free, displacements only"
        )

    @property
    def most_stretch(self) -> float:
        """∞: it is no material."""
        return np.inf

    @property
    def volumetric_compliance(self) -> None:
        """None: the energy is whole."""
        return

    @property
    def rigidity(self) -> float:
        """G [kPa]: the shear modulus, given or cE/2."""
        given = self.shear_modulus
        return self.penalty * self.youngs_modulus / 2 if given is None else given

    def energy(self, C: FloatArray) -> FloatArray:
        """W (n,) [kPa] at C (n, 6)."""
        E, cE = self.youngs_modulus, self.penalty * self.youngs_modulus
        stretch = np.sqrt(C[:, 2])
        plane = (C[:, 0] - 1) ** 2 + (C[:, 1] - 1) ** 2 + 2 * C[:, 3] ** 2
        shear = C[:, 4] ** 2 + C[:, 5] ** 2
        return np.asarray(E / 2 * (stretch - 1) ** 2 + self.rigidity / 2 * shear + cE / 8 * plane)

    def stress(self, C: FloatArray) -> FloatArray:
        """S (n, 6) [kPa]."""
        E, cE = self.youngs_modulus, self.penalty * self.youngs_modulus
        S = np.empty_like(C)
        S[:, :2] = cE / 2 * (C[:, :2] - 1)
        S[:, 2] = E * (1 - 1 / np.sqrt(C[:, 2]))
        S[:, 3] = cE / 2 * C[:, 3]
        S[:, 4:] = self.rigidity * C[:, 4:]
        return S

    def stiffness(self, C: FloatArray) -> FloatArray:
        """∂S/∂E (n, 6, 6) [kPa]."""
        E, cE = self.youngs_modulus, self.penalty * self.youngs_modulus
        D = np.zeros((len(C), 6, 6))
        D[:, 0, 0] = D[:, 1, 1] = cE
        D[:, 2, 2] = E * C[:, 2] ** -1.5
        D[:, 3, 3] = cE / 2
        D[:, 4, 4] = D[:, 5, 5] = self.rigidity
        return D
