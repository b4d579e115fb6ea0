"""Statics of a solved rod once more, in plain numpy: what its tip and its loads say of its base."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

from beamopt.base.arrays import FloatArray
from beamopt.rod.law import cross
from beamopt.rod.rod import PointLoad, Rod, Segment

__all__ = ["base_from_tip"]


def base_from_tip(
    rod: Rod, tip: FloatArray, rotation: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Position, rotation and moment (3,) at the base of a rod with a free tip (3,), (3, 3).

    h' = R v, R' = R [u]×, n' = −f, m' = −h' × n − a × f, with the law's u and v, integrated from
    the tip to the base: no modes, no potential.
    """
    state = np.concatenate([tip, rotation.ravel(), np.zeros(6)])
    for segment in reversed(rod.segments):
        state = _before_end(state, segment.end)
        rate = _rate(segment)
        end = solve_ivp(rate, (segment.length, 0), state, "DOP853", rtol=1e-11, atol=1e-12)
        state = end.y[:, -1]
        state[3:12] = (state[3:12].reshape(3, 3) @ segment.kink.T).ravel()
    return state[:3], state[3:12].reshape(3, 3), state[15:]


def _before_end(state: FloatArray, load: PointLoad) -> FloatArray:
    R = state[3:12].reshape(3, 3)
    force = load.force + R @ load.follower_force
    moment = load.moment + R @ load.follower_moment + np.cross(R @ load.at, force)
    return np.concatenate([state[:12], state[12:15] + force, state[15:] + moment])


def _rate(segment: Segment):  # type: ignore[no-untyped-def]
    law, free = segment.law, list(segment.law.free)
    block = law.bending[np.ix_(free, free)]

    def rate(_: float, state: FloatArray) -> FloatArray:
        R, n, m = state[3:12].reshape(3, 3), state[12:15], state[15:]
        force, bent = R.T @ n, np.zeros(3)
        bent[free] = np.linalg.solve(block, (R.T @ m - law.coupling @ force)[free])
        u = segment.rest[:3] + bent
        v = segment.rest[3:] + law.compliance @ force - law.coupling.T @ bent
        line = segment.line.force + R @ segment.line.follower_force
        along, arm = R @ v, R @ segment.line.at
        turning = -np.cross(along, n) - np.cross(arm, line)
        return np.concatenate([along, (R @ cross(u)).ravel(), -line, turning])

    return rate
