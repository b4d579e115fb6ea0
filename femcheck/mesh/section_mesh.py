"""A triangulated section: what is extruded to a solid."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from beamopt.section.moments import Moments

__all__ = ["SectionMesh"]


@dataclass(frozen=True, eq=False)
class SectionMesh:
    """Triangles of a section's material, and its boundary edges.

    Parameters
    ----------
    points : (n, 2) corners [mm], about the ring's axis.
    triangles : (m, 3) indices of corners, counter-clockwise.
    edges : (k, 2) boundary edges, the material to their left.
    supply : (k,) 0 where an edge lies on a free surface, 1…3 where on a chamber of that supply.
    """

    points: FloatArray
    triangles: IndexArray
    edges: IndexArray
    supply: IndexArray

    @cached_property
    def moments(self) -> Moments:
        """Exact moments of the meshed polygons: what the solid's cross-section really is.

        The integrals over a region are sums over its boundary edges (Green's theorem); a chamber's
        boundary is its walls, walked the other way.
        """
        raw = np.zeros((4, 6))
        edges = _edge_integrals(self.points[self.edges[:, 0]], self.points[self.edges[:, 1]])
        raw[0] = edges.sum(axis=0)
        for supply in (1, 2, 3):
            raw[supply] = -edges[self.supply == supply].sum(axis=0)
        return Moments(raw)

    @cached_property
    def areas(self) -> FloatArray:
        """(m,) signed areas of the triangles [mm²]."""
        a, b, c = (self.points[self.triangles[:, k]] for k in range(3))
        return np.asarray(_cross(b - a, c - a) / 2)


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def _edge_integrals(a: FloatArray, b: FloatArray) -> FloatArray:
    """(k, 6) integrals of {1, x, y, x², y², xy} over the triangles (origin, a, b), signed."""
    twice = _cross(a, b)
    (ax, ay), (bx, by) = a.T, b.T
    return np.stack(
        [
            twice / 2,
            twice * (ax + bx) / 6,
            twice * (ay + by) / 6,
            twice * (ax * ax + ax * bx + bx * bx) / 12,
            twice * (ay * ay + ay * by + by * by) / 12,
            twice * (2 * ax * ay + ax * by + bx * ay + 2 * bx * by) / 24,
        ],
        axis=1,
    )
