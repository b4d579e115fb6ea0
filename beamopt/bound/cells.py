"""The least sum of one ray's squared distances over a box of strains, by branch and bound."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.bound.work import ROUND
from beamopt.rod.arc import arc_tip_jacobian, arc_tips

__all__ = ["Box", "RayMinimum", "RaySum", "ray_minimum"]

LINEAR_BELOW = 0.5  # rad and stretch: half sides of cells in which a tip's slope says something
MOST_CELLS = 400_000  # kept at once
AT_ONCE = 2**22  # tips computed at once; more take gigabytes
TURN = 2 * np.pi


@dataclass(frozen=True, slots=True)
class Box:
    """What a ray's strain may be at its highest pressure.

    stretch : lowest and highest ε. turn : most |κ| H that pressure adds to the rest shape [rad].
    """

    stretch: tuple[float, float] = (-0.5, 2.0)
    turn: float = TURN

    def around(self, strains: FloatArray) -> Box:
        """The smallest box with this one and the strains (…, 3) = (ε, κ1 H, κ2 H)."""
        low = min(self.stretch[0], float(strains[..., 0].min()))
        high = max(self.stretch[1], float(strains[..., 0].max()))
        most = float(np.hypot(strains[..., 1], strains[..., 2]).max())
        return Box((low, high), max(self.turn, most))

    @property
    def text(self) -> str:
        """What it is, for people."""
        low, high = self.stretch
        turns = self.turn / TURN
        turn = "one turn" if turns == 1 else f"{turns:.3g} turns"
        return f"full pressure stretches by {low:.3g} … {high:.3g} and turns by at most {turn}"


@dataclass(frozen=True, eq=False)
class RaySum:
    """Σ w_j |h(t_j s) − tip_j|² of one ray, as a function of its strain s; in units of H.

    shares : (k,) t_j, at most 1 in size. tips : (k, 3). weights : (k,).
    rest : (2,) turns at rest, κ1 H and κ2 H. Strains are (ε, κ1 H, κ2 H) without them.
    """

    shares: FloatArray
    tips: FloatArray
    weights: FloatArray
    rest: FloatArray

    def at(self, strains: FloatArray) -> FloatArray:
        """(n,) the sum at strains (n, 3)."""
        away = arc_tips(self._of_rows(strains), 1.0) - self.tips
        return np.asarray((away * away).sum(axis=-1) @ self.weights)

    def gradient(self, strains: FloatArray) -> FloatArray:
        """(n, 3) derivatives of the sum by the strains (n, 3)."""
        at = self._of_rows(strains)
        away = self.weights[:, None] * (arc_tips(at, 1.0) - self.tips)
        slopes = arc_tip_jacobian(at, 1.0)
        return np.asarray(2 * np.einsum("k,nkx,nkxi->ni", self.shares, away, slopes))

    def _of_rows(self, strains: FloatArray) -> FloatArray:
        """(n, k, 3) strains of every row, rest shape included."""
        at = strains[:, None, :] * self.shares[:, None]
        at[..., 1:] += self.rest
        return at

    def cells(
        self, centres: FloatArray, halves: FloatArray, price: FloatArray, enough: float
    ) -> tuple[FloatArray, FloatArray]:
        """Priced sums (n,) at the cells' centres, and (n,) below which none is in a cell.

        The second bound of `ray_minimum` is computed where the first is below `enough`.
        """
        count = max(1, AT_ONCE // len(self.shares))
        parts = [
            self._cells(centres[k : k + count], halves[k : k + count], price, enough)
            for k in range(0, len(centres), count)
        ]
        if len(parts) == 1:
            return parts[0]
        return np.concatenate([a for a, _ in parts]), np.concatenate([b for _, b in parts])

    def _cells(
        self, centres: FloatArray, halves: FloatArray, price: FloatArray, enough: float
    ) -> tuple[FloatArray, FloatArray]:
        """See `cells`, of so few that they fit in memory."""
        distance = np.linalg.norm(arc_tips(self._of_rows(centres), 1.0) - self.tips, axis=-1)
        move, bend = self.reach(centres, halves)
        priced = centres @ price
        sums = (distance * distance) @ self.weights + priced
        bounds = np.maximum(distance - move, 0.0) ** 2 @ self.weights + priced
        bounds -= halves @ np.abs(price)
        again = np.flatnonzero((bounds < enough) & (halves.max(axis=1) < LINEAR_BELOW))
        if again.size:
            slopes = np.abs(self.gradient(centres[again]) + price)
            beyond = 2 * (bend[again] * (distance[again] + move[again])) @ self.weights
            second = sums[again] - (slopes * halves[again]).sum(axis=1) - beyond
            bounds[again] = np.maximum(bounds[again], second)
        return sums, bounds

    def reach(self, centres: FloatArray, halves: FloatArray) -> tuple[FloatArray, FloatArray]:
        """δ_j and η_j of `ray_minimum`, (n, k) each: how far tips move, and leave their slopes."""
        share = np.abs(self.shares)
        longest = np.abs(1 + centres[:, :1] * self.shares) + share * halves[:, :1]
        stretch, turn = halves[:, :1], np.hypot(halves[:, 1:2], halves[:, 2:])
        move = share * (stretch + longest / 2 * turn)
        return move, share**2 / 2 * turn * (stretch + longest / 2 * turn)


@dataclass(frozen=True, eq=False)
class RayMinimum:
    """A least priced sum lies between `lower` and `upper` [H²], which `strain` (3,) attains.

    cells : boxes of strains that were looked at. work : what they took, see `Work`.
    cut : whether the two ends are farther apart than asked for, as no more work was allowed.
    """

    lower: float
    upper: float
    strain: FloatArray
    cells: int
    work: float
    cut: bool


def ray_minimum(
    ray: RaySum,
    box: Box,
    price: FloatArray,
    guess: FloatArray,
    slack: float,
    share: float = 0.0,
    most: float = math.inf,
) -> RayMinimum:
    """The least ray(s) + λ · s over a box of strains s, between two ends [H²].

    How far a tip moves with the strain. With h(ε, κ) = ∫₀ᴴ (1 + ε) R(s) e3 ds and R(s) the rotation
    by s κ, ∂h/∂ε = ∫ R e3 ds has at most the length H. A change δκ turns the section at s by at
    most s |δκ| (from R' = R [κ]×, δR = [φ]× R with φ(s) = ∫₀ˢ R δκ dσ), so that
    |∂h/∂κ δκ| ≤ |1 + ε| ∫ s ds |δκ| = |1 + ε| H²/2 |δκ|. A rest curvature only shifts κ. Along the
    straight way from the centre c of a cell to any s in it, with the strain t_j s,

        |h(t_j s) − h(t_j c)| ≤ |t_j| (H |Δε| + max |1 + t_j ε| H/2 · |Δκ| H) =: δ_j

    and so no s of the cell has a priced sum below
    Σ_j w_j max(0, d_j − δ_j)² + λ · c − Σ_i |λ_i| a_i, with d_j = |h(t_j c) − tip_j| and the
    cell's half sides a_i.

    Small cells have a second bound. The tip's second derivative along (δε, δκ) is
    2 δε ∫ φ × R e3 ds + (1 + ε) ∫ [φ × (φ × R e3) + δφ × R e3] ds with |φ| ≤ s |δκ| and
    |δφ| = |∫₀ˢ φ × R δκ dσ| ≤ s²/2 |δκ|²: at most H² |δε| |δκ| + |1 + ε| H³/2 |δκ|². So
    h(t_j s) = h(t_j c) + J_j (s − c) + e_j with |e_j| ≤ t_j²/2 |Δκ| H (H |Δε| + max |1 + t_j ε| H/2
    |Δκ| H) =: η_j. With |x + y|² ≥ |x|² + 2 x · y, used for x = h(t_j c) − tip_j + J_j (s − c) and
    y = e_j, then for x = h(t_j c) − tip_j and y = J_j (s − c), and with |J_j (s − c)| ≤ δ_j, no s
    of the cell has a priced sum below the one at c less Σ_i |g_i| a_i + Σ_j 2 w_j (d_j + δ_j) η_j,
    where g is the priced sum's gradient at c.

    Cells whose bound is above the lowest sum found so far, but for what is allowed, are done with;
    others are halved across the side that adds most to δ.

    Parameters
    ----------
    price : (3,) λ. guess : (3,) a strain (ε, κ1 H, κ2 H) in the box.
    slack, share : how far apart the two ends may be [H²], or by which share of the upper one.
    most : work that it may take, but for a first round.
    """
    low, high = box.stretch
    centres = np.array([[(low + high) / 2, 0.0, 0.0]])
    halves = np.array([[(high - low) / 2, box.turn, box.turn]])
    upper = float(ray.at(guess[None])[0] + price @ guess)
    lower, cells, strain, work, cut = upper, 0, guess, 0.0, False
    while len(centres):
        cells += len(centres)
        work += len(centres) * len(ray.shares) + ROUND
        enough = upper - max(slack, share * upper)
        sums, bounds = ray.cells(centres, halves, price, enough)
        inside = np.hypot(centres[:, 1], centres[:, 2]) <= box.turn
        best = int(np.where(inside, sums, np.inf).argmin())
        if inside[best] and sums[best] < upper:
            upper, strain = float(sums[best]), centres[best]
        nearest = np.maximum(np.abs(centres[:, 1:]) - halves[:, 1:], 0.0)
        met = np.hypot(nearest[:, 0], nearest[:, 1]) <= box.turn  # else wholly beyond the turn
        left = met & (bounds < upper - max(slack, share * upper))
        lower = min(lower, float(bounds[met & ~left].min(initial=np.inf)))
        count = int(left.sum())
        cut = count > 0 and work + 2 * count * len(ray.shares) > most
        if cut or count > MOST_CELLS:
            lower = min(lower, float(bounds[left].min()))
            break
        centres, halves = _halved(centres[left], halves[left])
    return RayMinimum(min(lower, upper), upper, strain, cells, work, cut)


def _halved(centres: FloatArray, halves: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Every cell in two, across the side that moves the tips most."""
    effect = halves.copy()
    effect[:, 1:] *= (1 + np.abs(centres[:, :1]) + halves[:, :1]) / 2
    side = np.eye(3)[effect.argmax(axis=1)]
    smaller = halves * (1 - side / 2)
    shift = side * smaller
    return np.concatenate([centres - shift, centres + shift]), np.concatenate([smaller, smaller])
