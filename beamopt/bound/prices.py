"""A proven bound: rays by themselves, held together by prices."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.bound.cells import Box, RayMinimum
from beamopt.bound.rays import RayBound, RayParts
from beamopt.bound.wanted import Wanted
from beamopt.bound.work import WorkLeft

__all__ = ["FREE_GAP", "GAP", "ray_bound"]

GAP = 0.001  # share of the loss by which a bound's two ends may differ
FREE_GAP = 0.01  # the same without prices, of each ray's own sum
ROUGH_GAP = 0.01  # the same while prices are sought
NEAR_ENOUGH = 1e-7  # of H² Σ w: a difference that is good enough for small losses
CLOSE = 0.02  # share of the known loss at which no better prices are sought
MOST_ROUNDS = 12
PROGRAMME = 20  # work of a linear programme, by the square of the number of rays


def ray_bound(
    wanted: Wanted,
    box: Box | None = None,
    response: FloatArray | None = None,
    work: WorkLeft | None = None,
) -> RayBound:
    """Bound L(B) from below over all response matrices B whose strains stay in a box.

    Rows P_j = t_j q on one ray share the strain s = B q, three numbers; q is the ray's highest
    pressure. For any prices λ_r (3,) with Σ_r λ_r q_rᵀ = 0 the sum Σ_r λ_r · B q_r vanishes for
    every B. Adding it and then letting every ray have a strain of its own can only lower the sum:

        min_B L(B) ≥ Σ_rays min_s [Σ_(j on ray) w_j |h(t_j s) − t_j|² + λ_r · s] =: D(λ)

    Each minimum over s is bounded by `ray_minimum`. Without prices (λ = 0) what couples the rays is
    lost. The prices that keep most of it are the gradients of the rays' sums, with the other sign,
    at the lowest B known: where that is a minimum over all B they fulfil the condition, and where
    each ray's priced sum is least right there, D is L(B) itself. Where a ray has another strain
    with a lower priced sum, better prices are sought (`_raised`). All prices give a valid bound;
    the largest one counts.

    Parameters
    ----------
    box : of each ray's strain at its highest pressure.
    response : (3, 3) the lowest B known, that the box is widened to hold; None: no prices.
    work : what it may take; when that is spent, the bound is what is proven by then.
    """
    work = work or WorkLeft(math.inf)
    parts = RayParts.of(wanted, np.zeros((3, 3)) if response is None else response, box or Box())
    enough = NEAR_ENOUGH * wanted.length**2 * float(wanted.weights.sum())
    free_least = parts.least(np.zeros_like(parts.highest), enough, FREE_GAP, work)
    free = parts.bound(free_least, priced=False)
    if response is None or not parts.sums:
        return free
    prices = _allowed(_slopes(parts), parts.highest)
    slack = max(enough, GAP * parts.known)
    least = parts.least(prices, slack, work=work)
    priced = parts.bound(least, priced=True)
    if priced.loss < (1 - CLOSE) * parts.known - enough:
        met = [[free_least[k], one] for k, one in enumerate(least)]
        priced = _sought(parts, prices, priced, met, work)
    return max(priced, free, key=lambda one: one.loss)


def _slopes(parts: RayParts) -> FloatArray:
    """(r, 3) gradients of the rays' sums at the known response, with the other sign."""
    pairs = zip(parts.sums, parts.strains, strict=True)
    return -np.array([one.gradient(at[None])[0] for one, at in pairs])


def _allowed(prices: FloatArray, highest: FloatArray) -> FloatArray:
    """The nearest prices with Σ λ_r q_rᵀ = 0."""
    scaled = highest / np.abs(highest).max()
    return np.asarray(prices - scaled @ np.linalg.lstsq(scaled, prices, rcond=None)[0])


def _sought(
    parts: RayParts,
    prices: FloatArray,
    first: RayBound,
    met: list[list[RayMinimum]],
    work: WorkLeft,
) -> RayBound:
    """The highest bound of a few rounds of better prices.

    D is concave. In each round the prices go where the planes known so far allow the highest D,
    within a reach around the best ones, which grows with success and shrinks without.
    """
    best, value = first, _dual(first)
    reach = float(np.abs(prices).max()) / 10
    slack = ROUGH_GAP * parts.known
    for _ in range(MOST_ROUNDS):
        programme = PROGRAMME * len(met) ** 2
        if work.short or programme > work.of_a_pass:
            work.short = True
            break
        work.spend("proven", programme)
        trial, hoped = _raised(parts, prices, reach, met)
        if hoped * parts.length**2 + parts.unmoved < value + slack:
            break
        least = parts.least(trial, slack, work=work)
        for known, one in zip(met, least, strict=True):
            known.append(one)
        found = parts.bound(least, priced=True)
        if _dual(found) > value:
            best, value, prices, reach = found, _dual(found), trial, 1.5 * reach
        else:
            reach /= 3
    return best


def _dual(bound: RayBound) -> float:
    """A bound's sum, which may be below 0 [mm²]."""
    return bound.unmoved + sum(ray.lower for ray in bound.rays)


def _raised(
    parts: RayParts, around: FloatArray, reach: float, met: list[list[RayMinimum]]
) -> tuple[FloatArray, float]:
    """Prices within `reach` of those `around`, at which the planes allow the highest D.

    A ray's least priced sum at λ is at most ray(s) + λ · s for every strain s that was met: a
    linear programme in all λ_r and those sums.

    Returns
    -------
    (r, 3) prices with Σ λ_r q_rᵀ = 0, and the planes' value there [H²].
    """
    from scipy.optimize import linprog
    from scipy.sparse import csr_array

    count = len(met)
    values, columns, limits = [], [], []
    for k, known in enumerate(met):
        strains = np.array([parts.strains[k], *(one.strain for one in known)])
        values += [[*(-strain).tolist(), 1.0] for strain in strains]
        columns += [[3 * k, 3 * k + 1, 3 * k + 2, 3 * count + k]] * len(strains)
        limits += parts.sums[k].at(strains).tolist()
    places = np.repeat(np.arange(len(limits)), 4), np.ravel(columns)
    rows: Any = csr_array((np.ravel(values), places), shape=(len(limits), 4 * count))
    coupled = np.zeros((9, 4 * count))
    scaled = parts.highest / np.abs(parts.highest).max()
    for i in range(3):
        coupled[3 * i : 3 * i + 3, i : 3 * count : 3] = scaled.T
    ranges = [(price - reach, price + reach) for price in around.ravel().tolist()]
    found = linprog(
        np.repeat([0.0, -1.0], [3 * count, count]),
        A_ub=rows,
        b_ub=np.array(limits),
        A_eq=coupled,
        b_eq=np.zeros(9),
        bounds=[*ranges, *[(None, None)] * count],
    )
    if found.x is None or found.fun is None:
        return around, -np.inf
    prices = np.reshape(found.x[: 3 * count], (count, 3))
    return _allowed(prices, parts.highest), -float(found.fun)
