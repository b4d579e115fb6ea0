"""A rod under its loads as plain numbers without units, the way the kernels read it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray
from beamopt.rod.law import SectionLaw
from beamopt.rod.rod import Rod

__all__ = ["Loaded", "at_rest", "loaded_rod", "split"]


class Loaded(NamedTuple):
    """One case of a rod of s segments; lengths over H, moments over B/H, forces over B/H².

    H is the rod's length and B its largest bending stiffness, so that curvatures, moments and
    loads of a rod that bends visibly are of order one. Positions are seen from the base.

    lengths : (s,). steps : (s,) of the integrator.
    rest : (s, 6) strains (u, v) without loads.
    flexibility : (s, 6, 6) symmetric; strains (u, v) = rest + flexibility · (M, N), with local
        moment and force.
    line : (s, 3, 3) rows: dead force, follower force, where they act (in the section's axes).
    end : (s, 5, 3) rows: dead force, dead moment, follower force, follower moment, where.
    kinks : (s, 3, 3). base : (3, 3) rotation of the base, before the first kink.
    held : (2,) whether the tip's position, rotation is prescribed, as place (3,), frame (3, 3).
    """

    lengths: FloatArray
    steps: NDArray[np.int64]
    rest: FloatArray
    flexibility: FloatArray
    line: FloatArray
    end: FloatArray
    kinks: FloatArray
    base: FloatArray
    held: NDArray[np.bool_]
    place: FloatArray
    frame: FloatArray


def loaded_rod(rod: Rod, resolution: int) -> Loaded:
    """The numbers of a rod at its own rest strains, with `resolution` steps along it."""
    H = rod.length
    B = _stiffness(rod)
    lengths = np.array([one.length for one in rod.segments])
    place, frame = rod.tip.position, rod.tip.rotation
    return Loaded(
        lengths=lengths / H,
        steps=split(lengths, resolution),
        rest=at_rest(rod.rest, H),
        flexibility=np.array([_flexibility(one.law, B, H) for one in rod.segments]),
        line=np.array(
            [
                [one.line.force * H**3 / B, one.line.follower_force * H**3 / B, one.line.at / H]
                for one in rod.segments
            ],
            dtype=float,
        ),
        end=np.array(
            [
                [
                    one.end.force * H**2 / B,
                    one.end.moment * H / B,
                    one.end.follower_force * H**2 / B,
                    one.end.follower_moment * H / B,
                    one.end.at / H,
                ]
                for one in rod.segments
            ],
            dtype=float,
        ),
        kinks=np.array([one.kink for one in rod.segments], dtype=float),
        base=np.array(rod.base.rotation, dtype=float),
        held=np.array([place is not None, frame is not None]),
        place=np.zeros(3) if place is None else (place - rod.base.position) / H,
        frame=np.eye(3) if frame is None else np.array(frame, dtype=float),
    )


def at_rest(rest: FloatArray, length: float) -> FloatArray:
    """Strains (…, 6) (u, v) with curvatures times the rod's length."""
    return np.ascontiguousarray(rest * np.array([length, length, length, 1.0, 1.0, 1.0]))


def split(lengths: FloatArray, resolution: int) -> NDArray[np.int64]:
    """(s,) steps of each segment: `resolution` in all, by length, but at least one each."""
    ends = np.rint(resolution * np.cumsum(lengths) / np.sum(lengths))
    steps = np.diff(ends, prepend=0.0)
    return np.maximum(1, steps).astype(np.int64)


def _stiffness(rod: Rod) -> float:
    """B [mN·mm²]: the largest stiffness of a free curvature, any number if there is none."""
    free = list(rod.free)
    if not free:
        return 1.0
    return float(max(np.max(one.law.bending[free, free]) for one in rod.segments))


def _flexibility(law: SectionLaw, B: float, H: float) -> FloatArray:
    """(6, 6) from (M, N) to (Δu, Δv): [[C, −C S], [−Sᵀ C, K⁻¹ + Sᵀ C S]].

    C is the inverse of `bending` among the free curvatures and zero elsewhere.
    """
    free = np.ix_(law.free, law.free)
    C = np.zeros((3, 3))
    if law.free:
        C[free] = B * np.linalg.inv(law.bending[free])
    S = law.coupling / H
    result = np.empty((6, 6))
    result[:3, :3] = C
    result[:3, 3:] = -C @ S
    result[3:, :3] = -S.T @ C
    result[3:, 3:] = law.compliance * B / H**2 + S.T @ C @ S
    return result
