"""Voronoi feature points: the genotype of a cross-section (paper, Algorithm 1)."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beamopt.base.arrays import FloatArray
from beamopt.section.grid import PolarGrid

__all__ = ["MATERIAL", "SUPPLIES", "FeaturePoints"]

MATERIAL = 0
SUPPLIES = (1, 2, 3)


@dataclass(frozen=True, eq=False)
class FeaturePoints:
    """Points in the plane of the section, each with the type of the cell around it.

    Parameters
    ----------
    x, y : (n,) positions along the grid's axes [mm], finite.
    type : (n,) 0 for material, 1…3 for a chamber of that pressure supply.

    Raises
    ------
    ValueError : lengths differ, a position is not finite, or a type is not 0…3.

    Examples
    --------
    >>> import beamopt
    >>> beamopt.FeaturePoints([15.0, -15.0], [0.0, 0.0], [1, 0])
    <FeaturePoints: 2, of material and supplies 1, 2, 3: 1, 1, 0, 0>
    """

    x: FloatArray
    y: FloatArray
    type: NDArray[np.uint8]

    def __init__(self, x: ArrayLike, y: ArrayLike, type: ArrayLike) -> None:
        xs = np.array(x, dtype=np.float64).reshape(-1)
        ys = np.array(y, dtype=np.float64).reshape(-1)
        types = np.array(type).reshape(-1)
        if not xs.size == ys.size == types.size:
            raise ValueError(f"x, y, type have {xs.size}, {ys.size}, {types.size} entries")
        if not (np.isfinite(xs).all() and np.isfinite(ys).all()):
            raise ValueError("x, y: every position must be a finite number of mm")
        whole = types.dtype.kind in "iu" or (np.mod(types, 1) == 0).all()
        if types.size and not (whole and types.min() >= MATERIAL and types.max() <= SUPPLIES[-1]):
            raise ValueError("type: 0 (material) or 1, 2, 3 (supply)")
        for name, array in (("x", xs), ("y", ys), ("type", types.astype(np.uint8))):
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    def __len__(self) -> int:
        return self.x.size

    def __repr__(self) -> str:
        types = ", ".join(str(count) for count in np.bincount(self.type, minlength=4).tolist())
        return f"<FeaturePoints: {len(self)}, of material and supplies 1, 2, 3: {types}>"

    @classmethod
    def random(
        cls,
        grid: PolarGrid,
        count: int,
        rng: np.random.Generator,
        material_probability: float = 0.5,
    ) -> FeaturePoints:
        """`count` points on element centroids, drawn evenly over rows and over columns.

        A type is material with `material_probability`; the three supplies share the rest evenly.
        """
        rows = rng.integers(grid.radial, size=count)
        columns = rng.integers(grid.angular, size=count)
        chamber = (1 - material_probability) / len(SUPPLIES)
        types = rng.choice(
            len(SUPPLIES) + 1, size=count, p=[material_probability] + [chamber] * len(SUPPLIES)
        )
        x, y = grid.centroids[:, rows, columns]
        return cls(x, y, types)

    @cached_property
    def angles(self) -> FloatArray:
        """(n,) polar angles in [0, 2π) [rad]."""
        return np.asarray(np.mod(np.arctan2(self.y, self.x), 2 * np.pi))

    def with_types(self, types: NDArray[np.uint8]) -> FeaturePoints:
        """The same positions with other types."""
        return FeaturePoints(self.x, self.y, types)

    def taking(
        self, own: NDArray[np.bool_], other: FeaturePoints, theirs: NDArray[np.bool_]
    ) -> FeaturePoints:
        """The points `own` of these, followed by the points `theirs` of `other`."""
        pairs = ((self.x, other.x), (self.y, other.y), (self.type, other.type))
        return FeaturePoints(*(np.concatenate([a[own], b[theirs]]) for a, b in pairs))

    @cached_property
    def digest(self) -> str:
        """Eight bytes in hexadecimal that tell two sets of points apart."""
        state = hashlib.blake2b(digest_size=8)
        for array in (self.x, self.y, self.type):
            state.update(np.ascontiguousarray(array).tobytes())
        return state.hexdigest()
