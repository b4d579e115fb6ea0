"""A share of the loads, and of the way that a held tip is led."""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.comparators.loaded import Loaded
from beamopt.comparators.se3 import rotation, rotation_vector

__all__ = ["under"]


def under(full: Loaded, factor: float, place: FloatArray, frame: FloatArray) -> Loaded:
    """The same with all loads times `factor` and the prescribed tip that far on its way.

    place (3,), frame (3, 3) : the unloaded rod's tip, from where a prescribed tip is led, along a
    straight line and about a fixed axis.
    """
    if factor == 1:
        return full
    line, end = full.line.copy(), full.end.copy()
    line[:, :2] *= factor
    end[:, :4] *= factor
    turn = np.empty(3)
    rotation_vector(full.frame @ frame.T, turn, np.empty((3, 3)))
    x, y, z = factor * turn
    return full._replace(
        line=line,
        end=end,
        place=place + factor * (full.place - place),
        frame=rotation(x, y, z) @ frame,
    )
