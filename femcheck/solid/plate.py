"""The tip face as a rigid plate without mass: three displacements and a finite rotation."""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import FloatArray

__all__ = ["cross_matrix", "rotation", "symmetric_turn"]


def cross_matrix(a: FloatArray) -> FloatArray:
    """[a]× (…, 3, 3) with [a]× b = a × b."""
    result = np.zeros((*a.shape, 3))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        result[..., i, j], result[..., j, i] = -a[..., k], a[..., k]
    return result


def rotation(turn: FloatArray) -> FloatArray:
    """Rotation matrix of a rotation vector (3,) [rad] (Rodrigues)."""
    angle = float(np.linalg.norm(turn))
    K = cross_matrix(turn)
    first = np.sinc(angle / np.pi)
    second = np.sinc(angle / (2 * np.pi)) ** 2 / 2
    return np.asarray(np.eye(3) + first * K + second * K @ K)


def symmetric_turn(force: FloatArray, arm: FloatArray) -> FloatArray:
    """(3, 3) H with ½ δθᵀ H δθ = force · ½ δθ × (δθ × arm), summed over leading axes.

    The second-order part of a rotation exp(δθ) applied to `arm`: what makes the tangent of a force
    on a rotating arm symmetric.
    """
    f, y = force.reshape(-1, 3), arm.reshape(-1, 3)
    product = f.T @ y
    return np.asarray((product + product.T) / 2 - np.trace(product) * np.eye(3))
