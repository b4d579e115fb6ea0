"""Areas, first and second moments of a section, summed exactly over its elements."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray, IndexArray, LabelArray
from beamopt.base.compiled import compiled
from beamopt.section.grid import PolarGrid
from beamopt.section.runs import Runs, runs_of_row

__all__ = ["Moments", "moments_of", "sum_and_find_runs", "sum_moments"]


@dataclass(frozen=True, eq=False)
class Moments:
    """Moments of one section, or of a batch of them along leading axes.

    Parameters
    ----------
    raw : (…, 4, 6) integrals of {1, x, y, x², y², xy} over the area of each type (0 material,
        1…3 supply) about the grid's axis [mm², mm³, mm⁴].

    Examples
    --------
    >>> import beamopt
    >>> half = beamopt.FeaturePoints([15.0, -15.0], [0.0, 0.0], [1, 0])
    >>> section = beamopt.CrossSection.from_points(beamopt.PolarGrid(), half)
    >>> moments: beamopt.Moments = section.moments
    >>> moments
    <Moments: material 824.7 mm², chambers 824.7, 0, 0 mm²>
    """

    raw: FloatArray

    def __repr__(self) -> str:
        if self.raw.ndim > 2:
            return f"<Moments: a batch {self.raw.shape[:-2]}>"
        areas = ", ".join(f"{area:.4g}" for area in self.chamber_areas)
        return f"<Moments: material {self.area:.4g} mm², chambers {areas} mm²>"

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
    def is_stiff(self) -> NDArray[np.bool_]:
        """(…,) whether there is material, and enough of it for a positive bending stiffness."""
        (i11, i12), (_, i22) = np.moveaxis(self.second_moments, (-2, -1), (0, 1))
        return np.asarray((self.area > 0) & (i11 > 0) & (i11 * i22 > i12 * i12))

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


@compiled
def sum_moments(
    labels: LabelArray | IndexArray, radial: FloatArray, angular: FloatArray, raw: FloatArray
) -> None:
    """Add each element's moments to `raw` (4, 6)."""
    runs = Runs(np.empty(labels.size, dtype=np.int64), np.zeros(len(labels) + 1, dtype=np.int64))
    sum_and_find_runs(labels, runs, radial, angular, raw)


@compiled
def sum_and_find_runs(
    labels: LabelArray | IndexArray,
    runs: Runs,
    radial: FloatArray,
    angular: FloatArray,
    raw: FloatArray,
) -> None:
    """Add each element's moments to `raw` (4, 6), and write the section's runs to `runs`.

    An element's integrals are a radial one times an angular one, and the angular ones telescope
    along a run of equal elements: only the runs' ends count.
    """
    n = 0
    for i in range(labels.shape[0]):
        row, begin = labels[i], n
        n = runs_of_row(row, runs.ends, begin)
        runs.begin[i] = begin
        r1, r2, r3 = radial[0, i], radial[1, i], radial[2, i]
        first = 0
        for end in runs.ends[begin:n]:
            sums, b, a = raw[row[first]], angular[end], angular[first]
            sums[0] += r1 * (b[0] - a[0])
            sums[1] += r2 * (b[1] - a[1])
            sums[2] += r2 * (b[2] - a[2])
            sums[3] += r3 * (b[3] - a[3])
            sums[4] += r3 * (b[4] - a[4])
            sums[5] += r3 * (b[5] - a[5])
            first = end
    runs.begin[labels.shape[0]] = n
