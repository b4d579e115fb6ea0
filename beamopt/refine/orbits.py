"""Feature points that move and flip together: each alone, or with its images under a symmetry."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from beamopt.section.cell_owners import distinct, first_of_places
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.symmetry import Symmetry

__all__ = ["Orbits", "orbits_of", "with_cells"]

STAYS = 5e5  # mm; points farther away are not moved


class Orbits(NamedTuple):
    """Which feature points go together.

    members (g, images) : feature points of each orbit, the generator first.
    generator, image (n,) : whose orbit a feature point is in, and as which image.
    types (images, 4) : type of an image by that of its generator.
    matrices (images, 2, 2) : place of an image by that of its generator.
    """

    members: IndexArray
    generator: IndexArray
    image: IndexArray
    types: IndexArray
    matrices: FloatArray

    def moved(self, points: FeaturePoints, steps: FloatArray) -> FeaturePoints:
        """The points with every generator moved by `steps` (g, 2) [mm], its images with it.

        Images are made anew from their generators, so that no rounding gathers between them. What
        is 5·10⁵ mm away from the axis stays, as a design's points may not go beyond 10⁶ mm.
        """
        x, y = points.x.copy(), points.y.copy()
        first = self.members[:, 0]
        places = np.stack([x[first], y[first]])
        places += np.where(np.hypot(*places) < STAYS, steps.T, 0.0)
        for image, matrix in enumerate(self.matrices):
            x[self.members[:, image]], y[self.members[:, image]] = matrix @ places
        return FeaturePoints(x, y, points.type)

    def gathered(self, slopes: FloatArray) -> FloatArray:
        """Slopes (g, 2, …) by the generators' places of slopes (n, 2, …) by all places."""
        parts = [
            np.einsum("gd...,dc->gc...", slopes[self.members[:, image]], matrix)
            for image, matrix in enumerate(self.matrices)
        ]
        return np.asarray(sum(parts))


def orbits_of(count: int, symmetry: Symmetry | None) -> Orbits:
    """Orbits of `count` feature points, in the order of `Symmetry.expanded`."""
    images = [(np.eye(2), np.arange(4))] if symmetry is None else symmetry.images
    points = np.arange(count)
    generators = count // len(images)
    return Orbits(
        np.ascontiguousarray(points.reshape(len(images), generators).T),
        points % max(generators, 1),
        points // max(generators, 1),
        np.array([types for _, types in images], dtype=np.int64),
        np.array([matrix for matrix, _ in images], dtype=np.float64),
    )


def with_cells(points: FeaturePoints, symmetry: Symmetry | None) -> FeaturePoints:
    """The points that are in no earlier one's place.

    Recombination leaves such twins; they would appear from nowhere when points move. Under a
    symmetry a generator goes with its images.
    """
    if symmetry is None:
        return distinct(points)
    generators = symmetry.generators(points)
    whole = symmetry.expanded(generators)
    members = orbits_of(len(whole), symmetry).members
    order = members.reshape(-1)  # orbit by orbit, so that the same orbit has the place everywhere
    own = first_of_places(whole.x[order], whole.y[order])
    kept = np.isin(members[:, 0], order[own])
    return symmetry.expanded(
        FeaturePoints(generators.x[kept], generators.y[kept], generators.type[kept])
    )
