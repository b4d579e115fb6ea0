"""The Saint-Venant solve of a section on bilinear quadrilaterals or quadratic triangles."""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray, LabelArray
from beamopt.section.feature_points import MATERIAL
from beamopt.section.grid import PolarGrid
from beamopt.section.warping_sums import WarpingSums

__all__ = ["cell_warping", "section_quads"]

CORNERS = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
DUNAVANT = np.array(
    [[0.445948490915965, 0.223381589678011], [0.091576213509771, 0.109951743655322]]
)
"""Of two orbits of three points in a triangle: barycentric coordinate, weight (Dunavant 1985)."""


def cell_warping(nodes: FloatArray, cells: IndexArray, poissons_ratio: float) -> WarpingSums:
    """Solve for ω, ψ_1, ψ_2 on at least one cell; see `saint_venant`.

    K ω = ∫ ∇N·g with g = (y, −x), K ψ_j = ∫ N x_j + ∇N·D e_j with
    D = ν/(4(1 + ν)) [[x² − y², 2xy], [2xy, y² − x²]]: Pilkey, Analysis and Design of Elastic Beams
    (2002), 5.4 and 6.3, his loads divided by 2(1 + ν) and taken along the axes. The stresses are
    τ_0 = ∇ω − g, τ_j = ∇ψ_j − D e_j. Each piece bends about its own centroid.
    """
    used, numbers = np.unique(cells, return_inverse=True)
    cells = numbers.reshape(cells.shape)
    count = used.size
    shapes, gradients, at, dA = _elements(nodes[used], cells)
    part = _pieces(cells, count)

    of_cell = part[cells[:, 0]]
    areas = np.bincount(of_cell, dA.sum(axis=1))
    first = [np.bincount(of_cell, (at[..., i] * dA).sum(axis=1)) for i in range(2)]
    own = np.stack(first, axis=1) / areas[:, None]
    centroid = areas @ own / areas.sum()
    from_own, about = at - own[of_cell][:, None], at - centroid

    x, y = from_own[..., 0], from_own[..., 1]
    squares, product = x * x - y * y, 2 * x * y
    poisson = poissons_ratio / (4 * (1 + poissons_ratio))
    fields = np.empty((*at.shape, 3))  # g, D e_1, D e_2
    fields[..., 0] = np.stack([about[..., 1], -about[..., 0]], axis=-1)
    fields[..., 1] = poisson * np.stack([squares, product], axis=-1)
    fields[..., 2] = poisson * np.stack([product, -squares], axis=-1)

    stiffness = np.einsum("egik,egil,eg->ekl", gradients, gradients, dA, optimize=True)
    load = np.einsum("egik,egif,eg->ekf", gradients, fields, dA, optimize=True)
    mass = np.einsum("gk,egj,eg->ekj", shapes, from_own, dA, optimize=True)
    loads, masses = _gather(cells, load, count), _gather(cells, mass, count)
    sides = loads.copy()
    sides[:, 1:] += masses
    values = _solve(cells, stiffness, sides, np.unique(part, return_index=True)[1])

    # K u = f, so that ∫ (∇u_a − d_a)·(∇u_b − d_b) = u_a·f_b − u_a·l_b − l_a·u_b + ∫ d_a·d_b
    gram = values.T @ (sides - loads) - loads.T @ values
    gram += np.einsum("egia,egib,eg->ab", fields, fields, dA, optimize=True)
    second = np.einsum("egi,egj,eg->ij", from_own, from_own, dA, optimize=True)
    return WarpingSums((gram + gram.T) / 2, values[:, 0] @ masses, second, np.zeros(2))


def section_quads(grid: PolarGrid, labels: LabelArray) -> tuple[FloatArray, IndexArray]:
    """Mesh the material of a raster: nodes (n, 2) [mm] and quads (m, 4).

    Elements are neighbours over edges: where two meet in nothing but a corner each has a node of
    its own, as pieces are counted.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    i, j = np.nonzero(labels == MATERIAL)
    count = i.size
    element = np.full((grid.radial + 1, grid.angular + 1), -1)
    element[i, j] = np.arange(count)
    if grid.is_full_ring:
        element[:, -1] = element[:, 0]
    here, out, on = element[:-1, :-1], element[1:, :-1], element[:-1, 1:]
    pairs = []
    for other, joined in ((out, ((1, 0), (2, 3))), (on, ((3, 0), (2, 1)))):
        both = (here >= 0) & (other >= 0)
        pairs += [(4 * here[both] + a, 4 * other[both] + b) for a, b in joined]
    if grid.inner_radius == 0:
        pairs.append((4 * here[0][here[0] >= 0], 4 * here[0][here[0] >= 0] + 3))
    a, b = np.concatenate(pairs, axis=1)
    graph = coo_array((np.ones(a.size), (a, b)), shape=(4 * count, 4 * count))
    total, node = connected_components(graph, directed=False)
    radius = grid.edges[np.stack([i, i + 1, i + 1, i], axis=1)].ravel()
    angle = grid.angles[np.stack([j, j, j + 1, j + 1], axis=1)].ravel()
    nodes = np.empty((total, 2))
    nodes[node] = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
    return nodes, node.reshape(count, 4).astype(np.int64)


def _elements(
    nodes: FloatArray, cells: IndexArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """At the g Gauss points of m cells with n nodes.

    N (g, n), ∇N (m, g, 2, n), places (m, g, 2), areas dA (m, g).
    """
    shapes, slopes, weights = _quadrilateral() if cells.shape[1] == 4 else _triangle()
    corners = nodes[cells]
    jacobian = np.einsum("gak,eki->egai", slopes, corners, optimize=True)
    (xa, ya), (xb, yb) = np.moveaxis(jacobian, (-2, -1), (0, 1))
    determinant = xa * yb - ya * xb
    inverse = np.stack([np.stack([yb, -ya], -1), np.stack([-xb, xa], -1)], -2)
    gradients = np.einsum("egia,gak->egik", inverse, slopes, optimize=True)
    gradients /= determinant[..., None, None]
    at = np.einsum("gk,eki->egi", shapes, corners, optimize=True)
    return shapes, gradients, at, np.abs(determinant) * weights


def _quadrilateral() -> tuple[FloatArray, FloatArray, FloatArray]:
    """Bilinear N (9, 4), their derivatives (9, 2, 4) and the weights (9,) of 3 × 3 Gauss points."""
    line, weight = np.polynomial.legendre.leggauss(3)
    local = np.stack(np.meshgrid(line, line, indexing="ij"), axis=-1).reshape(-1, 2)
    factors = 1 + local[:, None, :] * CORNERS
    slopes = np.stack([CORNERS[:, 0] * factors[..., 1], CORNERS[:, 1] * factors[..., 0]], 1) / 4
    return factors.prod(axis=-1) / 4, slopes, np.outer(weight, weight).ravel()


def _triangle() -> tuple[FloatArray, FloatArray, FloatArray]:
    """Quadratic N (6, 6), derivatives (6, 2, 6) and weights (6,) of a rule of fourth degree.

    Corners first, then the middles of the sides from each corner to the next.
    """
    at, weight = (np.repeat(values, 3) for values in (DUNAVANT[:, 0], DUNAVANT[:, 1]))
    barycentric = np.repeat(at[:, None], 3, axis=1)
    barycentric[np.arange(6), np.arange(6) % 3] = 1 - 2 * at
    slopes_of = np.array([[-1.0, 1.0, 0.0], [-1.0, 0.0, 1.0]])
    following = np.roll(barycentric, -1, axis=1)
    shapes = np.hstack([barycentric * (2 * barycentric - 1), 4 * barycentric * following])
    own, after = slopes_of[None], np.roll(slopes_of, -1, axis=1)[None]
    corner = (4 * barycentric - 1)[:, None] * own
    middle = 4 * (barycentric[:, None] * after + following[:, None] * own)
    return shapes, np.concatenate([corner, middle], axis=2), weight / 2


def _pieces(cells: IndexArray, count: int) -> IndexArray:
    """(count,) connected piece of each node."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    ends = np.repeat(cells[:, 0], cells.shape[1] - 1), cells[:, 1:].ravel()
    graph = coo_array((np.ones(ends[0].size), ends), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.int64)


def _gather(cells: IndexArray, load: FloatArray, count: int) -> FloatArray:
    """Sum element vectors (m, n, f) at the nodes: (count, f)."""
    sums = [np.bincount(cells.ravel(), part.ravel(), count) for part in np.moveaxis(load, -1, 0)]
    return np.stack(sums, axis=1)


def _solve(
    cells: IndexArray, stiffness: FloatArray, sides: FloatArray, pins: IndexArray
) -> FloatArray:
    """Solve with one factorisation for all columns of `sides`, the nodes `pins` held at zero."""
    from scipy.sparse import coo_array, csc_array
    from scipy.sparse.linalg import splu

    count, corners = sides.shape[0], cells.shape[1]
    places = np.repeat(cells, corners, axis=1).ravel(), np.tile(cells, (1, corners)).ravel()
    matrix = csc_array(coo_array((stiffness.ravel(), places), shape=(count, count)))
    free = np.delete(np.arange(count), pins)
    values = np.zeros_like(sides)
    if free.size:
        inner = csc_array(matrix[free][:, free])
        factors = splu(
            inner,
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
        values[free] = factors.solve(sides[free])
    return values
