"""Tubes meshed by hand: one chamber, two triangles a cell of the wall."""

import numpy as np

from femcheck.mesh.extrusion import extrude, stations
from femcheck.mesh.section_mesh import SectionMesh
from femcheck.solid.body import Body, discretise


def tube_section(
    inner: float, outer: float, around: int, shift: float = 0.0, across: int = 1
) -> SectionMesh:
    """Chords between the radii [mm]; the bore's centre is off the axis by `shift` [mm]."""
    angles = 2 * np.pi * np.arange(around) / around
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    bore, outside = inner * circle + [shift, 0.0], outer * circle
    shares = np.arange(across + 1)[:, None, None] / across
    points = (bore + shares * (outside - bore)).reshape(-1, 2)
    rings = around * np.arange(across)[:, None]
    a = (rings + np.arange(around)).ravel()
    b = (rings + np.roll(np.arange(around), -1)).ravel()
    triangles = np.concatenate(
        [np.stack([a, a + around, b + around], 1), np.stack([a, b + around, b], 1)]
    )
    first, last = slice(around), slice(-around, None)
    within = np.stack([b[first], a[first]], 1)
    without = np.stack([a[last], b[last]], 1) + around
    edges = np.concatenate([within, without])
    return SectionMesh(points, triangles, edges, np.repeat([1, 0], around))


def tube(
    inner: float,
    outer: float,
    length: float,
    around: int = 8,
    layers: int = 2,
    element: str = "wedge18",
    shift: float = 0.0,
    across: int = 1,
) -> Body:
    section = tube_section(inner, outer, around, shift, across)
    return discretise(extrude(section, stations(length, layers)), element)
