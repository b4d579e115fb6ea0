"""Deformation, nodal forces and stiffness of all elements (total Lagrangian)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray, IndexArray
from beamopt.base.compiled import compiled

__all__ = ["add_element_forces", "add_element_stiffness", "deformation"]


@compiled
def deformation(
    x: FloatArray, connectivity: IndexArray, gradients: FloatArray, F: FloatArray, C: FloatArray
) -> float:
    """Fill F (e, q, 3, 3) and C = FᵀF (e, q, 6: 11, 22, 33, 12, 23, 13); return the least det F.

    x : (n, 3) deformed positions of the nodes [mm].
    """
    elements, points, _, nodes = gradients.shape
    least = np.inf
    for e in range(elements):
        for q in range(points):
            f, g = F[e, q], gradients[e, q]
            f[:] = 0.0
            for a in range(nodes):
                node = connectivity[e, a]
                for i in range(3):
                    for j in range(3):
                        f[i, j] += x[node, i] * g[j, a]
            c = C[e, q]
            for k in range(3):
                c[k] = f[0, k] * f[0, k] + f[1, k] * f[1, k] + f[2, k] * f[2, k]
            c[3] = f[0, 0] * f[0, 1] + f[1, 0] * f[1, 1] + f[2, 0] * f[2, 1]
            c[4] = f[0, 1] * f[0, 2] + f[1, 1] * f[1, 2] + f[2, 1] * f[2, 2]
            c[5] = f[0, 0] * f[0, 2] + f[1, 0] * f[1, 2] + f[2, 0] * f[2, 2]
            determinant = (
                f[0, 0] * (f[1, 1] * f[2, 2] - f[1, 2] * f[2, 1])
                - f[0, 1] * (f[1, 0] * f[2, 2] - f[1, 2] * f[2, 0])
                + f[0, 2] * (f[1, 0] * f[2, 1] - f[1, 1] * f[2, 0])
            )
            least = min(least, determinant)
    return least


@compiled
def add_element_forces(
    connectivity: IndexArray,
    gradients: FloatArray,
    weights: FloatArray,
    F: FloatArray,
    S: FloatArray,
    forces: FloatArray,
) -> None:
    """Add the internal forces ∂Π/∂x (n, 3) [mN]: Σ w (F S) G."""
    elements, points, _, nodes = gradients.shape
    P = np.empty((3, 3))
    for e in range(elements):
        for q in range(points):
            f, s, g = F[e, q], S[e, q], gradients[e, q]
            w = weights[e, q]
            for i in range(3):
                P[i, 0] = w * (f[i, 0] * s[0] + f[i, 1] * s[3] + f[i, 2] * s[5])
                P[i, 1] = w * (f[i, 0] * s[3] + f[i, 1] * s[1] + f[i, 2] * s[4])
                P[i, 2] = w * (f[i, 0] * s[5] + f[i, 1] * s[4] + f[i, 2] * s[2])
            for a in range(nodes):
                node = connectivity[e, a]
                for i in range(3):
                    forces[node, i] += P[i, 0] * g[0, a] + P[i, 1] * g[1, a] + P[i, 2] * g[2, a]


@compiled
def add_element_stiffness(
    gradients: FloatArray,
    weights: FloatArray,
    F: FloatArray,
    S: FloatArray,
    D: FloatArray,
    blocks: IndexArray,
    places: NDArray[np.int32],
    starts: IndexArray,
    data: FloatArray,
) -> None:
    """Add the tangent ∂²Π/∂x∂x to the upper triangle `data`; see `Pattern` for where it goes.

    D : (e, q, 6, 6) ∂S/∂E. blocks : (e, a) row of each node's block, −1 where it is held.
    """
    elements, points, _, nodes = gradients.shape
    size = 3 * nodes
    # all points of an element below each other: one product with BLAS an element
    B, DB = np.empty((6 * points, size)), np.empty((6 * points, size))
    G, SG = np.empty((3 * points, nodes)), np.empty((3 * points, nodes))
    K, along = np.empty((size, size)), np.empty((nodes, nodes))
    for e in range(elements):
        for q in range(points):
            w, g = weights[e, q], gradients[e, q]
            rows = B[6 * q : 6 * q + 6]
            _strain_matrix(F[e, q], g, rows)
            _times(D[e, q], w, rows, DB[6 * q : 6 * q + 6])
            G[3 * q : 3 * q + 3] = g
            _stressed(S[e, q], w, g, SG[3 * q : 3 * q + 3])
        np.dot(B.T, DB, K)
        np.dot(G.T, SG, along)
        _scatter(K, along, blocks[e], places[e], starts, data)


@compiled
def _strain_matrix(f: FloatArray, g: FloatArray, B: FloatArray) -> None:
    """δE (with doubled shears) by δx; columns node by node within a component."""
    nodes = g.shape[1]
    for i in range(3):
        f0, f1, f2 = f[i, 0], f[i, 1], f[i, 2]
        part = B[:, i * nodes : (i + 1) * nodes]
        for a in range(nodes):
            g0, g1, g2 = g[0, a], g[1, a], g[2, a]
            part[0, a] = f0 * g0
            part[1, a] = f1 * g1
            part[2, a] = f2 * g2
            part[3, a] = f0 * g1 + f1 * g0
            part[4, a] = f1 * g2 + f2 * g1
            part[5, a] = f0 * g2 + f2 * g0


@compiled
def _times(D: FloatArray, weight: float, B: FloatArray, DB: FloatArray) -> None:
    size = B.shape[1]
    for u in range(6):
        row = DB[u]
        row[:] = 0.0
        for v in range(6):
            d = weight * D[u, v]
            if d != 0.0:
                other = B[v]
                for m in range(size):
                    row[m] += d * other[m]


@compiled
def _stressed(s: FloatArray, weight: float, g: FloatArray, SG: FloatArray) -> None:
    """Weighted S·G: with Gᵀ before it the stiffness of initial stress, alike for all components."""
    for a in range(g.shape[1]):
        g0, g1, g2 = g[0, a], g[1, a], g[2, a]
        SG[0, a] = weight * (s[0] * g0 + s[3] * g1 + s[5] * g2)
        SG[1, a] = weight * (s[3] * g0 + s[1] * g1 + s[4] * g2)
        SG[2, a] = weight * (s[5] * g0 + s[4] * g1 + s[2] * g2)


@compiled
def _scatter(
    K: FloatArray,
    along: FloatArray,
    blocks: IndexArray,
    places: NDArray[np.int32],
    starts: IndexArray,
    data: FloatArray,
) -> None:
    nodes = blocks.size
    for a in range(nodes):
        A = blocks[a]
        for b in range(nodes):
            if A < 0 or blocks[b] < A:
                continue
            diagonal = a == b
            for i in range(3):
                first = starts[3 * A + i] + 3 * places[a, b] - i
                for j in range(i if diagonal else 0, 3):
                    p, m = i * nodes + a, j * nodes + b
                    data[first + j] += K[p, m] + (along[a, b] if i == j else 0.0)
