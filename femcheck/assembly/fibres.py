"""Fibres that lie on facets: stretch, and what their tension adds to forces and stiffness."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray, IndexArray
from beamopt.base.compiled import compiled

__all__ = ["add_fibre_forces", "add_fibre_stiffness", "fibre_vectors"]


@compiled
def fibre_vectors(
    x: FloatArray, facets: IndexArray, gradients: FloatArray, out: FloatArray
) -> None:
    """Fill (f, g, 3) with the deformed fibre that was a unit vector; its length is the stretch.

    gradients : (f, g, b) derivative of the shape functions along the undeformed fibre [1/mm].
    """
    count, points, nodes = gradients.shape
    out[:] = 0.0
    for f in range(count):
        for g in range(points):
            for a in range(nodes):
                slope = gradients[f, g, a]
                for i in range(3):
                    out[f, g, i] += slope * x[facets[f, a], i]


@compiled
def add_fibre_forces(
    facets: IndexArray,
    gradients: FloatArray,
    vectors: FloatArray,
    tension: FloatArray,
    forces: FloatArray,
) -> None:
    """Add Σ tension · direction · gradient to the forces (n, 3).

    tension : (f, g) [mN/mm] times the area [mm²] of its point.
    """
    count, points, nodes = gradients.shape
    for f in range(count):
        for g in range(points):
            v = vectors[f, g]
            length = np.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
            pull = tension[f, g] / length
            for a in range(nodes):
                for i in range(3):
                    forces[facets[f, a], i] += pull * v[i] * gradients[f, g, a]


@compiled
def add_fibre_stiffness(
    gradients: FloatArray,
    vectors: FloatArray,
    tension: FloatArray,
    stiffness: FloatArray,
    blocks: IndexArray,
    places: NDArray[np.int32],
    starts: IndexArray,
    data: FloatArray,
) -> None:
    """Add the fibres' stiffness to the upper triangle `data`.

    Along the fibre the law's, across it tension over stretch.
    tension, stiffness : (f, g) [mN/mm], times the area of the point.
    """
    count, points, nodes = gradients.shape
    H = np.empty((3, 3))
    for f in range(count):
        for g in range(points):
            v = vectors[f, g]
            square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2]
            across = tension[f, g] / np.sqrt(square)
            along = (stiffness[f, g] - across) / square
            for i in range(3):
                for j in range(3):
                    H[i, j] = along * v[i] * v[j]
                H[i, i] += across
            for a in range(nodes):
                A = blocks[f, a]
                for b in range(nodes):
                    if A < 0 or blocks[f, b] < A:
                        continue
                    both = gradients[f, g, a] * gradients[f, g, b]
                    for i in range(3):
                        first = starts[3 * A + i] + 3 * places[f, a, b] - i
                        for j in range(i if a == b else 0, 3):
                            data[first + j] += both * H[i, j]
