"""A cross-section as everything above the section floor sees it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from beamopt.base.arrays import LabelArray
from beamopt.section.cell_owners import points_with_cells
from beamopt.section.drawing import Shape, rasterise
from beamopt.section.feature_points import MATERIAL, SUPPLIES, FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.moments import Moments, moments_of
from beamopt.section.pieces import Pieces, count_pieces
from beamopt.section.raster import raster
from beamopt.section.seal import UNSEALED, SealRules
from beamopt.section.sealing import seal_drawing, seal_points
from beamopt.section.walls import add_walls, wall_steps

__all__ = ["CrossSection"]


@dataclass(frozen=True, eq=False)
class CrossSection:
    """A grid and the type of each of its elements, walls included.

    labels : (radial, angular) 0 material, 1…3 chamber of that supply; copied.

    Raises
    ------
    ValueError : labels of another shape or type, or `wall_elements` that can not be halved.

    Examples
    --------
    >>> import beamopt
    >>> half = beamopt.FeaturePoints([15.0, -15.0], [0.0, 0.0], [1, 0])
    >>> beamopt.CrossSection.from_points(beamopt.PolarGrid(), half)
    <CrossSection: 128 × 360 elements, material 824.7 mm², chambers 824.7 mm²>
    """

    grid: PolarGrid
    labels: LabelArray

    def __post_init__(self) -> None:
        if self.labels.shape != self.grid.shape:
            raise ValueError(f"labels have shape {self.labels.shape}, the grid {self.grid.shape}")
        if not np.isin(self.labels, (MATERIAL, *SUPPLIES)).all():
            raise ValueError("labels: 0 (material) or 1, 2, 3 (supply)")
        labels = np.array(self.labels, dtype=np.uint8)
        labels.setflags(write=False)
        object.__setattr__(self, "labels", labels)

    def __repr__(self) -> str:
        area, chambers = float(self.moments.area), self.moments.chamber_areas.sum()
        rows, columns = self.grid.shape
        return (
            f"<CrossSection: {rows} × {columns} elements, material {area:.4g} mm², "
            f"chambers {chambers:.4g} mm²>"
        )

    @classmethod
    def from_points(
        cls,
        grid: PolarGrid,
        points: FeaturePoints,
        wall_elements: int = 4,
        rules: SealRules = UNSEALED,
    ) -> CrossSection:
        """The Voronoi section of feature points, walled between supplies, or sealed."""
        points = points_with_cells(grid, points)
        if rules != UNSEALED:
            return cls(grid, seal_points(grid, points, wall_steps(wall_elements, rules), rules))
        return cls(grid, _walled(grid, raster(grid, points), wall_elements))

    @classmethod
    def from_drawing(
        cls,
        grid: PolarGrid,
        shapes: Sequence[Shape],
        wall_elements: int = 4,
        rules: SealRules = UNSEALED,
    ) -> CrossSection:
        """The section of drawn chambers, walled between supplies, or sealed."""
        if rules != UNSEALED:
            return cls(grid, seal_drawing(grid, shapes, wall_steps(wall_elements, rules), rules))
        return cls(grid, _walled(grid, rasterise(grid, shapes), wall_elements))

    @cached_property
    def moments(self) -> Moments:
        """Areas, centroid, second moments."""
        return moments_of(self.grid, self.labels)

    @cached_property
    def pieces(self) -> Pieces:
        """Connected pieces of material and of chambers."""
        return count_pieces(self.grid, self.labels)


def _walled(grid: PolarGrid, labels: LabelArray, wall_elements: int) -> LabelArray:
    add_walls(labels, wall_steps(wall_elements, UNSEALED), grid.is_full_ring)
    return labels
