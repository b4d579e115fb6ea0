"""Points and weights that integrate over every element of a grid."""

from __future__ import annotations

import numpy as np
from numpy.polynomial.legendre import leggauss

from beamopt.base.arrays import FloatArray
from beamopt.section.grid import PolarGrid


def element_points(grid: PolarGrid, order: int = 8) -> tuple[FloatArray, FloatArray, FloatArray]:
    """x, y [mm] and weights [mm²], each (radial, angular, order²), of a Gauss rule in r and φ."""
    nodes, weights = leggauss(order)

    def between(ends: FloatArray) -> tuple[FloatArray, FloatArray]:
        half = np.diff(ends)[:, None] / 2
        return (ends[:-1] + ends[1:])[:, None] / 2 + half * nodes, half * weights

    r, wr = between(grid.edges)
    a, wa = between(grid.angles)
    pairs = (grid.radial, grid.angular, order * order)
    x = (r[:, None, :, None] * np.cos(a)[None, :, None, :]).reshape(pairs)
    y = (r[:, None, :, None] * np.sin(a)[None, :, None, :]).reshape(pairs)
    w = ((r * wr)[:, None, :, None] * wa[None, :, None, :]).reshape(pairs)
    return x, y, w
