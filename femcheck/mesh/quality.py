"""How good a section mesh is, and where it is worst."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.outline.outline import Outline
from femcheck.mesh.section_mesh import SectionMesh
from femcheck.mesh.wall_thickness import thickness_behind

__all__ = ["Quality", "quality_of"]

THIN = 0.5  # mm; a wall that is hard to cast
POOR = 0.1  # of an equilateral triangle's shape


@dataclass(frozen=True, slots=True)
class Quality:
    """The thinnest wall and the worst triangle.

    thinnest : least way through the material, along an edge's normal [mm], at `thin_at`.
    shape : smallest 4√3 area / Σ edge², 1 for an equilateral triangle, at `poor_at` [mm].
    """

    thinnest: float
    thin_at: tuple[float, float]
    shape: float
    poor_at: tuple[float, float]

    @property
    def notes(self) -> list[str]:
        """What is worth knowing, with coordinates."""
        said = []
        if self.thinnest < THIN:
            said.append(f"thinnest wall {self.thinnest:.3f} mm at {_place(self.thin_at)}")
        if self.shape < POOR:
            said.append(f"poor triangle, shape {self.shape:.3g} of 1, at {_place(self.poor_at)}")
        return said


def quality_of(outline: Outline, section: SectionMesh) -> Quality:
    """Measure an outline's walls and its mesh's triangles."""
    loops = [loop.points for piece in outline.pieces for loop in piece.loops]
    a = np.concatenate(loops)
    b = np.concatenate([np.roll(loop, -1, axis=0) for loop in loops])
    walls = thickness_behind(a, b)
    thin = int(np.argmin(walls))
    corners = section.points[section.triangles]
    squares = ((corners - np.roll(corners, 1, axis=1)) ** 2).sum(axis=(1, 2))
    shapes = 4 * np.sqrt(3) * section.areas / squares
    poor = int(np.argmin(shapes))
    return Quality(
        float(walls[thin]),
        _pair((a[thin] + b[thin]) / 2),
        float(shapes[poor]),
        _pair(corners[poor].mean(axis=0)),
    )


def _pair(place: FloatArray) -> tuple[float, float]:
    return float(place[0]), float(place[1])


def _place(at: tuple[float, float]) -> str:
    return f"({at[0]:.1f}, {at[1]:.1f}) mm".replace("-", "−")
