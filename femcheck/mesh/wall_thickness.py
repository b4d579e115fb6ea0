"""Thickness of the material behind every edge of an outline."""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray

__all__ = ["thickness_behind"]

CHUNK = 256  # edges at once, to bound the memory of edges × edges


def thickness_behind(a: FloatArray, b: FloatArray) -> FloatArray:
    """(k,) way through the material from each edge's middle, along its inward normal [mm].

    a, b : (k, 2) ends of the edges of all loops, the material to their left [mm].
    """
    along = b - a
    normal = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.hypot(*along.T)[:, None]
    middle = (a + b) / 2
    parts = np.split(np.arange(len(a)), range(CHUNK, len(a), CHUNK))
    return np.concatenate([_nearest_hit(middle[k], normal[k], k, a, along) for k in parts])


def _nearest_hit(
    origin: FloatArray, ray: FloatArray, own: IndexArray, a: FloatArray, along: FloatArray
) -> FloatArray:
    w = a[None] - origin[:, None]
    cross = ray[:, None, 0] * along[None, :, 1] - ray[:, None, 1] * along[None, :, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (w[..., 0] * along[None, :, 1] - w[..., 1] * along[None, :, 0]) / cross
        u = (w[..., 0] * ray[:, None, 1] - w[..., 1] * ray[:, None, 0]) / cross
    hit = (t > 0) & (u >= 0) & (u <= 1)
    hit[np.arange(own.size), own] = False
    return np.asarray(np.where(hit, t, np.inf).min(axis=1))
