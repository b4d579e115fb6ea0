"""The rays of a table's pressures, and what each of them asks of one strain at least."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from beamopt.bound.cells import Box, RayMinimum, RaySum, ray_minimum
from beamopt.bound.wanted import Wanted
from beamopt.bound.work import WorkLeft

__all__ = ["RayBound", "RayParts", "RayTerm", "rays_of"]

SAME_DIRECTION = 1e-9


@dataclass(frozen=True, slots=True)
class RayTerm:
    """What one direction of pressures adds to the bound.

    direction : (3,) of unit length. rows : how many of the table's lie on it.
    lower, upper : between which its part is [mm²]; with prices it may be below 0.
    cells : boxes of strains that were looked at.
    """

    direction: tuple[float, float, float]
    rows: int
    lower: float
    upper: float
    cells: int


@dataclass(frozen=True, eq=False)
class RayBound:
    """No response matrix within `box` has a lower L than `loss`; proven, up to rounding.

    unmoved : what rows without pressure add to it [mm²]. rays : what the others do.
    priced : whether the rays' strains were held together by prices; see `prices.ray_bound`.
    """

    unmoved: float
    rays: tuple[RayTerm, ...]
    box: Box
    priced: bool

    @property
    def loss(self) -> float:
        """The bound [mm²]."""
        return max(0.0, self.unmoved + sum(ray.lower for ray in self.rays))

    @property
    def upper(self) -> float:
        """At most this would be the bound if every ray were solved exactly [mm²]."""
        return max(0.0, self.unmoved + sum(ray.upper for ray in self.rays))


def rays_of(pressures: FloatArray) -> tuple[IndexArray, list[tuple[FloatArray, IndexArray]]]:
    """Rows without pressure, and direction and rows of each line through the origin.

    pressures : (n, 3) [kPa]. Rows at opposite pressures (vacuum) are on one line.
    """
    size = np.linalg.norm(pressures, axis=1)
    smallest = SAME_DIRECTION * size.max(initial=0.0)
    left = np.flatnonzero(size > smallest)
    lines = []
    while left.size:
        direction = pressures[left[0]] / size[left[0]]
        across = np.linalg.norm(np.cross(pressures[left], direction), axis=1) / size[left]
        near = across < SAME_DIRECTION
        lines.append((direction, left[near]))
        left = left[~near]
    return np.flatnonzero(size <= smallest), lines


@dataclass(frozen=True, eq=False)
class RayParts:
    """The rays of a table.

    rows : indices of each ray's. highest : (r, 3) q, each ray's highest pressure [kPa].
    sums : of each ray. strains : (r, 3) B q of a known response, (ε, κ1 H, κ2 H).
    unmoved : what rows without pressure add [mm²]. length : H [mm]. box : of every ray's strain.
    """

    rows: tuple[IndexArray, ...]
    highest: FloatArray
    sums: tuple[RaySum, ...]
    strains: FloatArray
    unmoved: float
    length: float
    box: Box

    @classmethod
    def of(cls, wanted: Wanted, response: FloatArray, box: Box) -> RayParts:
        """Cut a table into rays; the box is widened to hold the strains of `response` (3, 3)."""
        still, lines = rays_of(wanted.pressures)
        tops = [np.abs(wanted.pressures[rows] @ direction).max() for direction, rows in lines]
        highest = np.array([top * line[0] for top, line in zip(tops, lines, strict=True)])
        highest = highest.reshape(-1, 3)
        strains = highest @ response.T * np.array([1.0, wanted.length, wanted.length])
        sums = [_sum_of(wanted, rows, q) for (_, rows), q in zip(lines, highest, strict=True)]
        away = wanted.tips_of(np.zeros((3, 3)))[still] - wanted.tips[still]
        unmoved = float(wanted.weights[still] @ (away**2).sum(axis=1))
        rows = tuple(rows for _, rows in lines)
        box = box.around(strains) if len(strains) else box
        return cls(rows, highest, tuple(sums), strains, unmoved, wanted.length, box)

    @property
    def known(self) -> float:
        """L of the known response [mm²]."""
        pairs = zip(self.sums, self.strains, strict=True)
        return self.unmoved + self.length**2 * sum(float(one.at(at[None])[0]) for one, at in pairs)

    def least(
        self,
        prices: FloatArray,
        slack: float,
        share: float = 0.0,
        work: WorkLeft | None = None,
    ) -> list[RayMinimum]:
        """The least priced sum of every ray, for prices (r, 3).

        slack : how far apart the two ends may be, over all rays [mm²]. share : or each ray's, of
        its upper one. work : a part of it may be spent; what one ray leaves is the next one's.
        """
        found: list[RayMinimum] = []
        allowed = math.inf if work is None else work.of_a_pass
        each = slack / self.length**2 / max(1, len(self.sums))
        for k, ray in enumerate(self.sums):
            most = allowed / (len(self.sums) - k)
            one = ray_minimum(ray, self.box, prices[k], self.strains[k], each, share, most)
            found.append(one)
            allowed = max(0.0, allowed - one.work)
            if work is not None:
                work.spend("proven", one.work)
                work.short |= one.cut
        return found

    def bound(self, least: list[RayMinimum], *, priced: bool) -> RayBound:
        """The bound that the rays' least sums add up to."""
        rays, scale = [], self.length**2
        for q, rows, one in zip(self.highest, self.rows, least, strict=True):
            x, y, z = (q / np.linalg.norm(q)).tolist()
            ends = one.lower * scale, one.upper * scale
            rays.append(RayTerm((x, y, z), len(rows), *ends, one.cells))
        return RayBound(self.unmoved, tuple(rays), self.box, priced)


def _sum_of(wanted: Wanted, rows: IndexArray, highest: FloatArray) -> RaySum:
    shares = wanted.pressures[rows] @ highest / (highest @ highest)
    tips, turns = wanted.tips[rows] / wanted.length, wanted.curvature * wanted.length
    return RaySum(shares, tips, wanted.weights[rows], turns)
