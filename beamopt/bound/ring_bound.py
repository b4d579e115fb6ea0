"""The least loss that the chambers of a ring can bring, between an outer and an inner value."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.bound.polytope import Cuts, least_squares_within, nearest_point
from beamopt.bound.ring import NUMBERS, RingMoments, ring_response
from beamopt.bound.wanted import Wanted
from beamopt.bound.work import ROUND, WorkLeft
from beamopt.rod.arc import arc_tip_jacobian_by_response

__all__ = ["RingBound", "ring_bound"]

SEED = 0x21B
DIRECTIONS, MIXTURES = 40, 4  # random ones: of the first cuts, and starts within the ring
MOST_ROUNDS = 60
RESIDUALS = 4  # work of residuals with their derivatives, by that of their tips
KEPT = 30  # cuts of a round
AGREE = 1e-3  # share of the outer value by which the inner one may be above it
STUCK = 1e-10  # a cut so shallow changes nothing
NEAR_ENOUGH = 1e-9  # of H² Σ w: a difference that is good enough for small losses


@dataclass(frozen=True, eq=False)
class RingBound:
    """The lowest L of any chambers in the ring lies between `outer` and `inner` [mm²].

    outer : the lowest that was found among moments that no cut excludes; numerical, as the search
        among them starts from a few places. The moments are those of partitions of `elements`, all
        of which the ring can have, but not all that it can: on 64 × 180 elements it was up to
        0.05 % too high, against 128 × 360. inner : of a mixture of partitions of the ring.
    realisable : whether chambers in the ring have the response that is best of all.
    matrix : (3, 3) the mixture's response, see `LinearResponse`. numbers : (12,) its numbers, see
        `RingMoments`. rounds : of cuts. elements : radial rows and sectors of the partitions.
    """

    outer: float
    inner: float
    realisable: bool
    matrix: FloatArray
    numbers: FloatArray
    rounds: int
    elements: tuple[int, int]

    @property
    def agrees(self) -> bool:
        """Whether the two values are as near to each other as was asked for."""
        return self.inner <= self.outer * (1 + AGREE) or self.realisable


def ring_bound(
    wanted: Wanted,
    ring: RingMoments,
    youngs_modulus: float,
    least: float,
    work: WorkLeft | None = None,
) -> RingBound:
    """Minimise L(B(m)) over the moments m ∈ M that chambers in the ring can have.

    Half spaces d · m ≤ h(d) enclose M. In rounds: the lowest L within them (`least_squares_within`,
    from a few starts), then the point of M nearest to where it is attained, whose own L is an inner
    value, and the half spaces met on the way to it, which exclude the point outside.

    Walls, skins beyond `ring`'s and rounding only take away from M.

    Parameters
    ----------
    least : the lowest L over all responses [mm²]. Where chambers reach it, there is nothing to do.
    work : what it may take but for a first round; any round's outer value is a bound.
    """
    work = work or WorkLeft(math.inf)
    search = _Search(wanted, ring, youngs_modulus, work)
    enough = NEAR_ENOUGH * wanted.length**2 * float(wanted.weights.sum())
    cuts, starts = search.beginning()
    best, inner, outside, corners = starts[0], np.inf, None, np.array(starts)
    rounds = 0
    while rounds < MOST_ROUNDS:
        rounds += 1
        tried = [best, *starts] if outside is None else [best, outside]
        outside, outer = search.lowest(cuts, tried)
        near = nearest_point(search.support, outside, np.vstack([best, corners]))
        value = search.value(near.point)
        if value < inner:
            best, inner = near.point, value
        if inner - outer <= max(AGREE * outer, enough):
            break
        if near.cuts.excess(outside) <= STUCK:
            break
        work.short |= not work.left
        if work.short:
            break
        cuts = cuts.with_more(near.cuts.deepest(outside, KEPT))
        corners = near.corners
    realisable = inner <= least + max(AGREE * least, enough)
    matrix, _ = search.response(best)
    return RingBound(
        max(outer, least) if not realisable else least,
        inner,
        realisable,
        matrix,
        best * ring.reach,
        rounds,
        ring.shape,
    )


@dataclass(frozen=True, eq=False)
class _Search:
    """The problem in numbers that are divided by the widths of M."""

    wanted: Wanted
    ring: RingMoments
    youngs_modulus: float
    work: WorkLeft

    def support(self, direction: FloatArray) -> tuple[float, FloatArray]:
        """h(d) and its point, see `RingMoments.farthest`."""
        height, point = self.ring.farthest(direction / self.ring.reach)
        return height, point / self.ring.reach

    def beginning(self) -> tuple[Cuts, list[FloatArray]]:
        """Cuts along the axes and along random directions, and mixtures of the points on them."""
        rng = np.random.default_rng(SEED)
        axes = np.vstack([np.eye(NUMBERS), -np.eye(NUMBERS)])
        random = rng.standard_normal((DIRECTIONS, NUMBERS))
        normals = np.vstack([axes, random / np.linalg.norm(random, axis=1, keepdims=True)])
        found = [self.support(normal) for normal in normals]
        points = np.array([point for _, point in found])
        weights = rng.dirichlet(np.full(len(points), 0.3), MIXTURES)
        cuts = Cuts(normals, np.array([height for height, _ in found]))
        return cuts, [points.mean(axis=0), *(weights @ points)]

    def response(self, point: FloatArray) -> tuple[FloatArray, FloatArray]:
        """B (3, 3) and its derivatives (12, 3, 3)."""
        numbers = point * self.ring.reach
        matrix, slopes = ring_response(self.ring, numbers, self.youngs_modulus)
        return matrix, slopes * self.ring.reach[:, None, None]

    def value(self, point: FloatArray) -> float:
        """L [mm²]; infinite where there is no stiffness."""
        if not is_stiff(self.ring, point * self.ring.reach):
            return np.inf
        return self.wanted.loss_of(self.response(point)[0])

    def residuals(self, point: FloatArray) -> tuple[FloatArray, FloatArray] | None:
        """√w (h − t) of every row [mm], and their derivatives."""
        if not is_stiff(self.ring, point * self.ring.reach):
            return None
        wanted = self.wanted
        self.work.spend("ring", RESIDUALS * (len(wanted.tips) + ROUND))
        matrix, slopes = self.response(point)
        root = np.sqrt(wanted.weights)[:, None]
        away = root * (wanted.tips_of(matrix) - wanted.tips)
        strains = wanted.strains_of(matrix)
        by_matrix = arc_tip_jacobian_by_response(strains, wanted.pressures, wanted.length)
        chain = np.einsum("nxij,kij->nxk", by_matrix, slopes) * root[..., None]
        if not np.isfinite(away).all():
            return None
        return away.ravel(), chain.reshape(-1, NUMBERS)

    def lowest(self, cuts: Cuts, starts: list[FloatArray]) -> tuple[FloatArray, float]:
        """The lowest of the local minima within cuts."""
        ends = []
        for start in starts:
            within = start if cuts.excess(start) <= 0 else cuts.nearest(start)
            if within is not None and self.residuals(within) is not None:
                ends.append(least_squares_within(self.residuals, cuts, within))
        return min(ends, key=lambda end: end[1])


def is_stiff(ring: RingMoments, numbers: FloatArray) -> bool:
    """Whether enough material is left for a positive area and bending stiffness."""
    left = ring.whole - np.concatenate([numbers[:9].reshape(3, 3).sum(axis=0), numbers[9:]])
    area, x, y, xx, yy, xy = left
    if area <= 1e-6 * ring.whole[0]:
        return False
    i1, i2, i12 = xx - x * x / area, yy - y * y / area, xy - x * y / area
    least = 1e-9 * ring.whole[3]
    return bool(i1 > least and i2 > least and i1 * i2 - i12 * i12 > least * max(i1, i2))
