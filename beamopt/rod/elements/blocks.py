"""Block-tridiagonal systems: elimination from the base to the tip, and the inertia it shows."""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.compiled import compiled
from beamopt.rod.elements.energy import Blocks, Mesh

__all__ = ["constrain", "eliminate", "substitute"]


@compiled
def constrain(mesh: Mesh, blocks: Blocks, right: FloatArray, values: FloatArray) -> None:
    """Make held increments of the base and the tip unknowns that equal `values` (2, 6)."""
    last = right.shape[0] - 1
    for end in range(2):
        node = 0 if end == 0 else last
        link = 0 if end == 0 else last - 1
        other = 1 if end == 0 else last - 1
        for j in range(6):
            if not mesh.held[end, j]:
                continue
            for i in range(6):
                own = blocks.diagonal[node, i, j]
                far = blocks.below[link, i, j] if end == 0 else blocks.above[link, j, i]
                right[node, i] -= own * values[end, j]
                right[other, i] -= far * values[end, j]
                blocks.diagonal[node, i, j] = 0.0
                blocks.diagonal[node, j, i] = 0.0
                if end == 0:
                    blocks.below[link, i, j] = 0.0
                    blocks.above[link, i, j] = 0.0
                else:
                    blocks.above[link, j, i] = 0.0
                    blocks.below[link, j, i] = 0.0
            blocks.diagonal[node, j, j] = 1.0
        for j in range(6):
            if mesh.held[end, j]:
                right[node, j] = values[end, j]


@compiled
def split(a: FloatArray) -> int:
    """Replace a (6, 6) by its factors L U without pivoting; the number of negative pivots.

    If a is symmetric, that is its number of negative eigenvalues (Sylvester), as U = D Lᵀ.
    """
    negative = 0
    for k in range(6):
        if not a[k, k] > 0:
            negative += 1
        for i in range(k + 1, 6):
            a[i, k] /= a[k, k]
            for j in range(k + 1, 6):
                a[i, j] -= a[i, k] * a[k, j]
    return negative


@compiled
def backwards(a: FloatArray, x: FloatArray) -> None:
    """Solve in place for the rows of x (m, 6), given the factors of `split`."""
    for c in range(x.shape[0]):
        for i in range(6):
            for j in range(i):
                x[c, i] -= a[i, j] * x[c, j]
        for back in range(6):
            i = 5 - back
            for j in range(i + 1, 6):
                x[c, i] -= a[i, j] * x[c, j]
            x[c, i] /= a[i, i]


@compiled
def eliminate(blocks: Blocks) -> int:
    """Factorise in place; the number of negative pivots.

    Afterwards diagonal holds the factors of S_i = A_i − B_i S_{i−1}⁻¹ C_{i−1}, above S_i⁻¹ C_i
    (transposed).
    """
    negative = split(blocks.diagonal[0])
    product = np.empty((6, 6))
    for i in range(blocks.below.shape[0]):
        backwards(blocks.diagonal[i], blocks.above[i])
        for r in range(6):
            for c in range(6):
                total = 0.0
                for k in range(6):
                    total += blocks.below[i, r, k] * blocks.above[i, c, k]
                product[r, c] = total
        for r in range(6):
            for c in range(6):
                blocks.diagonal[i + 1, r, c] -= product[r, c]
        negative += split(blocks.diagonal[i + 1])
    return negative


@compiled
def substitute(blocks: Blocks, x: FloatArray) -> None:
    """Solve in place for x (n + 1, 6), given what `eliminate` left."""
    n = blocks.below.shape[0]
    for i in range(n + 1):
        if i > 0:
            for r in range(6):
                for k in range(6):
                    x[i, r] -= blocks.below[i - 1, r, k] * x[i - 1, k]
        backwards(blocks.diagonal[i], x[i : i + 1])
    for back in range(n):
        i = n - 1 - back
        for r in range(6):
            for k in range(6):
                x[i, r] -= blocks.above[i, k, r] * x[i + 1, k]
