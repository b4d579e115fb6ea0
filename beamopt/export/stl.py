"""Solids as binary STL: closed surfaces of triangles, for printers and slicers."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.errors import InputError
from beamopt.export.bodies import ExtrudedFace
from beamopt.export.faces import Contour, polygon_of

__all__ = ["enclosed_volume", "is_watertight", "solid_triangles", "stl_bytes"]

RECORD = np.dtype(
    [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")],
)
"""What the format holds of a triangle, in 50 bytes."""


def stl_bytes(solids: Sequence[ExtrudedFace]) -> bytes:
    """A binary STL file of all solids, each a closed surface of its own; mm.

    Raises
    ------
    InputError : a solid's surface does not close.
    """
    corners = np.concatenate([solid_triangles(solid) for solid in solids])
    records = np.zeros(len(corners), dtype=RECORD)
    records["corners"] = corners
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(normal, axis=1, keepdims=True)
    records["normal"] = np.divide(normal, size, out=np.zeros_like(normal), where=size > 0)
    # readers take a header that begins with "solid" for the format's text form
    header = b"binary STL, mm: " + ", ".join(one.name for one in solids).encode("ascii", "replace")
    return header[:80].ljust(80) + np.uint32(len(corners)).tobytes() + records.tobytes()


def solid_triangles(solid: ExtrudedFace) -> FloatArray:
    """(n, 3, 3) corners [mm] of a solid's surface, counter-clockwise seen from outside.

    The corners are rounded to the single precision that the file holds.

    Raises
    ------
    InputError : the surface is not closed.
    """
    shells = [_shell(solid)] + [_shell(cavity)[:, ::-1] for cavity in solid.cavities]
    triangles = np.concatenate(shells)
    if not is_watertight(triangles):
        raise InputError("stl", solid.name, None, "its surface does not close; leave stl out")
    return triangles


def is_watertight(triangles: FloatArray) -> bool:
    """Whether every edge of triangles (n, 3, 3) is run through as often one way as the other."""
    _, corner = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    corner = corner.reshape(-1, 3)
    edges = np.concatenate([corner[:, [k, (k + 1) % 3]] for k in range(3)])
    if (edges[:, 0] == edges[:, 1]).any():
        return False
    there, back = (pairs[np.lexsort(pairs.T[::-1])] for pairs in (edges, edges[:, ::-1]))
    return bool((there == back).all())


def enclosed_volume(triangles: FloatArray) -> float:
    """Volume [mm³] that a closed surface (n, 3, 3) encloses: a sixth of Σ a · (b × c)."""
    a, b, c = (triangles[:, k].astype(np.float64) for k in range(3))
    return float(np.sum(a * np.cross(b, c)) / 6)


def _shell(solid: ExtrudedFace) -> FloatArray:
    """A face between two heights: both ends, and two triangles for every edge."""
    plane = _triangulated(solid.contours)
    ends = [_raised(plane, solid.high), _raised(plane, solid.low)[:, ::-1]]
    walls = [_walls(contour.points, solid.low, solid.high) for contour in solid.contours]
    return _single(np.concatenate([*ends, *walls]))


def _single(triangles: FloatArray) -> FloatArray:
    """Corners that single precision holds; what has no three of them left is no triangle."""
    rounded = triangles.astype(np.float32).astype(np.float64)
    apart = (rounded != np.roll(rounded, 1, axis=1)).any(axis=2).all(axis=1)
    return np.asarray(rounded[apart])


def _triangulated(contours: Sequence[Contour]) -> FloatArray:
    """(n, 3, 2) triangles of the contours' own vertices, counter-clockwise."""
    import shapely

    parts = shapely.get_parts(shapely.constrained_delaunay_triangles(polygon_of(contours)))
    triangles = shapely.get_coordinates(parts).reshape(-1, 4, 2)[:, :3]
    # all run the same way round, even those of no area, whose own sign says nothing
    return np.asarray(triangles if _area(triangles) > 0 else triangles[:, ::-1])


def _area(triangles: FloatArray) -> float:
    (ux, uy), (vx, vy) = ((triangles[:, k] - triangles[:, 0]).T for k in (1, 2))
    return float(np.sum(ux * vy - uy * vx) / 2)


def _raised(plane: FloatArray, z: float) -> FloatArray:
    return np.concatenate([plane, np.full((*plane.shape[:2], 1), z)], axis=2)


def _walls(points: FloatArray, low: float, high: float) -> FloatArray:
    """(2n, 3, 3) triangles below and above the diagonals of the edges' rectangles."""
    this, following = points, np.roll(points, -1, axis=0)
    a, b = (_raised(p[:, None], low) for p in (this, following))
    d, c = (_raised(p[:, None], high) for p in (this, following))
    return np.concatenate([np.concatenate(t, axis=1) for t in ((a, b, c), (a, c, d))])
