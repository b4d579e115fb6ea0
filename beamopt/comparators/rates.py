"""What a section does under the force and the moment on it, and its derivatives."""

from __future__ import annotations

from beamopt.base.arrays import FloatArray
from beamopt.base.compiled import compiled
from beamopt.comparators.loaded import Loaded

__all__ = ["cross", "strains_and_loads", "times"]

Triple = tuple[float, float, float]


@compiled
def cross(a0: float, a1: float, a2: float, b0: float, b1: float, b2: float) -> Triple:
    """Vector product a × b."""
    return a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0


@compiled
def times(matrix: FloatArray, x: float, y: float, z: float) -> Triple:
    """`matrix` (3, 3) · (x, y, z)."""
    return (
        matrix[0, 0] * x + matrix[0, 1] * y + matrix[0, 2] * z,
        matrix[1, 0] * x + matrix[1, 1] * y + matrix[1, 2] * z,
        matrix[2, 0] * x + matrix[2, 1] * y + matrix[2, 2] * z,
    )


@compiled
def _local(frame: FloatArray, x: float, y: float, z: float) -> Triple:
    """`frame`ᵀ (x, y, z)."""
    return (
        frame[0, 0] * x + frame[1, 0] * y + frame[2, 0] * z,
        frame[0, 1] * x + frame[1, 1] * y + frame[2, 1] * z,
        frame[0, 2] * x + frame[1, 2] * y + frame[2, 2] * z,
    )


@compiled
def strains_and_loads(
    rod: Loaded, k: int, frame: FloatArray, acting: FloatArray, rates: FloatArray
) -> None:
    """Strains and line loads of a section of segment k, in column 0, and their derivatives.

    Parameters
    ----------
    frame : (3, 3) R of the section.
    acting : (9, 1 + p) rows φ, n, m in space. Column 0 are n and m themselves (φ is not read),
        the others are derivatives by p parameters; that of R is [φ]× R.
    rates : (12, 1 + p) rows u, v (local), f, l (in space), written.
    """
    rest, flexibility = rod.rest[k], rod.flexibility[k]
    n0, n1, n2 = acting[3, 0], acting[4, 0], acting[5, 0]
    m0, m1, m2 = acting[6, 0], acting[7, 0], acting[8, 0]
    for j in range(acting.shape[1]):
        a0, a1, a2 = acting[6, j], acting[7, j], acting[8, j]
        b0, b1, b2 = acting[3, j], acting[4, j], acting[5, j]
        if j > 0:  # R^T n changes by R^T (δn + n × φ)
            x0, x1, x2 = cross(m0, m1, m2, acting[0, j], acting[1, j], acting[2, j])
            y0, y1, y2 = cross(n0, n1, n2, acting[0, j], acting[1, j], acting[2, j])
            a0, a1, a2 = a0 + x0, a1 + x1, a2 + x2
            b0, b1, b2 = b0 + y0, b1 + y1, b2 + y2
        a0, a1, a2 = _local(frame, a0, a1, a2)
        b0, b1, b2 = _local(frame, b0, b1, b2)
        for i in range(6):
            row = flexibility[i]
            rates[i, j] = (row[0] * a0 + row[1] * a1 + row[2] * a2) + (
                row[3] * b0 + row[4] * b1 + row[5] * b2
            )
    for i in range(6):
        rates[i, 0] += rest[i]
    _loads(rod.line[k], frame, acting, rates)


@compiled
def _loads(line: FloatArray, frame: FloatArray, acting: FloatArray, rates: FloatArray) -> None:
    """Loads f = force + R follower and l = (R at) × f into rows 6… of `rates`, and derivatives."""
    g0, g1, g2 = times(frame, line[1, 0], line[1, 1], line[1, 2])
    r0, r1, r2 = times(frame, line[2, 0], line[2, 1], line[2, 2])
    f0, f1, f2 = line[0, 0] + g0, line[0, 1] + g1, line[0, 2] + g2
    rates[6, 0], rates[7, 0], rates[8, 0] = f0, f1, f2
    rates[9, 0], rates[10, 0], rates[11, 0] = cross(r0, r1, r2, f0, f1, f2)
    for j in range(1, acting.shape[1]):
        p0, p1, p2 = acting[0, j], acting[1, j], acting[2, j]
        d0, d1, d2 = cross(p0, p1, p2, g0, g1, g2)
        s0, s1, s2 = cross(p0, p1, p2, r0, r1, r2)
        x0, x1, x2 = cross(s0, s1, s2, f0, f1, f2)
        y0, y1, y2 = cross(r0, r1, r2, d0, d1, d2)
        rates[6, j], rates[7, j], rates[8, j] = d0, d1, d2
        rates[9, j], rates[10, j], rates[11, j] = x0 + y0, x1 + y1, x2 + y2
