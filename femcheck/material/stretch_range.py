"""Up to which stretch an isotropic law describes a material: as long as its responses rise.

A polynomial that is fitted to a test curve describes it up to the stretch that was measured;
beyond, a negative constant turns the stress down, and the law has no stable equilibrium that means
anything. In each of three tests of an incompressible body, λ along one or two axes, two things are
looked at:

- the nominal stress, which rises where the energy W(λ) of the test is convex;
- Hill's condition: the second derivative of W by the logarithms of two principal stretches, the
  third following from the volume, is positive definite, so that the Kirchhoff stress works
  positively on every further strain along the axes.

With non-negative constants both hold at any stretch.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from beamopt.base.arrays import FloatArray

__all__ = ["StretchRange", "stretch_range"]

Slopes = Callable[[FloatArray], tuple[FloatArray, FloatArray]]
"""f′ and f″ (n,) by I1 − 3."""

UNIAXIAL, PLANAR, EQUIBIAXIAL = -0.5, 0.0, 1.0
"""t of a test whose stretches are λ, λᵗ and λ^−(1 + t)."""

MOST, STEPS = 1e3, 6000
"""Largest stretch that is looked at, and points up to it."""


class StretchRange(NamedTuple):
    """Largest stretch up to which the response rises in each test; ∞ where it always does."""

    uniaxial: float
    planar: float
    equibiaxial: float

    @property
    def least(self) -> float:
        """The stretch up to which it rises in all of them."""
        return min(self)

    @property
    def text(self) -> str:
        """For people; "" where there is no end."""
        if math.isinf(self.least):
            return ""
        parts = (f"{name} {_shown(end)}" for name, end in zip(self._fields, self, strict=True))
        return f"{self.least:.3g} ({', '.join(parts)})"


def _shown(end: float) -> str:
    return "always" if math.isinf(end) else f"{end:.3g}"


def stretch_range(slopes: Slopes, C2: float) -> StretchRange:
    """The range of W = f(I1) + C2 (I2 − 3), incompressible; C2 as f′ in kPa."""
    return StretchRange(*(_end(slopes, C2, t) for t in (UNIAXIAL, PLANAR, EQUIBIAXIAL)))


def _end(slopes: Slopes, C2: float, t: float) -> float:
    """The smallest stretch at which a test's response stops to rise; ∞ where none is found."""
    from scipy.optimize import brentq

    stretches = np.geomspace(1.0, MOST, STEPS)
    rises = _least_rise(stretches, slopes, C2, t)
    with np.errstate(invalid="ignore"):
        falls = np.flatnonzero(rises <= 0)
    if not falls.size:
        return math.inf
    first = int(falls[0])
    if first == 0:
        return 1.0

    def rise(stretch: float) -> float:
        return float(_least_rise(np.array([stretch]), slopes, C2, t)[0])

    return float(brentq(rise, stretches[first - 1], stretches[first], xtol=1e-12))


def _least_rise(stretch: FloatArray, slopes: Slopes, C2: float, t: float) -> FloatArray:
    """(n,) positive up to where the nominal stress or Hill's condition fails; NaN: no energy.

    Hill's condition holds at rest, and so up to where the determinant vanishes.
    """
    powers = np.array([2.0, 2 * t, -2 * (1 + t)])
    a = stretch[:, None] ** powers  # squares of the principal stretches
    with np.errstate(all="ignore"):
        b = 1 / a
        slope, bend = slopes(a.sum(axis=1) - 3)
        first = (powers * a).sum(axis=1)  # of I1, by ln λ
        second = (powers * (powers - 1) * a).sum(axis=1)  # of I1, λ² times that by λ
        other = (powers * (powers + 1) * b).sum(axis=1)  # of I2, likewise
        nominal = bend * first**2 + slope * second + C2 * other
        return np.asarray(np.minimum(nominal, _determinant(a, b, slope, bend, C2)))


def _determinant(
    a: FloatArray, b: FloatArray, slope: FloatArray, bend: FloatArray, C2: float
) -> FloatArray:
    """(n,) of the second derivative of W by the logarithms of two stretches, over 16.

    That is 4 f′ M(a) + 4 C2 M(b) + f″ g gᵀ, M(p) = [[p1 + p3, p3], [p3, p2 + p3]] and
    g = 2 (a1 − a3, a2 − a3); multiplied out all parts are sums of what is positive.
    """
    gaps = (np.roll(a, -1, axis=1) - np.roll(a, 1, axis=1)) ** 2  # (a2 − a3)², …
    plain = slope**2 * b.sum(axis=1) + C2**2 * a.sum(axis=1)  # a1 a2 a3 = 1
    mixed = slope * C2 * (a.sum(axis=1) * b.sum(axis=1) - 3)
    bent = slope * (a * gaps).sum(axis=1) + C2 * (b * gaps).sum(axis=1)
    return np.asarray(plain + mixed + bend * bent)
