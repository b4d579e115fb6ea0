"""A section cut so fine that walls flip with the types: what one flip moves, in O(1).

Elements of one cell that have the same other cells within a wall's half thickness are one fragment.
Whether it is a chamber follows from the types of these few feature points alone: it is what its
owner is, unless one of the others near it is a chamber of another supply; then it is wall.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray, IndexArray, LabelArray
from beamopt.base.compiled import compiled, inlined
from beamopt.section.cell_owners import cell_owners
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.moments import sum_moments
from beamopt.section.neighbours import cell_neighbours, neighbours_of
from beamopt.section.raster import nearest_types, tiling
from beamopt.section.seal import UNSEALED, SealRules
from beamopt.section.walls import wall_steps

__all__ = ["Fragments", "fragments_of", "kinds_of", "moments_of_kinds", "retype", "retyped"]

FAR = -1  # pads the rows of `others`
FEW_NEAR = 6  # room for neighbours within a wall of elements; more where that is too few
MOST_NEAR = 8  # neighbours that are told apart where walls are in mm


class Fragments(NamedTuple):
    """Parts of cells.

    owner (m,) : feature point of the cell. others (m, most) : feature points near it, padded by −1.
    raw (m, 6) : integrals of {1, x, y, x², y², xy} [mm², mm³, mm⁴].
    begin (n + 1,), touched : fragments that look at point k are `touched[begin[k]:begin[k + 1]]`.
    """

    owner: IndexArray
    others: IndexArray
    raw: FloatArray
    begin: IndexArray
    touched: IndexArray


def fragments_of(
    grid: PolarGrid, points: FeaturePoints, wall_elements: int, rules: SealRules = UNSEALED
) -> Fragments:
    """Fragments of the Voronoi section of `points` on the raster.

    Walls of elements are those of `add_walls`. Of a sealed section only the most part is known:
    skins are in no fragment, and walls are half of `rules.wall` to each side of a cell's edges;
    closed gaps, rounded corners and filled chambers are left out.
    """
    cells = np.zeros(grid.shape, dtype=np.int64)
    own = cell_owners(points.x, points.y, grid.domain)
    nearest_types(points.x[own], points.y[own], own, tiling(grid), cells)
    if rules.sealed:
        near, width = _near_in_mm(grid, points, cells, rules.wall / 2)
    else:
        near, width = _near_in_elements(grid, cells, wall_steps(wall_elements, rules))
    keys = np.concatenate([cells[..., None], near[..., :width]], axis=-1).reshape(-1, width + 1)
    border = keys[:, 1] != FAR if width else np.zeros(len(keys), dtype=np.bool_)
    found, inverse = _unique_rows(keys[border])
    # the fragments away from every border are numbered as their cells, the others behind them
    number = cells.reshape(-1).copy()
    number[border] = len(points) + inverse
    count = len(points) + len(found)
    number = number.reshape(grid.shape)
    number[_in_skin(grid, rules.skin)] = count
    raw = np.zeros((count + 1, 6))
    sum_moments(number, grid.radial_integrals, grid.angular_integrals, raw)
    owner = np.concatenate([np.arange(len(points)), found[:, 0]])
    others = np.full((count, max(width, 1)), FAR)
    others[len(points) :, :width] = found[:, 1:]
    return Fragments(owner, others, raw[:count], *_looked_at(owner, others, len(points)))


def _in_skin(grid: PolarGrid, skin: float) -> NDArray[np.bool_]:
    """(radial,) whether a row is nearer to one of the ring's surfaces than `skin` [mm]."""
    radii = grid.centroid_radii
    inside = (radii < grid.inner_radius + skin) & (grid.inner_radius > 0)
    return np.asarray((inside | (radii > grid.outer_radius - skin)) & (skin > 0))


def _near_in_elements(grid: PolarGrid, cells: IndexArray, steps: int) -> tuple[IndexArray, int]:
    """For every element the other cells within `steps` elements, and the most there are."""
    room, width = FEW_NEAR, FAR
    while width < 0:
        near = np.full((*grid.shape, room), FAR)
        width = _cells_near(cells, steps, grid.is_full_ring, near)
        room *= 2
    return near, width


def _near_in_mm(
    grid: PolarGrid, points: FeaturePoints, cells: IndexArray, distance: float
) -> tuple[IndexArray, int]:
    """For every element the neighbours whose cells' edges are within `distance` [mm]."""
    edges = cell_neighbours(points.x, points.y, grid.domain)
    begin, neighbours = neighbours_of(edges, len(points))
    near = np.full((*grid.shape, MOST_NEAR), FAR)
    x, y = grid.centroids
    return near, _edges_near(cells, x, y, points.x, points.y, begin, neighbours, distance, near)


@compiled
def _edges_near(
    cells: IndexArray,
    x: FloatArray,
    y: FloatArray,
    px: FloatArray,
    py: FloatArray,
    begin: IndexArray,
    neighbours: IndexArray,
    distance: float,
    near: IndexArray,
) -> int:
    most = 0
    rows, columns = cells.shape
    for i in range(rows):
        for j in range(columns):
            own, count = cells[i, j], 0
            for other in neighbours[begin[own] : begin[own + 1]]:
                dx, dy = px[other] - px[own], py[other] - py[own]
                mx, my = (px[other] + px[own]) / 2, (py[other] + py[own]) / 2
                away = ((mx - x[i, j]) * dx + (my - y[i, j]) * dy) / np.sqrt(dx * dx + dy * dy)
                if away < distance and count < near.shape[2]:
                    count = _insert(near[i, j], count, other)
            most = max(most, count)
    return most


def _unique_rows(rows: IndexArray) -> tuple[IndexArray, IndexArray]:
    """Different rows, and which of them each row is."""
    if not len(rows):
        return rows, np.zeros(0, dtype=np.int64)
    order = np.lexsort(rows.T[::-1])
    ordered = rows[order]
    first = np.concatenate([[True], (ordered[1:] != ordered[:-1]).any(axis=1)])
    inverse = np.empty(len(rows), dtype=np.int64)
    inverse[order] = np.cumsum(first) - 1
    return ordered[first], inverse


def _looked_at(owner: IndexArray, others: IndexArray, count: int) -> tuple[IndexArray, IndexArray]:
    everyone = np.concatenate([owner[:, None], others], axis=1)
    fragment, column = np.nonzero(everyone != FAR)
    point = everyone[fragment, column]
    order = np.argsort(point, kind="stable")
    begin = np.searchsorted(point[order], np.arange(count + 1))
    return begin.astype(np.int64), fragment[order].astype(np.int64)


@compiled
def _cells_near(cells: IndexArray, steps: int, periodic: bool, near: IndexArray) -> int:
    """For every element the other cells within `steps`, ascending; returns the most there are.

    FAR where a row of `near` is filled: there may be more.
    """
    rows, columns = cells.shape
    most = 0
    for i in range(rows):
        for j in range(columns):
            count = 0
            own = cells[i, j]
            for di in range(-steps, steps + 1):
                row = i + di
                if not 0 <= row < rows:
                    continue
                reach = steps - abs(di)
                for dj in range(-reach, reach + 1):
                    column = j + dj
                    if periodic:
                        column %= columns
                    elif not 0 <= column < columns:
                        continue
                    if cells[row, column] != own:
                        count = _insert(near[i, j], count, cells[row, column])
                        if count == near.shape[2]:
                            return FAR
            most = max(most, count)
    return most


@compiled
def _insert(row: IndexArray, count: int, value: int) -> int:
    """Add a value to the ascending beginning of a row, unless it is there."""
    at = count
    for k in range(count):
        if row[k] == value:
            return count
        if row[k] > value:
            at = k
            break
    for k in range(count, at, -1):
        row[k] = row[k - 1]
    row[at] = value
    return count + 1


@compiled
def kinds_of(fragments: Fragments, types: LabelArray) -> LabelArray:
    """(m,) type of every fragment, walls included."""
    kinds = np.empty(fragments.owner.size, dtype=np.uint8)
    for f in range(kinds.size):
        kinds[f] = _kind(fragments, types, f)
    return kinds


@inlined
def _kind(fragments: Fragments, types: LabelArray, f: int) -> int:
    own = types[fragments.owner[f]]
    kind = own
    for m in range(fragments.others.shape[1]):
        other = fragments.others[f, m]
        if own == 0 or other < 0:
            break
        near = types[other]
        if near != 0 and near != own:
            kind = np.uint8(0)
            break
    return int(kind)


@compiled
def moments_of_kinds(fragments: Fragments, kinds: LabelArray) -> FloatArray:
    """(4, 6) moments of every type."""
    raw = np.zeros((4, 6))
    for f in range(kinds.size):
        for m in range(6):
            raw[kinds[f], m] += fragments.raw[f, m]
    return raw


@compiled
def retype(
    fragments: Fragments, types: LabelArray, kinds: LabelArray, raw: FloatArray, point: int
) -> None:
    """Bring `kinds` and `raw` up to date, in place, after the type of `point` has changed."""
    retyped(fragments, types, kinds, raw, point)


@inlined
def retyped(
    fragments: Fragments, types: LabelArray, kinds: LabelArray, raw: FloatArray, point: int
) -> None:
    """The same, for kernels that do little else."""
    for at in range(fragments.begin[point], fragments.begin[point + 1]):
        f = fragments.touched[at]
        old, new = kinds[f], _kind(fragments, types, f)
        if new != old:
            kinds[f] = new
            for m in range(6):
                raw[old, m] -= fragments.raw[f, m]
                raw[new, m] += fragments.raw[f, m]
