"""Meshes of quadrilaterals for sections whose torsion and shear are known."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray

Mesh = tuple[FloatArray, IndexArray]


def patch(
    place: Callable[[FloatArray, FloatArray], tuple[FloatArray, FloatArray]], n: int, m: int
) -> Mesh:
    """The unit square cut into n × m quads, put where `place` takes it."""
    u, v = np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, m + 1), indexing="ij")
    i, j = (part.ravel() for part in np.mgrid[:n, :m])
    first = i * (m + 1) + j
    quads = np.stack([first, first + m + 1, first + m + 2, first + 1], axis=1)
    return np.stack(place(u, v), axis=-1).reshape(-1, 2), quads


def together(*meshes: Mesh) -> Mesh:
    """Meshes side by side; nodes at the same place become one."""
    starts = np.cumsum([0] + [nodes.shape[0] for nodes, _ in meshes])
    nodes = np.concatenate([nodes for nodes, _ in meshes])
    quads = np.concatenate([quads + k for (_, quads), k in zip(meshes, starts, strict=False)])
    _, first, number = np.unique(nodes.round(9), axis=0, return_index=True, return_inverse=True)
    return nodes[first], number.ravel()[quads]


def rectangle(width: float, height: float, n: int, m: int, x: float = 0, y: float = 0) -> Mesh:
    return patch(lambda u, v: (x + u * width, y + v * height), n, m)


def arc(radius: float, thickness: float, first: float, last: float, n: int, m: int) -> Mesh:
    """A curved strip around the origin, n quads through the thickness; angles in degrees."""

    def place(u: FloatArray, v: FloatArray) -> tuple[FloatArray, FloatArray]:
        r = radius + (u - 0.5) * thickness
        angle = np.radians(first + v * (last - first))
        return r * np.cos(angle), r * np.sin(angle)

    return patch(place, n, m)


def triangle(height: float, n: int) -> Mesh:
    """An equilateral triangle as three kites of n × n quads."""
    corners = (
        height * np.array([[np.cos(a), np.sin(a)] for a in np.radians([90, 210, 330])]) * 2 / 3
    )
    kites = []
    for k in range(3):
        a, b, c = corners[k], corners[k - 1], corners[(k + 1) % 3]
        kite = np.array([[a, (a + b) / 2], [(a + c) / 2, corners.mean(axis=0)]])

        def place(
            u: FloatArray, v: FloatArray, kite: FloatArray = kite
        ) -> tuple[FloatArray, FloatArray]:
            p = np.einsum("a...,b...,abi->i...", np.stack([1 - u, u]), np.stack([1 - v, v]), kite)
            return p[0], p[1]

        kites.append(patch(place, n, n))
    return together(*kites)


def turn(degrees: float) -> FloatArray:
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[c, -s], [s, c]])
