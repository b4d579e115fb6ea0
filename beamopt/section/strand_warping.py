"""The Saint-Venant solve of a raster section on strands: bilinear elements over coarse cells.

The coarse elements are integrated over the material of the raster exactly, so that what they give
is the solve of the full raster restricted to functions that are bilinear in each strand: I_T comes
out too large, the shear area too.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray, IndexArray, LabelArray
from beamopt.base.compiled import compiled
from beamopt.section.grid import PolarGrid
from beamopt.section.moments import sum_moments
from beamopt.section.strands import join_corners, label_strands, number_corners
from beamopt.section.warping_sums import WarpingSums

__all__ = ["strand_warping"]


class Cells(NamedTuple):
    """A grid's rows and columns gathered into cells, with the integrals of their hat functions.

    row_cell (radial,), column_cell (angular,) : cell of each row and column.
    depths (rows of cells,) : their radial sizes [mm].
    widths, middles (columns of cells,) : their angles, and those of their middles [rad].
    radial (radial, 10) : over each row, f_a the hats of its cell's inner and outer radius: f_0²/r,
        f_0 f_1/r, f_1²/r, f_0 r, f_1 r, f_0, f_1, f_0 r², f_1 r², r³.
    angular (angular + 1, 10) : from the start to each column's edge, g_b the hats in θ: 1, g_0²,
        g_0 g_1, g_1², g_0, g_1, g_0 cos, g_1 cos, g_0 sin, g_1 sin.
    """

    row_cell: IndexArray
    column_cell: IndexArray
    depths: FloatArray
    widths: FloatArray
    middles: FloatArray
    radial: FloatArray
    angular: FloatArray


@lru_cache(maxsize=16)
def cells_of(grid: PolarGrid, rows: int, columns: int) -> Cells:
    """Gather the grid into rows × columns cells, as even as they come."""
    row_cell = np.arange(grid.radial) * rows // grid.radial
    column_cell = np.arange(grid.angular) * columns // grid.angular
    first_row = np.searchsorted(row_cell, np.arange(rows + 1))
    first_column = np.searchsorted(column_cell, np.arange(columns + 1))
    radii, angles = grid.edges[first_row], grid.angles[first_column]
    at, weight = np.polynomial.legendre.leggauss(6)
    share = (1 + at) / 2
    r = grid.edges[:-1, None] + np.diff(grid.edges)[:, None] * share
    dr = np.diff(grid.edges)[:, None] * weight / 2
    f1 = (r - radii[row_cell, None]) / np.diff(radii)[row_cell, None]
    f0 = 1 - f1
    radial = [f0 * f0 / r, f0 * f1 / r, f1 * f1 / r, f0 * r, f1 * r, f0, f1]
    radial += [f0 * r * r, f1 * r * r, r**3]
    theta = grid.angles[:-1, None] + np.diff(grid.angles)[:, None] * share
    dtheta = np.diff(grid.angles)[:, None] * weight / 2
    g1 = (theta - angles[column_cell, None]) / np.diff(angles)[column_cell, None]
    g0 = 1 - g1
    cos, sin = np.cos(theta), np.sin(theta)
    angular = [np.ones_like(g0), g0 * g0, g0 * g1, g1 * g1, g0, g1]
    angular += [g0 * cos, g1 * cos, g0 * sin, g1 * sin]
    steps = np.stack([(part * dtheta).sum(axis=1) for part in angular], axis=1)
    return Cells(
        row_cell,
        column_cell,
        np.diff(radii),
        np.diff(angles),
        (angles[:-1] + angles[1:]) / 2,
        np.stack([(part * dr).sum(axis=1) for part in radial], axis=1),
        np.concatenate([np.zeros((1, steps.shape[1])), np.cumsum(steps, axis=0)]),
    )


def strand_warping(
    grid: PolarGrid, labels: LabelArray, poissons_ratio: float, cells: tuple[int, int]
) -> WarpingSums:
    """Solve on `cells` = (radial, angular) coarse cells; the section has some material.

    The Poisson terms take each strand's centroid for all of it, an error of second order.
    """
    raw, gram, warping, second = np.zeros((4, 6)), np.zeros((3, 3)), np.zeros(2), np.zeros((2, 2))
    sum_moments(labels, grid.radial_integrals, grid.angular_integrals, raw)
    second[:] = [[raw[0, 3], raw[0, 5]], [raw[0, 5], raw[0, 4]]]
    poisson = poissons_ratio / (4 * (1 + poissons_ratio))
    gathered = cells_of(grid, *cells)
    is_disc = grid.inner_radius == 0
    _solve(labels, gathered, grid.is_full_ring, is_disc, poisson, gram, warping, second)
    return WarpingSums(gram, warping, second, -raw[0, 1:3] / raw[0, 0])


@compiled
def _solve(
    labels: LabelArray,
    cells: Cells,
    periodic: bool,
    has_axis: bool,
    poisson: float,
    gram: FloatArray,
    warping: FloatArray,
    second: FloatArray,
) -> None:
    strand = np.empty(labels.shape, dtype=np.int32)
    place = label_strands(labels, cells.row_cell, cells.column_cell, strand)
    corner, piece = join_corners(
        strand, cells.row_cell, cells.column_cell, place, periodic, has_axis
    )
    shape = cells.depths.size, cells.widths.size
    number, count = number_corners(corner, place, shape, periodic)
    sums = np.zeros((place.shape[0], 23))
    gram[0, 0] = _integrate(strand, cells, sums)
    centroids = _piece_centroids(sums, piece, second)

    width = 1
    for s in range(place.shape[0]):
        width = max(width, number[s].max() - number[s].min() + 1)
    band = np.zeros((count, width))
    loads, masses = np.zeros((3, count)), np.zeros((2, count))
    for s in range(place.shape[0]):
        depth, angle = cells.depths[place[s, 0]], cells.widths[place[s, 1]]
        _add_stiffness(sums[s], depth, angle, number[s], band)
        own = centroids[piece[s]]
        middle = cells.middles[place[s, 1]]
        _add_loads(sums[s], depth, angle, middle, own, poisson, number[s], loads, masses, gram)
    for s in range(place.shape[0]):
        if piece[s] == s:  # ω is free up to a constant in every piece: hold one corner
            band[number[s, 0], 0] *= 2

    values = loads.copy()
    values[1:] += masses
    sides = values.copy()
    solve_banded(band, values)
    # K u = f, so that ∫ (∇u_a − d_a)·(∇u_b − d_b) = u_a·f_b − u_a·l_b − l_a·u_b + ∫ d_a·d_b
    for a in range(3):
        for b in range(a, 3):
            total = gram[a, b]
            for k in range(count):
                total += values[a, k] * (sides[b, k] - loads[b, k]) - loads[a, k] * values[b, k]
            gram[a, b] = gram[b, a] = total
    for j in range(2):
        for k in range(count):
            warping[j] += values[0, k] * masses[j, k]


@compiled
def _integrate(strand: NDArray[np.int32], cells: Cells, sums: FloatArray) -> float:
    """Integrals over each strand to `sums` (strands, 23), run by run of a row; and ∫ r² dA.

    0…2 ∫ g g' dθ; 3…5 ∫ f f'/r dr dθ; 6, 7 ∫ f r; 8, 9 ∫ f; 10…13 ∫ N dA (corners 2a + b);
    14…17 ∫ N x dA; 18…21 ∫ N y dA; 22 ∫ r dA.
    """
    rows, columns = strand.shape
    run = np.empty(10)
    polar = 0.0
    for i in range(rows):
        r = cells.radial[i]
        first = 0
        for j in range(columns):
            s = strand[i, j]
            if j + 1 < columns and strand[i, j + 1] == s:
                continue
            if s >= 0:
                for q in range(10):
                    run[q] = cells.angular[j + 1, q] - cells.angular[first, q]
                out = sums[s]
                for q in range(3):
                    out[q] += run[1 + q]
                    out[3 + q] += r[q] * run[0]
                for a in range(2):
                    out[6 + a] += r[3 + a] * run[0]
                    out[8 + a] += r[5 + a] * run[0]
                    for b in range(2):
                        out[10 + 2 * a + b] += r[3 + a] * run[4 + b]
                        out[14 + 2 * a + b] += r[7 + a] * run[6 + b]
                        out[18 + 2 * a + b] += r[7 + a] * run[8 + b]
                out[22] += (r[7] + r[8]) * run[0]
                polar += r[9] * run[0]
            first = j + 1
    for s in range(sums.shape[0]):  # ∫ r dr is the same for all rows
        for q in range(3):
            sums[s, q] *= cells.radial[0, 3] + cells.radial[0, 4]
    return polar


@compiled
def _piece_centroids(sums: FloatArray, piece: IndexArray, second: FloatArray) -> FloatArray:
    """(n, 2) centroids of the pieces at their lowest strands; `second` moved to them (Steiner)."""
    first = np.zeros((piece.size, 3))
    for s in range(piece.size):
        for f in range(3):
            first[piece[s], f] += sums[s, 10 + 4 * f : 14 + 4 * f].sum()
    centroids = np.zeros((piece.size, 2))
    for s in range(piece.size):
        if piece[s] == s:
            centroids[s] = first[s, 1:] / first[s, 0]
            for i in range(2):
                for j in range(2):
                    second[i, j] -= first[s, 0] * centroids[s, i] * centroids[s, j]
    return centroids


@compiled
def _add_stiffness(
    sums: FloatArray, depth: float, angle: float, number: IndexArray, band: FloatArray
) -> None:
    """∫ ∇N·∇N' dA of one strand."""
    for p in range(4):
        for q in range(4):
            if number[p] >= number[q]:
                radial, angular = p // 2 + q // 2, p % 2 + q % 2
                value = sums[angular] / depth**2 * (1 if radial != 1 else -1)
                value += sums[3 + radial] / angle**2 * (1 if angular != 1 else -1)
                band[number[q], number[p] - number[q]] += value


@compiled
def _add_loads(
    sums: FloatArray,
    depth: float,
    angle: float,
    middle: float,
    own: FloatArray,
    poisson: float,
    number: IndexArray,
    loads: FloatArray,
    masses: FloatArray,
    gram: FloatArray,
) -> None:
    """∫ ∇N·d dA and ∫ N (x, y) dA of one strand, and ∫ d·d dA.

    d is (y, −x) for torsion and D e_j for shear, D = ν/(4(1 + ν)) [[x² − y², 2xy], [2xy, y² − x²]].
    """
    area = sums[10:14].sum()
    x, y = sums[14:18].sum() / area - own[0], sums[18:22].sum() / area - own[1]
    squares, product = poisson * (x * x - y * y), poisson * 2 * x * y
    c, s = np.cos(middle), np.sin(middle)
    radial = (c * squares + s * product, c * product - s * squares)
    angular = (c * product - s * squares, -s * product - c * squares)
    for p in range(4):
        a, b = p // 2, p % 2
        outwards, onwards = 2.0 * a - 1, 2.0 * b - 1
        along_r = outwards / depth * (sums[10 + b] + sums[12 + b])
        along_theta = onwards / angle * sums[8 + a]
        loads[0, number[p]] -= onwards / angle * sums[6 + a]
        for j in range(2):
            loads[1 + j, number[p]] += along_r * radial[j] + along_theta * angular[j]
            masses[j, number[p]] += sums[14 + 4 * j + p] - own[j] * sums[10 + p]
    for i in range(2):
        gram[0, 1 + i] -= sums[22] * angular[i]
        for j in range(2):
            gram[1 + i, 1 + j] += area * (radial[i] * radial[j] + angular[i] * angular[j])


@compiled
def solve_banded(band: FloatArray, sides: FloatArray) -> None:
    """Solve A u = f for the rows f of `sides` (m, n), in place, by A = L D Lᵀ; `band` is used up.

    band : (n, width) lower half of A by columns, `band[k, d]` = A[k + d, k].

    Rows of L that stay empty are skipped: where the section has gaps, most of them are.
    """
    n, width = band.shape
    filled = np.empty(width, dtype=np.int64)
    for k in range(n):
        column = band[k]
        pivot = column[0]
        count, last = 0, 0
        for d in range(1, min(width, n - k)):
            if column[d] != 0:
                filled[count] = d
                count += 1
                last = d
        for d in filled[:count]:
            factor = column[d] / pivot
            rest, row = column[d : last + 1], band[k + d]
            for e in range(rest.shape[0]):
                row[e] -= factor * rest[e]
        for d in filled[:count]:
            column[d] /= pivot
            for m in range(sides.shape[0]):
                sides[m, k + d] -= column[d] * sides[m, k]
    for m in range(sides.shape[0]):
        side = sides[m]
        for k in range(n - 1, -1, -1):
            value = side[k] / band[k, 0]
            for d in range(1, min(width, n - k)):
                value -= band[k, d] * side[k + d]
            side[k] = value
