"""The surface of the solid: triangles of its free surface, chamber walls and tip face."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray

__all__ = ["PARTS", "TIP", "Surface", "surface_of"]

PARTS = ("free surface", "supply 1", "supply 2", "supply 3", "tip face")
TIP = 4


@dataclass(frozen=True, eq=False)
class Surface:
    """A triangulated surface; the clamped face is left out, nothing is seen there.

    nodes : (v,) node of the mesh at each vertex; the tip's rim has vertices of its own on the face
        and on the walls, so that the edge between them stays sharp.
    rest : (v, 3) undeformed vertices [mm].
    triangles : (t, 3) vertices, counter-clockwise seen from outside the material; part by part.
    part : (t,) place in `PARTS`.
    """

    nodes: IndexArray
    rest: FloatArray
    triangles: IndexArray
    part: IndexArray

    def stretch(self, at: FloatArray) -> FloatArray:
        """(v,) largest principal stretch in the surface with vertices at `at` (v, 3) [mm].

        Of each triangle's plane deformation, averaged over a vertex's triangles by undeformed area.
        """
        to_unit = np.linalg.inv(np.linalg.cholesky(self._metric(self.rest)))
        squares = to_unit @ self._metric(at) @ to_unit.transpose(0, 2, 1)
        low, high, mixed = squares[:, 0, 0], squares[:, 1, 1], squares[:, 0, 1]
        largest = (low + high) / 2 + np.hypot((low - high) / 2, mixed)
        areas, values = self._areas, np.sqrt(largest)
        total, weight = np.zeros(len(at)), np.zeros(len(at))
        for corner in self.triangles.T:
            np.add.at(total, corner, areas * values)
            np.add.at(weight, corner, areas)
        return np.asarray(total / weight)

    @cached_property
    def _areas(self) -> FloatArray:
        return np.asarray(np.sqrt(np.linalg.det(self._metric(self.rest))) / 2)

    def _metric(self, at: FloatArray) -> FloatArray:
        """(t, 2, 2) inner products of two edges of each triangle [mm²]."""
        a, b, c = (at[corner] for corner in self.triangles.T)
        edges = np.stack([b - a, c - a], axis=1)
        return np.asarray(edges @ edges.transpose(0, 2, 1))


def surface_of(
    rest: FloatArray, wedges: IndexArray, supplies: Mapping[tuple[int, int], int]
) -> Surface:
    """The surface of stacked wedges.

    rest : (n, 3) undeformed nodes [mm], plane by plane. wedges : (m, 6), lower triangle first.
    supplies : of each boundary edge (a, b) of the section, a < b: 0 on a free surface, else 1…3.

    Raises
    ------
    ValueError : a boundary edge that `supplies` does not name.
    """
    plane = int((rest[:, 2] <= rest[:, 2].min()).sum())
    lower = wedges[:, :3]
    edges = np.concatenate([lower[:, [0, 1]], lower[:, [1, 2]], lower[:, [2, 0]]])
    uppers = wedges[:, 3:]
    above = np.concatenate([uppers[:, [0, 1]], uppers[:, [1, 2]], uppers[:, [2, 0]]])
    _, first, counts = np.unique(
        np.sort(edges, axis=1), axis=0, return_index=True, return_counts=True
    )
    outside = first[counts == 1]  # an inner edge is two wedges'
    (a, b), (below_a, below_b) = above[outside].T, edges[outside].T
    names = zip(*np.sort(np.stack([below_a, below_b]) % plane, axis=0).tolist(), strict=True)
    try:
        supply = np.array([supplies[name] for name in names], dtype=np.int64)
    except KeyError as error:
        raise ValueError(f"edge {error} of the section has no tag") from None
    walls = np.concatenate([np.stack([below_a, below_b, b], 1), np.stack([below_a, b, a], 1)])
    top = uppers[rest[uppers[:, 0], 2] >= rest[:, 2].max()]
    return _numbered(rest, walls, np.tile(supply, 2), top)


def _numbered(rest: FloatArray, walls: IndexArray, supply: IndexArray, top: IndexArray) -> Surface:
    """Vertices of the walls first, then those of the tip face."""
    order = np.argsort(supply, kind="stable")
    wall_nodes, of_walls = np.unique(walls[order], return_inverse=True)
    top_nodes, of_top = np.unique(top, return_inverse=True)
    nodes = np.concatenate([wall_nodes, top_nodes])
    triangles = np.concatenate(
        [of_walls.reshape(-1, 3), of_top.reshape(-1, 3) + len(wall_nodes)]
    ).astype(np.int64)
    part = np.concatenate([supply[order], np.full(len(top), TIP)])
    return Surface(nodes, rest[nodes], triangles, part)
