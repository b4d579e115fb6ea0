"""One step of a Magnus method of order four: Runge-Kutta-Munthe-Kaas on the rigid motions."""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.compiled import compiled
from beamopt.comparators.elimination import assign
from beamopt.comparators.loaded import Loaded
from beamopt.comparators.rates import cross, strains_and_loads, times
from beamopt.comparators.se3 import add_bracket, exponential

__all__ = ["munthe_kaas_step"]


@compiled
def munthe_kaas_step(
    rod: Loaded, k: int, length: float, frame: FloatArray, state: FloatArray, work: FloatArray
) -> float:
    """Advance by `length` in segment k; returns the least v3 met.

    g' = g (u, v)^ on SE(3) with the force n and the moment m about the step's starting point:
    m' = −l − d × f with d = h − h_start, so that without line loads neither changes. Stages at
    g exp(k1/2), g exp(k2/2 + [k1, k2]/8), g exp(k3), and the step itself
    g exp((k1 + 2 k2 + 2 k3 + k4)/6 + [k1, k4]/12): Munthe-Kaas (Appl. Numer. Math. 29, 1999) with
    the brackets' signs of motions multiplied from the right. Constant strains are followed exactly.

    Parameters and state as for `runge_kutta_step`; work : (≥ 81, 1 + p) overwritten.
    """
    columns = state.shape[1]
    one, two, last = work[0:6], work[6:12], work[12:18]
    x, total, slope = work[18:30], work[30:42], work[42:54]
    start = np.empty((3, 3))
    assign(start, frame)
    for j in range(columns):
        for i in range(6):
            x[i, j] = 0.0
            total[i, j] = 0.0
            x[6 + i, j] = state[6 + i, j]
            total[6 + i, j] = state[6 + i, j]
    least = 1e300
    for stage in range(4):
        v3 = _slope(rod, k, start, frame, state, x, slope, work)
        least = min(least, v3)
        ahead = length if stage == 2 else length / 2
        weight = length / 6 if stage in (0, 3) else length / 3
        kept = one if stage == 0 else (two if stage == 1 else last)
        for j in range(columns):
            for i in range(6):
                kept[i, j] = length * slope[i, j]
                x[i, j] = ahead * slope[i, j]
                x[6 + i, j] = state[6 + i, j] + ahead * slope[6 + i, j]
            for i in range(12):
                total[i, j] += weight * slope[i, j]
        if stage == 1:
            add_bracket(1 / 8, one, two, x[0:6])
    add_bracket(1 / 12, one, last, total[0:6])
    acting, moved = work[54:63], work[75:81]
    _place(start, frame, state, total, acting, moved)
    for i in range(3):
        for j in range(columns):
            state[i, j] += moved[3 + i, j]
            state[6 + i, j] = acting[3 + i, j]
            state[9 + i, j] = acting[6 + i, j]
            if j > 0:
                state[3 + i, j] = acting[i, j]
    return least


@compiled
def _place(
    start: FloatArray,
    frame: FloatArray,
    state: FloatArray,
    x: FloatArray,
    acting: FloatArray,
    moved: FloatArray,
) -> None:
    """The section at `start` exp(x[0:6]): `frame`, d in rows 3… of `moved`, φ, n, m in `acting`.

    m of x is about the step's starting point, that of `acting` about the section's own: m − d × n.
    """
    exponential(x, frame, moved)
    for i in range(3):
        e0, e1, e2 = frame[0, i], frame[1, i], frame[2, i]
        frame[0, i], frame[1, i], frame[2, i] = times(start, e0, e1, e2)
    d0, d1, d2 = times(start, moved[3, 0], moved[4, 0], moved[5, 0])
    n0, n1, n2 = x[6, 0], x[7, 0], x[8, 0]
    for j in range(x.shape[1]):
        b0, b1, b2 = x[6, j], x[7, j], x[8, j]
        z0, z1, z2 = cross(d0, d1, d2, b0, b1, b2)
        if j == 0:
            moved[3, 0], moved[4, 0], moved[5, 0] = d0, d1, d2
        else:
            p0, p1, p2 = times(start, moved[0, j], moved[1, j], moved[2, j])
            s0, s1, s2 = state[3, j], state[4, j], state[5, j]
            acting[0, j], acting[1, j], acting[2, j] = p0 + s0, p1 + s1, p2 + s2
            p0, p1, p2 = times(start, moved[3, j], moved[4, j], moved[5, j])
            s0, s1, s2 = cross(s0, s1, s2, d0, d1, d2)
            p0, p1, p2 = p0 + s0, p1 + s1, p2 + s2
            moved[3, j], moved[4, j], moved[5, j] = p0, p1, p2
            s0, s1, s2 = cross(p0, p1, p2, n0, n1, n2)
            z0, z1, z2 = z0 + s0, z1 + s1, z2 + s2
        acting[3, j], acting[4, j], acting[5, j] = b0, b1, b2
        acting[6, j], acting[7, j], acting[8, j] = x[9, j] - z0, x[10, j] - z1, x[11, j] - z2


@compiled
def _slope(
    rod: Loaded,
    k: int,
    start: FloatArray,
    frame: FloatArray,
    state: FloatArray,
    x: FloatArray,
    slope: FloatArray,
    work: FloatArray,
) -> float:
    """(u, v), n' and m' of the section at x into `slope` (12, 1 + p); returns v3."""
    acting, rates, moved = work[54:63], work[63:75], work[75:81]
    _place(start, frame, state, x, acting, moved)
    strains_and_loads(rod, k, frame, acting, rates)
    d0, d1, d2 = moved[3, 0], moved[4, 0], moved[5, 0]
    f0, f1, f2 = rates[6, 0], rates[7, 0], rates[8, 0]
    for j in range(x.shape[1]):
        z0, z1, z2 = cross(d0, d1, d2, rates[6, j], rates[7, j], rates[8, j])
        if j > 0:
            s0, s1, s2 = cross(moved[3, j], moved[4, j], moved[5, j], f0, f1, f2)
            z0, z1, z2 = z0 + s0, z1 + s1, z2 + s2
        for i in range(6):
            slope[i, j] = rates[i, j]
        for i in range(3):
            slope[6 + i, j] = -rates[6 + i, j]
        slope[9, j] = -rates[9, j] - z0
        slope[10, j] = -rates[10, j] - z1
        slope[11, j] = -rates[11, j] - z2
    return float(rates[5, 0])
