"""Sections that are their own images: mirrored, or turned by a third with the supplies in turn."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray, LabelArray
from beamopt.section.cell_owners import NEAR
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid

__all__ = ["Image", "Symmetry", "mirror_symmetry", "threefold_symmetry"]

Image = tuple[FloatArray, LabelArray]
"""A matrix (2, 2) for places, and the type (4,) that each type becomes."""

ROUNDING = 1e-10  # of the first part's angle; what rounding does to an image must not bring it back


@dataclass(frozen=True, eq=False)
class Symmetry:
    """A group of images that a section is to be equal to.

    Parameters
    ----------
    images : the identity first; together they form a group.
    start : angle where the first part begins, of as many equal ones as there are images [rad].
    """

    images: tuple[Image, ...]
    start: float = 0.0

    def generators(self, points: FeaturePoints) -> FeaturePoints:
        """Those of `points` that the others are made from: the ones in the first part.

        Points in the place of an image of theirs (on the mirror line, on the axis) are left out:
        their cell would be shared by types that differ.
        """
        keep = self._in_first_part(points) & ~self._fixed(points)
        return FeaturePoints(points.x[keep], points.y[keep], points.type[keep])

    def expanded(self, generators: FeaturePoints) -> FeaturePoints:
        """All points of a symmetric section: the generators, then their images, image by image."""
        parts = [self._image(generators, image) for image in self.images]
        return FeaturePoints(
            *(np.concatenate([getattr(p, name) for p in parts]) for name in ("x", "y", "type"))
        )

    def symmetrised(self, points: FeaturePoints) -> FeaturePoints:
        """The symmetric section that has the first part of `points`; the same if done again."""
        return self.expanded(self.generators(points))

    def folded(self, points: FeaturePoints) -> FeaturePoints:
        """Every point's image in the first part: as many generators as `points`, evenly spread."""
        x, y, types = points.x.copy(), points.y.copy(), points.type.copy()
        for image in self.images:
            moved = self._image(points, image)
            there = self._in_first_part(moved)
            for kept, new in ((x, moved.x), (y, moved.y), (types, moved.type)):
                kept[there] = new[there]
        return FeaturePoints(x, y, types)

    @cached_property
    def part(self) -> float:
        """Angle of the first part [rad]."""
        return 2 * np.pi / len(self.images)

    def _in_first_part(self, points: FeaturePoints) -> NDArray[np.bool_]:
        turned = np.mod(points.angles - self.start, 2 * np.pi)
        which = np.floor(turned / self.part + ROUNDING)
        return np.asarray(np.mod(which, len(self.images)) == 0)

    def _fixed(self, points: FeaturePoints) -> NDArray[np.bool_]:
        fixed = np.zeros(len(points), dtype=np.bool_)
        for image in self.images[1:]:
            moved = self._image(points, image)
            fixed |= np.hypot(moved.x - points.x, moved.y - points.y) <= NEAR
        return fixed

    def _image(self, points: FeaturePoints, image: Image) -> FeaturePoints:
        matrix, types = image
        x, y = matrix @ np.stack([points.x, points.y])
        return FeaturePoints(x, y, types[points.type])


def mirror_symmetry() -> Symmetry:
    """Mirrored about the x axis: supply 1 becomes itself, 2 and 3 each other; y > 0 is kept."""
    return Symmetry((_identity(), (np.diag([1.0, -1.0]), _types(1, 3, 2))))


def threefold_symmetry(grid: PolarGrid) -> Symmetry:
    """Turned by ±120° about the axis, supply 1 → 2 → 3 → 1; the first third from start is kept."""
    c, s = -0.5, np.sqrt(0.75)
    turn = np.array([[c, -s], [s, c]])
    images = (_identity(), (turn, _types(2, 3, 1)), (turn.T.copy(), _types(3, 1, 2)))
    return Symmetry(images, float(np.radians(grid.start)))


def _identity() -> Image:
    return np.eye(2), _types(1, 2, 3)


def _types(one: int, two: int, three: int) -> LabelArray:
    return np.array([0, one, two, three], dtype=np.uint8)
