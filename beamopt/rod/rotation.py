"""Vectors and rotations along a rod: products, exponential, logarithm, steps of sixth order."""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.compiled import compiled, inlined

__all__ = [
    "GAUSS_3",
    "Vector",
    "cross3",
    "crossed",
    "local",
    "magnus_step",
    "multiply_rotation",
    "rotation_vector",
    "spatial",
]

GAUSS_3: FloatArray = np.array([0.5 - np.sqrt(0.15), 0.5, 0.5 + np.sqrt(0.15)])
"""Where a step looks at the curvature, as shares of its length."""

ROOT_15 = float(np.sqrt(15.0))

Vector = tuple[float, float, float]


@inlined
def cross3(a: Vector, b: Vector) -> Vector:
    """a × b."""
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


@inlined
def crossed(a: FloatArray, i: int, b: FloatArray, j: int) -> Vector:
    """Row i of a × row j of b."""
    x, y, z = a[i, 0], a[i, 1], a[i, 2]
    u, v, w = b[j, 0], b[j, 1], b[j, 2]
    return y * w - z * v, z * u - x * w, x * v - y * u


@inlined
def spatial(rotations: FloatArray, i: int, x: float, y: float, z: float) -> Vector:
    """R_i (x, y, z): from the section's axes to space."""
    R = rotations
    return (
        R[i, 0, 0] * x + R[i, 0, 1] * y + R[i, 0, 2] * z,
        R[i, 1, 0] * x + R[i, 1, 1] * y + R[i, 1, 2] * z,
        R[i, 2, 0] * x + R[i, 2, 1] * y + R[i, 2, 2] * z,
    )


@inlined
def local(rotations: FloatArray, i: int, x: float, y: float, z: float) -> Vector:
    """R_iᵀ (x, y, z): from space to the section's axes."""
    R = rotations
    return (
        R[i, 0, 0] * x + R[i, 1, 0] * y + R[i, 2, 0] * z,
        R[i, 0, 1] * x + R[i, 1, 1] * y + R[i, 2, 1] * z,
        R[i, 0, 2] * x + R[i, 1, 2] * y + R[i, 2, 2] * z,
    )


@compiled
def multiply_rotation(rotation: FloatArray, vector: Vector) -> None:
    """rotation (3, 3) becomes rotation · exp([vector]×), by Rodrigues' formula."""
    x, y, z = vector
    q = x * x + y * y + z * z
    if q < 1e-8:
        a = 1 - q / 6 + q * q / 120
        b = 0.5 - q / 24 + q * q / 720
    else:
        angle = np.sqrt(q)
        a = np.sin(angle) / angle
        b = (1 - np.cos(angle)) / q
    e00, e01, e02 = 1 - b * (y * y + z * z), b * x * y - a * z, b * x * z + a * y
    e10, e11, e12 = b * x * y + a * z, 1 - b * (x * x + z * z), b * y * z - a * x
    e20, e21, e22 = b * x * z - a * y, b * y * z + a * x, 1 - b * (x * x + y * y)
    for i in range(3):
        r0, r1, r2 = rotation[i, 0], rotation[i, 1], rotation[i, 2]
        rotation[i, 0] = r0 * e00 + r1 * e10 + r2 * e20
        rotation[i, 1] = r0 * e01 + r1 * e11 + r2 * e21
        rotation[i, 2] = r0 * e02 + r1 * e12 + r2 * e22


@compiled
def magnus_step(curvature: FloatArray, k: int, step: float) -> Vector:
    """Rotation vector of R(s)ᵀ R(s + step) for R' = R [u]×, to sixth order in the step.

    curvature : (…, 3, 3) in [k] u at the three Gauss points of the step [1/mm], a row each.

    Magnus' series with Gauss points (Blanes, Casas & Ros 2000), for the transposed equation
    (Rᵀ)' = −[u]× Rᵀ, hence the signs.
    """
    u = curvature
    first = (u[k, 0, 0], u[k, 0, 1], u[k, 0, 2])
    middle = (u[k, 1, 0], u[k, 1, 1], u[k, 1, 2])
    last = (u[k, 2, 0], u[k, 2, 1], u[k, 2, 2])
    slope, bow = -step * ROOT_15 / 3, -step * 10 / 3
    a1 = (-step * middle[0], -step * middle[1], -step * middle[2])
    a2 = (slope * (last[0] - first[0]), slope * (last[1] - first[1]), slope * (last[2] - first[2]))
    a3 = (
        bow * (last[0] - 2 * middle[0] + first[0]),
        bow * (last[1] - 2 * middle[1] + first[1]),
        bow * (last[2] - 2 * middle[2] + first[2]),
    )
    c1 = cross3(a1, a2)
    c2 = cross3(a1, (2 * a3[0] + c1[0], 2 * a3[1] + c1[1], 2 * a3[2] + c1[2]))
    c3 = cross3(
        (c1[0] - 20 * a1[0] - a3[0], c1[1] - 20 * a1[1] - a3[1], c1[2] - 20 * a1[2] - a3[2]),
        (a2[0] - c2[0] / 60, a2[1] - c2[1] / 60, a2[2] - c2[2] / 60),
    )
    return (
        -(a1[0] + a3[0] / 12 + c3[0] / 240),
        -(a1[1] + a3[1] / 12 + c3[1] / 240),
        -(a1[2] + a3[2] / 12 + c3[2] / 240),
    )


@compiled
def rotation_vector(rotation: FloatArray) -> Vector:
    """The rotation vector of a rotation matrix, its angle in [0, π]."""
    R = rotation
    trace = R[0, 0] + R[1, 1] + R[2, 2]
    x, y, z = R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]
    sine = 0.5 * np.sqrt(x * x + y * y + z * z)
    angle = np.arctan2(sine, 0.5 * (trace - 1))
    if sine > 1e-6 or trace > 0:
        scale = 0.5 * angle / sine if sine > 1e-12 else 0.5
        return scale * x, scale * y, scale * z
    # half a turn: the axis is the largest column of (R + 1)/2
    best = 0
    for k in range(1, 3):
        if R[k, k] > R[best, best]:
            best = k
    x, y, z = R[0, best], R[1, best], R[2, best]
    x += 1.0 if best == 0 else 0.0
    y += 1.0 if best == 1 else 0.0
    z += 1.0 if best == 2 else 0.0
    scale = np.pi / np.sqrt(x * x + y * y + z * z)
    return scale * x, scale * y, scale * z
