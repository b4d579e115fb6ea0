"""Tips of a solid beside those of the beam."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray
from femcheck.solved.subject import Subject

__all__ = ["STILL", "BesideBeam"]

SMALLEST_DISPLACEMENT = 1e-2  # of the largest one: below it a share says nothing
STILL = 1e-9  # mm


class BesideBeam(ABC):
    """What follows from a subject and the solid's tips at its 27 pressure combinations."""

    subject: Subject

    @property
    @abstractmethod
    def solid_tips(self) -> FloatArray:
        """(27, 3) of the solid [mm]; NaN without an answer."""

    @property
    def is_loaded(self) -> NDArray[np.bool_]:
        """(27,) whether any supply has pressure."""
        return np.asarray(self.subject.pressures.any(axis=1))

    @property
    def displacement(self) -> FloatArray:
        """(27,) of the beam's tip [mm]."""
        straight = np.array([0, 0, self.subject.design.actuator.length])
        return np.asarray(np.linalg.norm(self.subject.beam_tips - straight, axis=1))

    @property
    def difference(self) -> FloatArray:
        """(27,) between the beam's tip and the solid's [mm]; NaN without an answer."""
        return np.asarray(np.linalg.norm(self.solid_tips - self.subject.beam_tips, axis=1))

    @property
    def share(self) -> FloatArray:
        """(27,) difference over the beam's displacement, or a hundredth of the largest one."""
        return np.asarray(self.difference / self._moved)

    @property
    def _moved(self) -> FloatArray:
        least = max(SMALLEST_DISPLACEMENT * float(self.displacement.max()), STILL)
        return np.asarray(np.maximum(self.displacement, least))

    @property
    def unanswered(self) -> int:
        """Loaded combinations without an answer."""
        return int((np.isnan(self.solid_tips[:, 0]) & self.is_loaded).sum())

    @property
    def worst(self) -> float:
        """Largest share over the loaded combinations with an answer; NaN without any."""
        shares = self._answered()
        return float(shares.max()) if shares.size else float("nan")

    @property
    def median(self) -> float:
        """Median share over the loaded combinations with an answer; NaN without any."""
        shares = self._answered()
        return float(np.median(shares)) if shares.size else float("nan")

    def _answered(self) -> FloatArray:
        return np.asarray(self.share[self.is_loaded & ~np.isnan(self.share)])
