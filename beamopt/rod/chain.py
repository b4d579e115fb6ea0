"""Segments without loads: each an arc of constant strains, joined by a product of exponentials."""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.rod.rod import Rod

__all__ = ["chain_centrelines", "chain_tips"]

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
    position = np.tile(rod.base.position, (len(rest), 1))
    rotation = np.tile(rod.base.rotation, (len(rest), 1, 1))
    for k, segment in enumerate(rod.segments):
        rotation = rotation @ segment.kink
        position, rotation = _along(position, rotation, rest[:, k] * segment.length)
    return position, rotation


def chain_centrelines(rod: Rod, rest: FloatArray, points: int) -> FloatArray:
    """(n, 1 + segments · points, 3) the axes [mm] of an unloaded rod, `points` on each segment."""
    position = np.tile(rod.base.position, (len(rest), 1))
    rotation = np.tile(rod.base.rotation, (len(rest), 1, 1))
    found = [position]
    for k, segment in enumerate(rod.segments):
        rotation = rotation @ segment.kink
        for _ in range(points):
            step = rest[:, k] * (segment.length / points)
            position, rotation = _along(position, rotation, step)
            found.append(position)
    return np.stack(found, axis=1)


def _along(
    position: FloatArray, rotation: FloatArray, strains: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Go on from positions and rotations by strains times length, (n, 6)."""
    turn, along = strains[:, :3], strains[:, 3:]
    sine, versed, cubic = _coefficients((turn * turn).sum(axis=-1))
    once = np.cross(turn, along)
    moved = along + versed[:, None] * once + cubic[:, None] * np.cross(turn, once)
    spin = np.cross(turn[:, None, :], np.eye(3)).transpose(0, 2, 1)  # [uL]×
    exponential = np.eye(3) + sine[:, None, None] * spin + versed[:, None, None] * (spin @ spin)
    return position + np.einsum("nij,nj->ni", rotation, moved), rotation @ exponential


def _coefficients(q: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """sin θ/θ, (1 − cos θ)/θ², (θ − sin θ)/θ³ at q = θ²."""
    small = q < SERIES_BELOW
    safe = np.where(small, 1.0, q)
    angle = np.sqrt(safe)
    sine = np.where(small, 1 - q / 6 + q * q / 120, np.sin(angle) / angle)
    versed = np.where(small, 0.5 - q / 24 + q * q / 720, 2 * (np.sin(angle / 2) / angle) ** 2)
    cubic = np.where(small, 1 / 6 - q / 120 + q * q / 5040, (1 - np.sin(angle) / angle) / safe)
    return sine, versed, cubic
