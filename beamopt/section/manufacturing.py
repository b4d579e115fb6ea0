"""What is asked of a section beside its tips: separate chambers, symmetry, mass."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray
from beamopt.section.phenotype import Phenotypes
from beamopt.section.symmetry import Symmetry

__all__ = ["FREE", "MakingRules"]


@dataclass(frozen=True, eq=False)
class MakingRules:
    """Questions of a judge to a section beside its tips.

    chambers : the most separate chambers of each supply; None for any number.
    rejects : whether a section with more of them is rejected, instead of weighed.
    chamber_weight : of each chamber too many [mm²].
    symmetry, symmetry_weight : images, and the weight of the share that differs from them [mm²].
    grams : of the actuator for each mm² of its section's material.
    mass_weight : of each gram [mm²].
    counts : whether chambers are counted even where no rule needs it.
    """

    chambers: tuple[int, int, int] | None = None
    rejects: bool = True
    chamber_weight: float = 0.0
    symmetry: Symmetry | None = None
    symmetry_weight: float = 0.0
    grams: float = 0.0
    mass_weight: float = 0.0
    counts: bool = False

    @property
    def counts_chambers(self) -> bool:
        """True if chambers have to be counted."""
        return self.counts or self.chambers is not None

    @property
    def weighs(self) -> bool:
        """Whether R can be anything but 0."""
        by_chambers = self.chambers is not None and not self.rejects
        return by_chambers or self.symmetry is not None or self.mass_weight > 0

    def counting(self) -> MakingRules:
        """The same rules, with chambers counted in any case."""
        return replace(self, counts=True)

    def chambers_too_many(self, measured: Phenotypes) -> NDArray[np.int64]:
        """(n,) separate chambers beyond what is allowed, over all supplies."""
        if self.chambers is None:
            return np.zeros(len(measured.neighbour_ratio), dtype=np.int64)
        beyond = np.maximum(measured.chambers - np.array(self.chambers), 0)
        return np.asarray(beyond.sum(axis=1))

    def rejected(self, measured: Phenotypes) -> NDArray[np.bool_]:
        """(n,) whether a section has more chambers than it may have at all."""
        return np.asarray((self.chambers_too_many(measured) > 0) & self.rejects)

    def weighted(self, measured: Phenotypes) -> FloatArray:
        """(n,) R, what the weighted rules add to the total loss [mm²]."""
        R = self.mass_weight * self.mass(measured)
        if not self.rejects:
            R = R + self.chamber_weight * self.chambers_too_many(measured)
        if self.symmetry is not None:
            R = R + self.symmetry_weight * measured.asymmetry
        return R

    def mass(self, measured: Phenotypes) -> FloatArray:
        """(n,) mass of the actuator, density times material area times length [g]."""
        return self.grams * measured.moments.area


FREE = MakingRules()
"""No rule: every section will do."""
