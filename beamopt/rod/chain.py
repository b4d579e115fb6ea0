"""Segments without loads: each an arc of constant strains, joined by a product of exponentials."""

from __future__ import annotations

import numpy as np

from beamopt.arrays import FloatArray
from beamopt.rod.rod import Rod

__all__ = ["chain_tips"]

SERIES_BELOW = 1e-4
"""θ² below which the coefficients of the exponential are summed as series (error below 1e-17)."""


def chain_tips(rod: Rod, rest: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Where the tips of an unloaded rod are.

    On a segment of length L the strains are those at rest, so R goes to R exp([u L]×) and h to
    h + R (1 + (1 − cos θ)/θ² [uL]× + (θ − sin θ)/θ³ [uL]×²) v L, θ = |u| L.

    Parameters
    ----------
    rest : (n, segments, 6) strains (u, v) [1/mm, 1] of n cases.

    Returns
    -------
    positions (n, 3) [mm] and rotations (n, 3, 3) of the tip.
    """
    n = len(rest)
    position = np.tile(rod.base.position, (n, 1))
    rotation = np.tile(rod.base.rotation, (n, 1, 1))
    for k, segment in enumerate(rod.segments):
        rotation = rotation @ segment.kink
        turn, along = rest[:, k, :3] * segment.length, rest[:, k, 3:] * segment.length
        sine, versed, rest_of_it = _coefficients((turn * turn).sum(axis=-1))
        once = np.cross(turn, along)
        twice = np.cross(turn, once)
        moved = along + versed[:, None] * once + rest_of_it[:, None] * twice
        position = position + np.einsum("nij,nj->ni", rotation, moved)
        spin = np.cross(turn[:, None, :], np.eye(3)).transpose(0, 2, 1)  # [uL]×
        exponential = np.eye(3) + sine[:, None, None] * spin + versed[:, None, None] * (spin @ spin)
        rotation = rotation @ exponential
    return position, rotation


def _coefficients(q: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """sin θ/θ, (1 − cos θ)/θ², (θ − sin θ)/θ³ at q = θ²."""
    small = q < SERIES_BELOW
    safe = np.where(small, 1.0, q)
    angle = np.sqrt(safe)
    sine = np.where(small, 1 - q / 6 + q * q / 120, np.sin(angle) / angle)
    versed = np.where(small, 0.5 - q / 24 + q * q / 720, 2 * (np.sin(angle / 2) / angle) ** 2)
    cubic = np.where(small, 1 / 6 - q / 120 + q * q / 5040, (1 - np.sin(angle) / angle) / safe)
    return sine, versed, cubic
