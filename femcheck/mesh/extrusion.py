"""Layers of wedges over a triangulated section, graded towards both ends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from femcheck.mesh.section_mesh import SectionMesh

__all__ = ["Extrusion", "extrude", "stations"]


@dataclass(frozen=True, eq=False)
class Extrusion:
    """A volume mesh of straight wedges.

    Parameters
    ----------
    section : the triangulated section.
    heights : (layers + 1,) heights of the planes between the layers [mm], from 0 to the length.
    points : (n·(layers + 1), 3) corners [mm], plane by plane.
    wedges : (m·layers, 6) corners of the wedges, the lower triangle first; layer by layer.
    walls : (w, 4) corners a, b below and b, a above of each boundary quadrangle; seen from the
        material its normal (b − a) × e3 points out.
    supply : (w,) 0 where a quadrangle lies on a free surface, 1…3 on a chamber's wall.
    """

    section: SectionMesh
    heights: FloatArray
    points: FloatArray
    wedges: IndexArray
    walls: IndexArray
    supply: IndexArray

    @property
    def length(self) -> float:
        """Length of the actuator [mm]."""
        return float(self.heights[-1])


def stations(length: float, layers: int, grading: float = 1.0) -> FloatArray:
    """(layers + 1,) heights of the planes between layers [mm].

    grading : thickness of a middle layer over that of an end one; 1 makes all equal. Thicknesses
        grow geometrically from both ends.

    Raises
    ------
    ValueError : no layer, or a grading that is not positive.
    """
    if layers < 1 or not grading > 0:
        raise ValueError(f"layers = {layers}, grading = {grading}: at least 1 and above 0")
    from_end = np.minimum(np.arange(layers), np.arange(layers)[::-1])
    most = max(int(from_end.max()), 1)
    thickness = grading ** (from_end / most)
    planes = np.concatenate([[0.0], np.cumsum(thickness)])
    return np.asarray(planes * (length / planes[-1]))


def extrude(section: SectionMesh, heights: FloatArray) -> Extrusion:
    """Stack copies of the section at `heights` [mm] and fill them with wedges."""
    n, layers = len(section.points), len(heights) - 1
    flat = np.tile(section.points, (layers + 1, 1))
    points = np.column_stack([flat, np.repeat(heights, n)])
    below = (np.arange(layers) * n)[:, None, None]
    lower = section.triangles[None] + below
    wedges = np.concatenate([lower, lower + n], axis=2).reshape(-1, 6)
    a, b = (section.edges[None, :, k] + below[..., 0] for k in (0, 1))
    walls = np.stack([a, b, b + n, a + n], axis=2).reshape(-1, 4)
    return Extrusion(section, heights, points, wedges, walls, np.tile(section.supply, layers))
