"""One step of the classical Runge-Kutta method, the rotation being a quaternion."""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.compiled import compiled
from beamopt.comparators.elimination import assign
from beamopt.comparators.loaded import Loaded
from beamopt.comparators.rates import cross, strains_and_loads, times

__all__ = ["runge_kutta_step", "slope_of", "turned_by"]


@compiled
def runge_kutta_step(
    rod: Loaded, k: int, length: float, frame: FloatArray, state: FloatArray, work: FloatArray
) -> float:
    """Advance by `length` in segment k; returns the least v3 met.

    The unknowns are h, q, n, m with R = R_start R(q), q' = q (0, u)/2; q starts from 1, which is
    the same as carrying one quaternion all along, since the method commutes with R_start. It is
    normalised where it is used. Runge-Kutta commutes with derivatives: those are of the step.

    Parameters
    ----------
    frame : (3, 3) R, changed.
    state : (12, 1 + p) rows h, φ, n, m; column 0 the values (φ not used), then derivatives by p
        parameters, that of R being [φ]× R. Changed.
    work : (≥ 73, 1 + p) overwritten.
    """
    columns = state.shape[1]
    x, slope, total, start = work[0:13], work[13:26], work[26:39], work[39:52]
    turned = np.empty((3, 3))
    for i in range(3):
        for j in range(columns):
            start[i, j] = state[i, j]
            start[7 + i, j] = state[6 + i, j]
            start[10 + i, j] = state[9 + i, j]
    for i in range(4):
        for j in range(columns):
            start[3 + i, j] = 1.0 if i == 0 and j == 0 else 0.0
    assign(x, start)
    assign(total, start)
    least = 1e300
    for stage in range(4):
        v3 = slope_of(rod, k, frame, state, x, slope, turned, work)
        least = min(least, v3)
        ahead = length if stage == 2 else length / 2
        weight = length / 6 if stage in (0, 3) else length / 3
        for i in range(13):
            for j in range(columns):
                x[i, j] = start[i, j] + ahead * slope[i, j]
                total[i, j] += weight * slope[i, j]
    turned_by(total, frame, state[3:6], turned)
    for i in range(3):
        for j in range(columns):
            state[i, j] = total[i, j]
            state[6 + i, j] = total[7 + i, j]
            state[9 + i, j] = total[10 + i, j]
    assign(frame, turned)
    return least


@compiled
def turned_by(x: FloatArray, frame: FloatArray, turn: FloatArray, turned: FloatArray) -> None:
    """R = `frame` R(q)/|q|² into `turned`, and its φ into `turn` (3, 1 + p), where that of `frame`
    was: φ = φ_frame + frame · 2 vec(δq q̄)/|q|². Rows 3…6 of `x` are q and its derivatives.
    """
    a, b, c, d = x[3, 0], x[4, 0], x[5, 0], x[6, 0]
    size = a * a + b * b + c * c + d * d
    for i in range(3):
        e0, e1, e2 = frame[i, 0], frame[i, 1], frame[i, 2]
        turned[i, 0] = (
            e0 * (a * a + b * b - c * c - d * d)
            + 2 * e1 * (b * c + a * d)
            + 2 * e2 * (b * d - a * c)
        ) / size
        turned[i, 1] = (
            2 * e0 * (b * c - a * d)
            + e1 * (a * a - b * b + c * c - d * d)
            + 2 * e2 * (c * d + a * b)
        ) / size
        turned[i, 2] = (
            2 * e0 * (b * d + a * c)
            + 2 * e1 * (c * d - a * b)
            + e2 * (a * a - b * b - c * c + d * d)
        ) / size
    for j in range(1, x.shape[1]):
        da, db, dc, dd = x[3, j], x[4, j], x[5, j], x[6, j]
        y0, y1, y2 = cross(db, dc, dd, b, c, d)
        p0 = 2 * (a * db - da * b - y0) / size
        p1 = 2 * (a * dc - da * c - y1) / size
        p2 = 2 * (a * dd - da * d - y2) / size
        p0, p1, p2 = times(frame, p0, p1, p2)
        turn[0, j] += p0
        turn[1, j] += p1
        turn[2, j] += p2


@compiled
def slope_of(
    rod: Loaded,
    k: int,
    frame: FloatArray,
    state: FloatArray,
    x: FloatArray,
    slope: FloatArray,
    turned: FloatArray,
    work: FloatArray,
) -> float:
    """Derivatives of h, q, n, m along the rod into `slope` (13, 1 + p); returns v3."""
    columns = x.shape[1]
    acting, rates = work[52:61], work[61:73]
    for i in range(3):
        for j in range(columns):
            acting[i, j] = state[3 + i, j]
            acting[3 + i, j] = x[7 + i, j]
            acting[6 + i, j] = x[10 + i, j]
    turned_by(x, frame, acting[0:3], turned)
    strains_and_loads(rod, k, turned, acting, rates)
    a, b, c, d = x[3, 0], x[4, 0], x[5, 0], x[6, 0]
    u0, u1, u2 = rates[0, 0], rates[1, 0], rates[2, 0]
    n0, n1, n2 = x[7, 0], x[8, 0], x[9, 0]
    t0, t1, t2 = times(turned, rates[3, 0], rates[4, 0], rates[5, 0])
    for j in range(columns):
        if j == 0:
            h0, h1, h2 = t0, t1, t2
            y0, y1, y2 = 0.0, 0.0, 0.0
            da, db, dc, dd = _quaternion_slope(a, b, c, d, u0, u1, u2)
        else:
            h0, h1, h2 = times(turned, rates[3, j], rates[4, j], rates[5, j])
            z0, z1, z2 = cross(acting[0, j], acting[1, j], acting[2, j], t0, t1, t2)
            h0, h1, h2 = h0 + z0, h1 + z1, h2 + z2
            y0, y1, y2 = cross(t0, t1, t2, x[7, j], x[8, j], x[9, j])
            da, db, dc, dd = _quaternion_slope(x[3, j], x[4, j], x[5, j], x[6, j], u0, u1, u2)
            ea, eb, ec, ed = _quaternion_slope(a, b, c, d, rates[0, j], rates[1, j], rates[2, j])
            da, db, dc, dd = da + ea, db + eb, dc + ec, dd + ed
        m0, m1, m2 = cross(h0, h1, h2, n0, n1, n2)
        slope[0, j], slope[1, j], slope[2, j] = h0, h1, h2
        slope[3, j], slope[4, j], slope[5, j], slope[6, j] = da, db, dc, dd
        for i in range(3):
            slope[7 + i, j] = -rates[6 + i, j]
        slope[10, j] = -m0 - y0 - rates[9, j]
        slope[11, j] = -m1 - y1 - rates[10, j]
        slope[12, j] = -m2 - y2 - rates[11, j]
    return float(rates[5, 0])


@compiled
def _quaternion_slope(
    a: float, b: float, c: float, d: float, u0: float, u1: float, u2: float
) -> tuple[float, float, float, float]:
    """Q (0, u)/2."""
    return (
        -(b * u0 + c * u1 + d * u2) / 2,
        (a * u0 + c * u2 - d * u1) / 2,
        (a * u1 + d * u0 - b * u2) / 2,
        (a * u2 + b * u1 - c * u0) / 2,
    )
