"""Areas, first and second moments of a section, summed exactly over its elements."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from beamopt.compiled import compiled
from beamopt.section.grid import FloatArray, PolarGrid
from beamopt.section.raster import LabelArray

__all__ = ["Moments", "moments_of", "sum_moments"]


@dataclass(frozen=True, eq=False)
class Moments:
    """Moments of one section, or of a batch of them along leading axes.

    Parameters
    ----------
    raw : (…, 4, 6) integrals of {1, x, y, x², y², xy} over the area of each type (0 material,
        1…3 supply) about the grid's axis [mm², mm³, mm⁴].
    """

    raw: FloatArray

    @property
    def area(self) -> FloatArray:
        """(…,) material area A [mm²]."""
        return np.asarray(self.raw[..., 0, 0])

    @property
    def centroid(self) -> FloatArray:
        """(…, 2) material centroid c from the grid's axis [mm]; NaN where there is no material."""
        with np.errstate(invalid="ignore"):
            return np.asarray(self.raw[..., 0, 1:3] / self.area[..., None])

    @property
    def second_moments(self) -> FloatArray:
        """(…, 2, 2) second moments of area about the material centroid [mm⁴].

        I11 = ∫ y² dA, I22 = ∫ x² dA, I12 = I21 = −∫ xy dA, x and y from the centroid (Steiner): the
        matrix that takes a curvature (κ1, κ2) about the axes x and y to a bending moment, over E.
        """
        x, y = np.moveaxis(self.centroid, -1, 0)
        sums = self.raw[..., 0, :]
        ixx = sums[..., 4] - self.area * y * y
        iyy = sums[..., 3] - self.area * x * x
        ixy = sums[..., 5] - self.area * x * y
        return np.stack([np.stack([ixx, -ixy], -1), np.stack([-ixy, iyy], -1)], -2)

    @property
    def chamber_areas(self) -> FloatArray:
        """(…, 3) area A_i of each supply's chambers [mm²]."""
        return np.asarray(self.raw[..., 1:, 0])

    @property
    def chamber_first_moments(self) -> FloatArray:
        """(…, 3, 2) first moments A_i r_i of the chambers, r_i from the material centroid [mm³]."""
        shift = self.chamber_areas[..., None] * self.centroid[..., None, :]
        return np.asarray(self.raw[..., 1:, 1:3] - shift)

    @property
    def principal(self) -> tuple[FloatArray, FloatArray]:
        """Principal second moments I1 ≤ I2 (…, 2) [mm⁴] and their axes (…, 2, 2), in columns."""
        values, axes = np.linalg.eigh(self.second_moments)
        return values, axes


def moments_of(grid: PolarGrid, labels: LabelArray) -> Moments:
    """Moments of the section whose element types are `labels` (radial, angular)."""
    raw = np.zeros((4, 6))
    sum_moments(labels, grid.radial_integrals, grid.angular_integrals, raw)
    return Moments(raw)


POWER = np.array([0, 1, 1, 2, 2, 2])
"""Which radial integral belongs to each of {1, x, y, x², y², xy}."""


@compiled
def sum_moments(
    labels: NDArray[np.uint8], radial: FloatArray, angular: FloatArray, raw: FloatArray
) -> None:
    """Add each element's moments to `raw` (4, 6).

    An element's integrals are a radial one times an angular one, and the angular ones telescope
    along a run of equal elements: only the runs' ends are visited.
    """
    rows, columns = labels.shape
    for i in range(rows):
        row = labels[i]
        first = 0
        for j in range(1, columns + 1):
            if j == columns or row[j] != row[first]:
                t = row[first]
                for m in range(6):
                    raw[t, m] += radial[POWER[m], i] * (angular[m, j] - angular[m, first])
                first = j
