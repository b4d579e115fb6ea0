"""Hexahedra over a triangulated section: every triangle cut into three quadrangles.

Each quadrangle has a corner of the triangle, the middles of the two edges there and the triangle's
centroid. All of them are convex, whatever the triangle.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from femcheck.mesh.extrusion import Extrusion
from femcheck.mesh.section_mesh import SectionMesh

__all__ = ["Hexahedra", "subdivide"]


@dataclass(frozen=True, eq=False)
class Hexahedra:
    """A volume mesh of straight hexahedra, of the same volume as the wedges that it was cut from.

    Parameters
    ----------
    points : (n, 3) corners [mm], plane by plane.
    cells : (h, 8) corners, the lower quadrangle first, both counter-clockwise seen from above.
    walls : (w, 4) corners of each boundary quadrangle, in the order of `Extrusion.walls`.
    quadrangle : (w,) the wall quadrangle of the wedges of which it is a half.
    """

    points: FloatArray
    cells: IndexArray
    walls: IndexArray
    quadrangle: IndexArray


def subdivide(body: Extrusion) -> Hexahedra:
    """Cut every wedge into three hexahedra; boundary quadrangles are halved upright."""
    flat, quads, halves = _quadrangles(body.section)
    n, layers = len(flat), body.heights.size - 1
    points = np.column_stack([np.tile(flat, (layers + 1, 1)), np.repeat(body.heights, n)])
    below = (np.arange(layers) * n)[:, None, None]
    lower = quads[None] + below
    a, b = (halves[None, :, k] + below[..., 0] for k in (0, 1))
    index = np.tile(np.arange(len(body.section.edges)), 2)
    first = (np.arange(layers) * len(body.section.edges))[:, None]
    return Hexahedra(
        points,
        np.concatenate([lower, lower + n], axis=2).reshape(-1, 8),
        np.stack([a, b, b + n, a + n], axis=2).reshape(-1, 4),
        (index[None] + first).ravel(),
    )


def _quadrangles(section: SectionMesh) -> tuple[FloatArray, IndexArray, IndexArray]:
    """Points (n, 2), quadrangles (3 m, 4) and boundary edges: all first halves, then all second."""
    triangles, corners = section.triangles, len(section.points)
    sides = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2), axis=2)
    keys = sides[..., 0] * corners + sides[..., 1]
    known, side = np.unique(keys, return_inverse=True)
    ends = np.stack([known // corners, known % corners], axis=1)
    middle = corners + side.reshape(triangles.shape)  # of the side from each corner to the next
    centroid = (corners + known.size + np.arange(len(triangles)))[:, None]
    points = np.concatenate(
        [
            section.points,
            section.points[ends].mean(axis=1),
            section.points[triangles].mean(axis=1),
        ]
    )
    before = np.roll(middle, 1, axis=1)
    centroids = np.broadcast_to(centroid, triangles.shape)
    quads = np.stack([triangles, middle, centroids, before], axis=2).reshape(-1, 4)
    a, b = section.edges.T
    cut = corners + np.searchsorted(known, np.minimum(a, b) * corners + np.maximum(a, b))
    halves = np.concatenate([np.stack([a, cut], axis=1), np.stack([cut, b], axis=1)])
    return points, quads, halves
