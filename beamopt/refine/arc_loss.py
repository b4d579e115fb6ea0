"""The loss of an arc from its section's moments, a microsecond each."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.compiled import compiled

__all__ = ["ArcAim", "arc_loss"]

STRAIGHT = 1e-5  # half angles [rad] below which sin x / x is summed as a series


class ArcAim(NamedTuple):
    """What arcs should reach, and what they are made of.

    length [mm], youngs_modulus [kPa], curvature (2,) at rest [1/mm].
    pressures (n, 3) [kPa]; tips (n, 3) [mm], directions (n, 3), both less what the rung in use adds
    to an arc; weights (n,), direction_weights (n,) [mm²]. turns : whether any direction counts.
    """

    length: float
    youngs_modulus: float
    curvature: FloatArray
    pressures: FloatArray
    tips: FloatArray
    weights: FloatArray
    directions: FloatArray
    direction_weights: FloatArray
    turns: bool


@compiled
def arc_loss(raw: FloatArray, aim: ArcAim, enough: float = np.inf) -> float:
    """L [mm²] of the arc whose section has the moments `raw` (4, 6); infinite where not stiff.

    The same as `linear_response`, `arc_tips` and `Aim.loss` one after the other. Where it is above
    `enough`, what comes back is too, but need not be the loss: the sum ends there.
    """
    area = raw[0, 0]
    if not area > 0:
        return np.inf
    cx, cy = raw[0, 1] / area, raw[0, 2] / area
    i11, i22 = raw[0, 4] - area * cy * cy, raw[0, 3] - area * cx * cx
    i12 = area * cx * cy - raw[0, 5]
    determinant = i11 * i22 - i12 * i12
    if not (i11 > 0 and determinant > 0):
        return np.inf
    matrix = np.empty((3, 3))
    modulus, length = aim.youngs_modulus, aim.length
    for i in range(3):
        own = raw[i + 1, 0]
        sx, sy = raw[i + 1, 1] - own * cx, raw[i + 1, 2] - own * cy
        matrix[0, i] = own / area / modulus
        matrix[1, i] = (i22 * sy + i12 * sx) / determinant / modulus
        matrix[2, i] = (-i12 * sy - i11 * sx) / determinant / modulus
    total = 0.0
    for j in range(aim.pressures.shape[0] - 1, -1, -1):  # high pressures, large distances first
        p, q, r = aim.pressures[j, 0], aim.pressures[j, 1], aim.pressures[j, 2]
        stretch = 1 + matrix[0, 0] * p + matrix[0, 1] * q + matrix[0, 2] * r
        k1 = length * (aim.curvature[0] + matrix[1, 0] * p + matrix[1, 1] * q + matrix[1, 2] * r)
        k2 = length * (aim.curvature[1] + matrix[2, 0] * p + matrix[2, 1] * q + matrix[2, 2] * r)
        half = 0.5 * np.sqrt(k1 * k1 + k2 * k2)
        cosine = np.cos(half)
        sinc = np.sin(half) / half if half > STRAIGHT else 1 - half * half / 6
        along = length * stretch
        sideways = along * sinc * sinc / 2
        x, y = sideways * k2 - aim.tips[j, 0], -sideways * k1 - aim.tips[j, 1]
        z = along * sinc * cosine - aim.tips[j, 2]
        total += aim.weights[j] * (x * x + y * y + z * z)
        if aim.turns:
            # tangent of the tip: (sin θ/θ)(κ2, −κ1) H, cos θ
            leans = sinc * cosine
            u = leans * k2 - aim.directions[j, 0]
            v = -leans * k1 - aim.directions[j, 1]
            w = 2 * cosine * cosine - 1 - aim.directions[j, 2]
            total += aim.direction_weights[j] * (u * u + v * v + w * w)
        if total > enough:
            break
    return float(total)
