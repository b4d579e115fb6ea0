"""A rod and its stations as plain arrays, for the kernels."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray, IndexArray
from beamopt.rod.rod import Rod
from beamopt.rod.rotation import GAUSS_3

__all__ = ["RodArrays", "Stations", "pack", "stations_of"]


GIVE = 1e-13


class RodArrays(NamedTuple):
    """A `Rod` without its rest strains; S segments, leading axis of all but the last seven."""

    bending: FloatArray  # (S, 3, 3)
    compliance: FloatArray
    coupling: FloatArray
    kinks: FloatArray
    line_force: FloatArray  # (S, 3)
    line_follower: FloatArray
    line_at: FloatArray
    end_force: FloatArray
    end_moment: FloatArray
    end_follower: FloatArray
    end_follower_moment: FloatArray
    end_at: FloatArray
    free: IndexArray  # curvatures that are unknown
    base_position: FloatArray
    base_rotation: FloatArray
    hinge: FloatArray  # (0 or 1, 3)
    held_position: FloatArray  # (0 or 1, 3)
    held_rotation: FloatArray  # (0 or 1, 3, 3)
    give: FloatArray  # (2,) of what holds the tip, so small that it only keeps a plane rod solvable


class Stations(NamedTuple):
    """N Gauss points a segment, M = S N in all, and what integrates and interpolates there.

    A step of the rotation goes from point to point: S (N + 1) steps, the last one of a segment to
    its end.
    """

    at: FloatArray  # (M,) arc length [mm]
    weight: FloatArray  # (M,) of the integral over the rod
    before: FloatArray  # (M, M) row i integrates from the base to point i
    to_end: FloatArray  # (S, M) row k integrates from the base to the end of segment k
    segment: IndexArray  # (M,)
    basis: FloatArray  # (M, n_b) Legendre polynomials; those of other segments are 0
    step: FloatArray  # (S (N + 1),) lengths
    step_basis: FloatArray  # (S (N + 1), 3, n_b) at the three Gauss points of each step
    step_between: FloatArray  # (N + 1, 3, N) from a segment's points to its steps' points


def pack(rod: Rod) -> RodArrays:
    """The arrays of a rod."""
    parts = rod.segments
    position, rotation = rod.tip.position, rod.tip.rotation

    def stack(values: list[FloatArray]) -> FloatArray:
        return np.ascontiguousarray(np.stack(values), dtype=np.float64)

    return RodArrays(
        bending=stack([one.law.bending for one in parts]),
        compliance=stack([one.law.compliance for one in parts]),
        coupling=stack([one.law.coupling for one in parts]),
        kinks=stack([one.kink for one in parts]),
        line_force=stack([one.line.force for one in parts]),
        line_follower=stack([one.line.follower_force for one in parts]),
        line_at=stack([one.line.at for one in parts]),
        end_force=stack([one.end.force for one in parts]),
        end_moment=stack([one.end.moment for one in parts]),
        end_follower=stack([one.end.follower_force for one in parts]),
        end_follower_moment=stack([one.end.follower_moment for one in parts]),
        end_at=stack([one.end.at for one in parts]),
        free=np.array(rod.free, dtype=np.int64),
        base_position=np.array(rod.base.position, dtype=np.float64),
        base_rotation=np.array(rod.base.rotation, dtype=np.float64),
        hinge=np.array(rod.base.hinges, dtype=np.float64),
        held_position=np.zeros((0, 3)) if position is None else np.array([position], dtype=float),
        held_rotation=(
            np.zeros((0, 3, 3)) if rotation is None else np.array([rotation], dtype=float)
        ),
        give=_give(rod),
    )


def _give(rod: Rod) -> FloatArray:
    """GIVE times how a cantilever of the rod's length gives way [mm/mN, rad/(mN·mm)]."""
    bending = max(float(np.abs(one.law.bending[k, k])) for one in rod.segments for k in rod.free)
    return GIVE * np.array([rod.length**3, rod.length]) / bending


@lru_cache(maxsize=64)
def stations_of(lengths: tuple[float, ...], modes: int, more: int = 0) -> Stations:
    """Stations for `modes` Legendre polynomials a segment, on modes + 3 + more Gauss points."""
    count, parts = modes + 3 + more, len(lengths)
    x, w = legendre.leggauss(count)
    x, w = (x + 1) / 2, w / 2  # on [0, 1]
    cuts = np.array([0.0, *x, 1.0])
    steps = np.diff(cuts)
    inside = cuts[:-1, None] + steps[:, None] * GAUSS_3  # (N + 1, 3)
    cumulated = _cumulated(x)
    starts = np.concatenate([[0.0], np.cumsum(lengths)])[:-1]
    total = parts * count
    before, to_end = np.zeros((total, total)), np.zeros((parts, total))
    basis = np.zeros((total, parts * modes))
    step_basis = np.zeros((parts * (count + 1), 3, parts * modes))
    for k, length in enumerate(lengths):
        rows, columns = slice(k * count, (k + 1) * count), slice(k * modes, (k + 1) * modes)
        before[rows, rows] = length * cumulated
        before[(k + 1) * count :, rows] = length * w
        to_end[k:, rows] = length * w
        basis[rows, columns] = legendre.legvander(2 * x - 1, modes - 1)
        step_basis[k * (count + 1) : (k + 1) * (count + 1), :, columns] = legendre.legvander(
            2 * inside - 1, modes - 1
        )
    return Stations(
        at=np.concatenate(
            [start + length * x for start, length in zip(starts, lengths, strict=True)]
        ),
        weight=to_end[-1].copy(),
        before=before,
        to_end=to_end,
        segment=np.repeat(np.arange(parts), count),
        basis=basis,
        step=np.concatenate([length * steps for length in lengths]),
        step_basis=step_basis,
        step_between=_lagrange(x, inside),
    )


def _cumulated(x: FloatArray) -> FloatArray:
    """(N, N) row i integrates the interpolant through the points x from 0 to x_i."""
    degrees = legendre.legvander(2 * x - 1, len(x) - 1)
    integrals = np.zeros_like(degrees)
    for k in range(len(x)):
        unit = np.zeros(k + 1)
        unit[k] = 1.0
        antiderivative = legendre.legint(unit, lbnd=-1.0) / 2
        integrals[:, k] = legendre.legval(2 * x - 1, antiderivative)
    return np.asarray(np.linalg.solve(degrees.T, integrals.T).T)


def _lagrange(x: FloatArray, at: NDArray[np.float64]) -> FloatArray:
    """(…, N) the weights that interpolate values at the points x to the places `at` (…)."""
    degrees = legendre.legvander(2 * x - 1, len(x) - 1)
    there = legendre.legvander(2 * at - 1, len(x) - 1)
    return np.ascontiguousarray(there @ np.linalg.inv(degrees))
