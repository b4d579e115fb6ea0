"""Lee's frame by shooting with scipy: no modes, no potential, the load as an unknown."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import root

from beamopt.base.arrays import FloatArray

__all__ = ["LeeLimit", "lee_limit"]

EI, EA = 1.44e7, 4.32e7
SIDE, AT = 120.0, 24.0
UNIT = 1e4  # of forces


@dataclass(frozen=True)
class LeeLimit:
    """Largest load, and the way of the loaded point down and across at it."""

    load: float
    down: float
    across: float


def lee_limit(last: float, *, follower: bool) -> LeeLimit:
    """The largest load while the loaded point goes down by `last`, in steps of 2.

    By the polynomial through the seven points about the largest.
    """
    guess, before = np.zeros(4), np.zeros(4)
    points = []
    for down in np.arange(0.0, last, 2.0):
        start = 2 * guess - before
        found = root(_missing, start, args=(down, follower), tol=1e-11).x
        before, guess = guess, found
        _, loaded = _shot(found, follower=follower)
        points.append((down, UNIT * found[3], loaded[1] - AT))
    way, load, across = np.array(points).T
    top = int(np.argmax(load))
    near = slice(top - 3, top + 4)
    by_way = np.polynomial.Polynomial.fit(way[near], load[near], 6)
    flat = by_way.deriv().roots()
    down = float(min(flat.real, key=lambda one: abs(one - way[top])))
    aside = np.polynomial.Polynomial.fit(way[near], across[near], 6)
    return LeeLimit(float(by_way(down)), down, float(aside(down)))


def _missing(unknowns: FloatArray, down: float, follower: bool) -> list[float]:
    """To the hinge at the end, to no moment there, and to how far the load has gone down."""
    end, loaded = _shot(unknowns, follower=follower)
    return [end[0] - SIDE, end[1] - SIDE, end[3] / UNIT, loaded[0] - SIDE + down]


def _shot(unknowns: FloatArray, *, follower: bool) -> tuple[FloatArray, FloatArray]:
    """(x, y, θ, M) at the end for θ and the force at the base and the load; and where that is."""
    angle, nx, ny, load = unknowns * [1.0, UNIT, UNIT, UNIT]
    force = np.array([nx, ny])
    state, loaded = np.array([0.0, 0.0, angle, 0.0]), np.zeros(2)
    for k, length in enumerate((SIDE, AT, SIDE - AT)):
        if k == 1:
            state[2] += np.pi / 2
        if k == 2:
            turned = state[2] if follower else np.pi / 2
            force = force - load * np.array([-np.sin(turned), np.cos(turned)])
            loaded = state[:2].copy()
        way = solve_ivp(_rate, (0, length), state, "DOP853", args=(force,), rtol=1e-9, atol=1e-9)
        state = way.y[:, -1].copy()
    return state, loaded


def _rate(_: float, state: FloatArray, force: FloatArray) -> list[float]:
    """x' = (1 + N/EA) (cos θ, sin θ), θ' = M/EI, M' = −x' × n."""
    along = np.array([np.cos(state[2]), np.sin(state[2])])
    dx, dy = (1 + force @ along / EA) * along
    return [dx, dy, state[3] / EI, dy * force[0] - dx * force[1]]
