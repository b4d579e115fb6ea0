"""Volumes that wall facets enclose, with first and second derivatives."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray, IndexArray
from beamopt.base.compiled import compiled

__all__ = ["add_wall_forces", "add_wall_stiffness", "wall_volumes"]


@compiled
def wall_volumes(
    x: FloatArray,
    walls: IndexArray,
    supply: IndexArray,
    values: FloatArray,
    along: FloatArray,
    across: FloatArray,
    weights: FloatArray,
    volumes: FloatArray,
) -> None:
    """Add −⅓ Σ ∫ x · (x,s × x,t) to each supply's volume (3,) [mm³].

    Facets are oriented with their normal out of the material, which is into the chamber.
    """
    y = np.empty((3, 3))  # position, derivative along, derivative across
    for f in range(walls.shape[0]):
        for g in range(weights.size):
            _at_point(x, walls[f], values[g], along[g], across[g], y)
            p, s, t = y[0], y[1], y[2]
            triple = p[0] * (s[1] * t[2] - s[2] * t[1]) + p[1] * (s[2] * t[0] - s[0] * t[2])
            triple += p[2] * (s[0] * t[1] - s[1] * t[0])
            volumes[supply[f] - 1] -= weights[g] * triple / 3


@compiled
def add_wall_forces(
    x: FloatArray,
    walls: IndexArray,
    scale: FloatArray,
    values: FloatArray,
    along: FloatArray,
    across: FloatArray,
    weights: FloatArray,
    forces: FloatArray,
) -> None:
    """Add Σ scale_f ∂V_f/∂x to the forces (n, 3).

    The derivative of p · (s × t) is s × t for p, t × p for s and p × s for t.
    """
    facets, nodes = walls.shape
    y = np.empty((3, 3))  # position, derivative along, derivative across
    for f in range(facets):
        for g in range(weights.size):
            _at_point(x, walls[f], values[g], along[g], across[g], y)
            w = -scale[f] * weights[g] / 3
            for i in range(3):
                j, k = (i + 1) % 3, (i + 2) % 3
                by_p = w * (y[1, j] * y[2, k] - y[1, k] * y[2, j])
                by_s = w * (y[2, j] * y[0, k] - y[2, k] * y[0, j])
                by_t = w * (y[0, j] * y[1, k] - y[0, k] * y[1, j])
                for a in range(nodes):
                    forces[walls[f, a], i] += (
                        values[g, a] * by_p + along[g, a] * by_s + across[g, a] * by_t
                    )


@compiled
def add_wall_stiffness(
    x: FloatArray,
    walls: IndexArray,
    scale: FloatArray,
    values: FloatArray,
    along: FloatArray,
    across: FloatArray,
    weights: FloatArray,
    blocks: IndexArray,
    places: NDArray[np.int32],
    starts: IndexArray,
    data: FloatArray,
) -> None:
    """Add Σ scale_f ∂²V_f/∂x∂x, which is symmetric facet by facet, to the upper triangle."""
    facets, nodes = walls.shape
    y, turn = np.empty((3, 3)), np.empty(3)
    for f in range(facets):
        for g in range(weights.size):
            _at_point(x, walls[f], values[g], along[g], across[g], y)
            w = -scale[f] * weights[g] / 3
            for a in range(nodes):
                A = blocks[f, a]
                for b in range(nodes):
                    if A < 0 or blocks[f, b] < A:
                        continue
                    n, d, c = values[g, a], along[g, a], across[g, a]
                    m, e, h = values[g, b], along[g, b], across[g, b]
                    # second derivative of p·(s×t): δa · (turn × δb)
                    for i in range(3):
                        turn[i] = -w * (
                            (d * h - c * e) * y[0, i]
                            + (c * m - n * h) * y[1, i]
                            + (n * e - d * m) * y[2, i]
                        )
                    for i in range(3):
                        first = starts[3 * A + i] + 3 * places[f, a, b] - i
                        for j in range(i if a == b else 0, 3):
                            if i != j:
                                k = 3 - i - j
                                sign = -1.0 if (j - i) % 3 == 1 else 1.0
                                data[first + j] += sign * turn[k]


@compiled
def _at_point(
    x: FloatArray,
    wall: IndexArray,
    values: FloatArray,
    along: FloatArray,
    across: FloatArray,
    y: FloatArray,
) -> None:
    y[:] = 0.0
    for a in range(wall.size):
        for i in range(3):
            here = x[wall[a], i]
            y[0, i] += values[a] * here
            y[1, i] += along[a] * here
            y[2, i] += across[a] * here
