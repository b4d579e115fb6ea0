"""The rod of a uniform section under pressure alone: a circular arc in closed form."""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import FloatArray

__all__ = [
    "arc_centreline",
    "arc_tip_direction_jacobian",
    "arc_tip_directions",
    "arc_tip_jacobian",
    "arc_tip_jacobian_by_response",
    "arc_tips",
]

SERIES_BELOW = 0.05
"""θ² below which d(sin θ/θ)/dθ² and its sibling are summed as series (error below 1e-16)."""


def arc_tips(strains: FloatArray, length: float) -> FloatArray:
    """Position of the tip of a clamped rod with constant strains.

    h(H) = H (1 + ε) [(1 − cos θ)/θ d + sin θ/θ e3] with θ = |κ| H and d = κ × e3/|κ|.

    Parameters
    ----------
    strains : (…, 3) ε, κ1, κ2 [1, 1/mm, 1/mm].
    length : H [mm].

    Returns
    -------
    (…, 3) x, y, z from the base's material centroid, along the grid's axes and the rod's [mm].
    """
    return arc_centreline(strains, np.array([length]))[..., 0, :]


def arc_centreline(strains: FloatArray, stations: FloatArray) -> FloatArray:
    """(…, m, 3) points [mm] of the deformed centreline at arc lengths `stations` (m,) [mm]."""
    stretch, k1, k2 = (part[..., None] for part in np.moveaxis(strains, -1, 0))
    half = np.hypot(k1, k2) * stations / (2 * np.pi)
    height = np.sinc(2 * half)
    sideways = stations / 2 * np.sinc(half) ** 2  # (1 − cos θ)/θ² · s, without cancellation
    along = (1 + stretch) * stations
    return np.stack([along * sideways * k2, along * sideways * (0 - k1), along * height], axis=-1)


def arc_tip_jacobian(strains: FloatArray, length: float) -> FloatArray:
    """Derivatives (…, 3, 3) of the tip (x, y, z) by the strains (ε, κ1, κ2) [mm; mm²]."""
    stretch, k1, k2 = np.moveaxis(strains, -1, 0)
    angle = np.hypot(k1, k2) * length
    q = angle * angle
    f = np.sinc(angle / (2 * np.pi)) ** 2 / 2  # (1 − cos θ)/θ²
    g = np.sinc(angle / np.pi)  # sin θ/θ
    df, dg = _slopes(q, angle, f, g)
    h = length
    scale = h * (1 + stretch)
    direction = np.stack([k2, -k1], axis=-1)
    result = np.zeros((*strains.shape, 3))
    # rows: x, y, z; tip = H (1 + ε) [f H (κ2, −κ1), g], dq/dκ = 2 H² κ
    result[..., :2, 0] = (h * h * f)[..., None] * direction
    result[..., 2, 0] = h * g
    for column, k in ((1, k1), (2, k2)):
        turn = 2 * h * h * k
        result[..., :2, column] = (scale * h * df * turn)[..., None] * direction
        result[..., 2, column] = scale * dg * turn
    result[..., 1, 1] -= scale * h * f
    result[..., 0, 2] += scale * h * f
    return result


def arc_tip_jacobian_by_response(
    strains: FloatArray, pressures: FloatArray, length: float
) -> FloatArray:
    """Derivatives (…, n, 3, 3, 3) of the tips by the response matrix: [k, x, i, j] = ∂tip_x/∂B_ij.

    strains : (…, n, 3) at the pressures (n, 3) [kPa], strain = B P, so that ∂tip/∂B_ij is
    ∂tip/∂strain_i · P_j [mm·kPa for i = 0, mm²·kPa for i = 1, 2].
    """
    return np.asarray(np.einsum("...nxi,nj->...nxij", arc_tip_jacobian(strains, length), pressures))


def arc_tip_directions(strains: FloatArray, length: float) -> FloatArray:
    """(…, 3) unit tangent R(H) e3 = sin θ d + cos θ e3 of the axis at the tip.

    θ = |κ| H and d = κ × e3/|κ|, the bending direction; strains (…, 3) as for `arc_tips`.
    """
    _, k1, k2 = np.moveaxis(strains, -1, 0)
    angle = np.hypot(k1, k2) * length
    sideways = length * np.sinc(angle / np.pi)  # sin θ/|κ|
    return np.stack([sideways * k2, sideways * (0 - k1), np.cos(angle)], axis=-1)


def arc_tip_direction_jacobian(strains: FloatArray, length: float) -> FloatArray:
    """Derivatives (…, 3, 3) of the tip's direction by the strains (ε, κ1, κ2) [1; mm].

    With g = sin θ/θ and e = κ/|κ|: ∂(g κ_i)/∂κ_j = g δ_ij + (cos θ − g) e_i e_j and
    ∂cos θ/∂κ_j = −H² g κ_j. Nothing is divided by θ but in g and e, so that no series is needed:
    cos θ − g goes to zero where e means nothing.
    """
    _, k1, k2 = np.moveaxis(strains, -1, 0)
    size = np.hypot(k1, k2)
    angle = size * length
    g = np.sinc(angle / np.pi)
    safe = np.where(size > 0, size, 1.0)
    e1, e2, change = k1 / safe, k2 / safe, np.cos(angle) - g
    result = np.zeros((*strains.shape, 3))
    # rows: x, y, z; direction = [H g κ2, −H g κ1, cos θ]
    result[..., 0, 1] = length * change * e2 * e1
    result[..., 0, 2] = length * (g + change * e2 * e2)
    result[..., 1, 1] = -length * (g + change * e1 * e1)
    result[..., 1, 2] = -length * change * e1 * e2
    result[..., 2, 1] = -length * length * g * k1
    result[..., 2, 2] = -length * length * g * k2
    return result


def _slopes(
    q: FloatArray, angle: FloatArray, f: FloatArray, g: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """df/dq and dg/dq for f = (1 − cos θ)/θ², g = sin θ/θ, q = θ²."""
    small = q < SERIES_BELOW
    safe = np.where(small, 1.0, q)
    df = np.where(small, _series(q, 24, 2), (g / 2 - f) / safe)
    dg = np.where(small, _series(q, 6, 1), (np.cos(angle) - g) / (2 * safe))
    return df, dg


def _series(q: FloatArray, first: int, shift: int) -> FloatArray:
    """Derivative of Σ (−q)ⁿ/(2n + shift)! by q; `first` is the first term's denominator.

    Term n is (−1)ⁿ n qⁿ⁻¹/(2n + shift)!, so the first one is −1/(2 + shift)!.
    """
    total = np.zeros_like(q)
    term = np.full_like(q, -1.0 / first)
    for n in range(1, 8):
        total += n * term
        term = -term * q / ((2 * n + shift + 1) * (2 * n + shift + 2))
    return total
