"""Triangles over the material of an outline: fine at its walls, coarse between them."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray, IndexArray
from beamopt.base.errors import InputError
from beamopt.outline.outline import Outline, Piece

if TYPE_CHECKING:
    from shapely import Polygon

__all__ = ["Triangulation", "quadratic", "triangulate"]

COARSEST = 1 / 16  # length of an edge over the section's, before edges are halved
GROWTH = 0.5  # of the triangles' size with the distance from a wall
ROUNDS = 40  # of splitting edges at most; about five are needed
CLOSED = 1e-9  # of a piece's area that triangles may leave open
FLAT = 1e-9  # area of a triangle over its sides' squares, on a straight wall


class Triangulation(NamedTuple):
    """Points (n, 2) [mm] and the corners (m, 3) of triangles, counter-clockwise."""

    points: FloatArray
    triangles: IndexArray


def triangulate(outline: Outline) -> Triangulation:
    """Triangulate the material of an outline, every piece by itself.

    All edges of the outline are edges of triangles, split where a wall is thinner than they are
    long, so that no corner lies in the circle over an edge (as in Ruppert's refinement), where they
    are longer than a sixteenth of the section, and then halved once more.

    Raises
    ------
    InputError : the triangles do not fill a piece.
    """
    points, triangles, count = [], [], 0
    for piece in outline.pieces:
        at, corners = _piece(piece)
        points.append(at)
        triangles.append(corners + count)
        count += len(at)
    if not points:
        return Triangulation(np.zeros((0, 2)), np.zeros((0, 3), dtype=np.int64))
    return Triangulation(np.concatenate(points), np.concatenate(triangles))


def quadratic(mesh: Triangulation) -> tuple[FloatArray, IndexArray]:
    """Nodes (n, 2) and cells (m, 6): the corners, then a node in the middle of each side."""
    corners = mesh.triangles
    sides = np.stack([corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 2)
    known, number = np.unique(np.sort(sides, axis=1), axis=0, return_inverse=True)
    nodes = np.concatenate([mesh.points, mesh.points[known].mean(axis=1)])
    middles = number.reshape(-1, 3) + len(mesh.points)
    return nodes, np.concatenate([corners, middles], axis=1).astype(np.int64)


class _Edges(NamedTuple):
    """Points (n, 2) of a piece's loops and its edges (k, 2), the material to their left."""

    points: FloatArray
    ends: IndexArray


def _piece(piece: Piece) -> Triangulation:
    import shapely

    polygon = shapely.Polygon(piece.exterior.points, [hole.points for hole in piece.holes])
    shapely.prepare(polygon)
    walls = _conforming(_edges_of(piece), np.zeros((0, 2)))
    walls = _split(walls, np.ones(len(walls.ends), dtype=bool), given=0)
    inner = _inner_points(polygon, walls)
    walls = _conforming(walls, inner)
    at = np.concatenate([walls.points, inner])
    corners, areas = _delaunay(at)
    inside = shapely.contains_xy(polygon, *at[corners].mean(axis=1).T)
    if abs(areas[inside].sum() - piece.area) > CLOSED * piece.area:
        raise InputError("design", "outline", None, "its material can not be triangulated")
    return Triangulation(at, corners[inside])


def _edges_of(piece: Piece) -> _Edges:
    points, ends, count = [], [], 0
    for loop in piece.loops:
        here = count + np.arange(len(loop.points))
        points.append(loop.points)
        ends.append(np.stack([here, np.roll(here, -1)], axis=1))
        count += len(here)
    return _Edges(np.concatenate(points), np.concatenate(ends))


def _conforming(walls: _Edges, inner: FloatArray) -> _Edges:
    """Split edges until all are sides of triangles with no corner in the circle over them."""
    given = len(walls.points)
    for k in range(ROUNDS):
        split = _to_split(walls, inner, finer=k < ROUNDS // 2)
        if not split.any():
            break
        walls = _split(walls, split, given)
    return walls


def _to_split(walls: _Edges, inner: FloatArray, finer: bool) -> NDArray[np.bool_]:
    """(k,) edges that are no triangle's side; if `finer`, also long ones and near a corner."""
    at = np.concatenate([walls.points, inner])
    corners, _ = _delaunay(at)
    sides = corners * len(at) + np.roll(corners, -1, axis=1)
    order = np.argsort(sides, axis=None)
    wanted = walls.ends[:, 0] * len(at) + walls.ends[:, 1]
    place = order[np.minimum(np.searchsorted(sides.ravel()[order], wanted), order.size - 1)]
    split = sides.ravel()[place] != wanted
    a, b = walls.points[walls.ends.T]
    if finer:
        opposite = at[np.roll(corners, 1, axis=1).ravel()[place]]
        split |= ((a - opposite) * (b - opposite)).sum(axis=1) < 0
        split |= np.hypot(*(b - a).T) > COARSEST * np.ptp(walls.points, axis=0).max()
    return np.asarray(split & (a != b).any(axis=1))


def _split(walls: _Edges, split: NDArray[np.bool_], given: int) -> _Edges:
    """Split edges near their middles.

    Next to one of the first `given` points at a power of two from it: the parts of two edges that
    meet there at a sharp angle come out alike, so that neither asks for the other's splitting.
    """
    ends = walls.ends[split]
    a, b = walls.points[ends.T]
    length = np.hypot(*(b - a).T)
    share = 2 ** np.round(np.log2(length / 2)) / length
    first, second = (ends < given).T
    at = np.where(first == second, 0.5, np.where(first, share, 1 - share))[:, None]
    new = len(walls.points) + np.arange(len(ends))
    halves = np.stack([ends[:, 0], new], axis=1), np.stack([new, ends[:, 1]], axis=1)
    return _Edges(
        np.concatenate([walls.points, (1 - at) * a + at * b]),
        np.concatenate([walls.ends[~split], *halves]),
    )


def _inner_points(polygon: Polygon, walls: _Edges) -> FloatArray:
    """Middles of the squares of a quadtree that is as fine as its distance from the walls asks."""
    import shapely
    from scipy.spatial import cKDTree

    a, b = walls.points[walls.ends.T]
    tree, length = cKDTree((a + b) / 2), np.hypot(*(b - a).T)
    low, high = walls.points.min(axis=0), walls.points.max(axis=0)
    size = float((high - low).max())
    middles, found = (low + high)[None] / 2, [np.zeros((0, 2))]
    while len(middles):
        distance, nearest = tree.query(middles)
        wanted = length[nearest] + GROWTH * distance
        keep = (size <= wanted) & (distance > length[nearest])
        found.append(middles[keep])
        further = middles[size > wanted]
        quarters = size / 4 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
        middles = (further[:, None] + quarters).reshape(-1, 2)
        size /= 2
    at = np.concatenate(found)
    return np.asarray(at[shapely.contains_xy(polygon, *at.T)])


def _delaunay(points: FloatArray) -> tuple[IndexArray, FloatArray]:
    """Corners (m, 3) of triangles between points, counter-clockwise, and areas (m,) [mm²].

    Without flat ones, as there are outside a straight side whose points rounding puts off it.
    """
    from scipy.spatial import Delaunay

    corners = np.asarray(Delaunay(points).simplices, dtype=np.int64)
    a, b, c = (points[corners[:, k]] for k in range(3))
    u, v = b - a, c - a
    twice = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    corners[twice < 0] = corners[twice < 0][:, ::-1]
    flat = np.abs(twice) < FLAT * np.maximum((u * u).sum(axis=1), (v * v).sum(axis=1))
    return corners[~flat], np.abs(twice[~flat]) / 2
