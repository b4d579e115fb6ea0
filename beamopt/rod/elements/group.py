"""Rigid motions: exponential and logarithm on SE(3), and the latter's first two derivatives.

A motion is a frame (R, h); its increments are twists x = (rotation, translation) in the frame's own
axes, g ← g exp(x). With ad_x y = (u × a, v × a + u × b) for x = (u, v), y = (a, b), the inverse of
the right tangent T(φ) = Σ (−ad)ⁿ/(n + 1)! is (Sonneville, Cardona & Brüls 2014, appendix)

    T⁻¹(φ) = 1 + ad/2 + c2 ad² + c4 ad⁴,   since ad (ad² + |u|²)² = 0 on se(3),

where 1 − c2 w + c4 w² equals γ(w) = θ/2 cot θ/2 up to its first derivative, w = |u|² = θ².
"""

from __future__ import annotations

import math

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.compiled import compiled

__all__ = [
    "exponential",
    "inverse_tangent",
    "logarithm",
    "multiply",
    "multiply_back",
    "skew",
    "tangent_slope",
    "turn",
]

# γ = 1 − Σ GAMMA[k − 1] wᵏ, |B_2k|/(2k)! = 2 ζ(2k)/(2π)^2k
GAMMA = np.array(
    [
        *(1 / 12, 1 / 720, 1 / 30240, 1 / 1209600, 1 / 47900160, 691 / 1307674368000),
        *(1 / 74724249600, 3617 / 10670622842880000, 43867 / 5109094217170944000),
        *(174611 / 802857662698291200000, 77683 / 14101100039391805440000),
        236364091 / 1693824136731743669452800000,
    ]
)
SERIES_BELOW = 1.0
"""θ² below which coefficients are summed as series; its remainder is below 1e-18 there."""


@compiled
def multiply(a: FloatArray, b: FloatArray, out: FloatArray) -> None:
    """Write the product of small matrices a (n, k) and b (k, m) into `out`, a third one."""
    for i in range(a.shape[0]):
        for j in range(b.shape[1]):
            total = 0.0
            for k in range(a.shape[1]):
                total += a[i, k] * b[k, j]
            out[i, j] = total


@compiled
def multiply_back(a: FloatArray, b: FloatArray, out: FloatArray) -> None:
    """Write aᵀ b into `out`: of rotations, b as seen from a."""
    for i in range(a.shape[1]):
        for j in range(b.shape[1]):
            total = 0.0
            for k in range(a.shape[0]):
                total += a[k, i] * b[k, j]
            out[i, j] = total


@compiled
def turn(u: FloatArray, x: FloatArray) -> tuple[float, float, float]:
    """Cross product u × x."""
    return (
        u[1] * x[2] - u[2] * x[1],
        u[2] * x[0] - u[0] * x[2],
        u[0] * x[1] - u[1] * x[0],
    )


@compiled
def coefficients(w: float) -> tuple[float, float, float, float]:
    """c2, c4 and their derivatives by w = θ²."""
    if w < SERIES_BELOW:
        c2, c4, d2, d4 = 0.0, 0.0, 0.0, 0.0
        for k in range(GAMMA.size, 0, -1):
            g = -GAMMA[k - 1]
            c2 = c2 * w + (k - 2) * g
            if k >= 2:
                c4 = c4 * w + (k - 1) * g
                d2 = d2 * w + (k - 2) * (k - 1) * g
            if k >= 3:
                d4 = d4 * w + (k - 1) * (k - 2) * g
        return c2, c4, d2, d4
    half = math.sqrt(w) / 2
    g = half / math.tan(half)
    g1 = (g - g * g - w / 4) / (2 * w)
    g2 = (-g1 - 2 * g * g1 - 0.25) / (2 * w)
    c4 = (w * g1 - g + 1) / (w * w)
    d4 = (g2 - 2 * c4) / w
    return 2 * w * c4 - g1, c4, 2 * c4 + 2 * w * d4 - g2, d4


@compiled
def exponential(x: FloatArray, R: FloatArray, h: FloatArray) -> None:
    """Exp of the twist x (6,), written into the frame R (3, 3), h (3,)."""
    u, v = x[:3], x[3:]
    w = u[0] * u[0] + u[1] * u[1] + u[2] * u[2]
    if w < 0.01:
        a = 1 - w / 6 * (1 - w / 20 * (1 - w / 42 * (1 - w / 72)))
        b = (1 - w / 12 * (1 - w / 30 * (1 - w / 56 * (1 - w / 90)))) / 2
        c = (1 - w / 20 * (1 - w / 42 * (1 - w / 72 * (1 - w / 110)))) / 6
    else:
        angle = math.sqrt(w)
        a = math.sin(angle) / angle
        b = 2 * (math.sin(angle / 2) / angle) ** 2
        c = (1 - a) / w
    for i in range(3):
        for j in range(3):
            R[i, j] = b * u[i] * u[j]
        R[i, i] += 1 - b * w
    R[0, 1] -= a * u[2]
    R[1, 0] += a * u[2]
    R[0, 2] += a * u[1]
    R[2, 0] -= a * u[1]
    R[1, 2] -= a * u[0]
    R[2, 1] += a * u[0]
    along = u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
    across = turn(u, v)
    for i in range(3):
        h[i] = (1 - c * w) * v[i] + b * across[i] + c * along * u[i]


@compiled
def quaternion(R: FloatArray) -> tuple[float, float, float, float]:
    """Scalar and vector part, scalar part not negative, from the largest of the four (Shepperd)."""
    trace = R[0, 0] + R[1, 1] + R[2, 2]
    if trace > 0:
        q = math.sqrt(1 + trace) / 2
        f = 0.25 / q
        return q, f * (R[2, 1] - R[1, 2]), f * (R[0, 2] - R[2, 0]), f * (R[1, 0] - R[0, 1])
    i = 0
    for j in range(1, 3):
        if R[j, j] > R[i, i]:
            i = j
    j, k = (i + 1) % 3, (i + 2) % 3
    vector = np.empty(3)
    vector[i] = math.sqrt(max(1 + 2 * R[i, i] - trace, 0.0)) / 2
    f = 0.25 / vector[i]
    vector[j] = f * (R[j, i] + R[i, j])
    vector[k] = f * (R[k, i] + R[i, k])
    q = f * (R[k, j] - R[j, k])
    sign = -1.0 if q < 0 else 1.0
    return sign * q, sign * vector[0], sign * vector[1], sign * vector[2]


@compiled
def logarithm(R: FloatArray, h: FloatArray, x: FloatArray) -> None:
    """Write into x (6,) the twist with exp x = (R, h) whose rotation is nearest to the one in x.

    So an element may turn by more than π, if it does so little by little.
    """
    q, q0, q1, q2 = quaternion(R)
    size = math.sqrt(q0 * q0 + q1 * q1 + q2 * q2)
    ratio = 2 / q
    if size > 1e-8:
        angle = 2 * math.atan2(size, q)
        near = (x[0] * q0 + x[1] * q1 + x[2] * q2) / size
        angle += 2 * math.pi * math.floor((near - angle) / (2 * math.pi) + 0.5)
        ratio = angle / size
    x[0], x[1], x[2] = ratio * q0, ratio * q1, ratio * q2
    u = x[:3]
    w = u[0] * u[0] + u[1] * u[1] + u[2] * u[2]
    c2, c4, _, _ = coefficients(w)
    f = c2 - c4 * w  # (1 − γ)/w
    across = turn(u, h)
    along = u[0] * h[0] + u[1] * h[1] + u[2] * h[2]
    for i in range(3):
        x[3 + i] = (1 - f * w) * h[i] - across[i] / 2 + f * along * u[i]


@compiled
def skew(u: FloatArray, sign: float, out: FloatArray, row: int, column: int) -> None:
    """Add sign · [u]× to `out` from (row, column) on."""
    out[row, column + 1] -= sign * u[2]
    out[row, column + 2] += sign * u[1]
    out[row + 1, column] += sign * u[2]
    out[row + 1, column + 2] -= sign * u[0]
    out[row + 2, column] -= sign * u[1]
    out[row + 2, column + 1] += sign * u[0]


@compiled
def add_coadjoint(s: FloatArray, out: FloatArray) -> None:
    """Add to `out` the (6, 6) matrix C(s) with C(s) x = ad_xᵀ s, linear in s = (m, n)."""
    skew(s[:3], 1.0, out, 0, 0)
    skew(s[3:], 1.0, out, 0, 3)
    skew(s[3:], 1.0, out, 3, 0)


@compiled
def inverse_tangent(x: FloatArray, forth: FloatArray, back: FloatArray) -> None:
    """Write T⁻¹(x) into `forth` and T⁻¹(−x) into `back`, (6, 6) both.

    d log(exp(−a) exp(x) exp(b)) = T⁻¹(x) db − T⁻¹(−x) da at a = b = 0.
    """
    c2, c4, _, _ = coefficients(x[0] * x[0] + x[1] * x[1] + x[2] * x[2])
    ad = np.zeros((6, 6))
    skew(x[:3], 1.0, ad, 0, 0)
    skew(x[:3], 1.0, ad, 3, 3)
    skew(x[3:], 1.0, ad, 3, 0)
    second, fourth = np.empty((6, 6)), np.empty((6, 6))
    multiply(ad, ad, second)
    multiply(second, second, fourth)
    for i in range(6):
        for j in range(6):
            even = c2 * second[i, j] + c4 * fourth[i, j]
            if i == j:
                even += 1
            forth[i, j] = even + ad[i, j] / 2
            back[i, j] = even - ad[i, j] / 2


@compiled
def tangent_slope(x: FloatArray, s: FloatArray, forth: FloatArray, back: FloatArray) -> None:
    """Derivatives (6, 6) of T⁻ᵀ(x) s by x, at x and at −x, for a fixed wrench s = (m, n)."""
    c2, c4, d2, d4 = coefficients(x[0] * x[0] + x[1] * x[1] + x[2] * x[2])
    transposed = np.zeros((6, 6))
    skew(x[:3], -1.0, transposed, 0, 0)
    skew(x[:3], -1.0, transposed, 3, 3)
    skew(x[3:], -1.0, transposed, 0, 3)
    powers = np.zeros((5, 6))  # Aⁿ s with A = adᵀ
    for i in range(6):
        powers[0, i] = s[i]
    for n in range(4):
        for i in range(6):
            for j in range(6):
                powers[n + 1, i] += transposed[i, j] * powers[n, j]
    # Horner: C(A³s) + A (C(A²s) + A (C(As) + A C(s))), of which the innermost bracket is that of c2
    first, inner = np.zeros((6, 6)), np.empty((6, 6))
    outer, last = np.empty((6, 6)), np.empty((6, 6))
    add_coadjoint(s, first)
    multiply(transposed, first, inner)
    add_coadjoint(powers[1], inner)
    multiply(transposed, inner, outer)
    add_coadjoint(powers[2], outer)
    multiply(transposed, outer, last)
    add_coadjoint(powers[3], last)
    for i in range(6):
        slope = 2 * (d2 * powers[2, i] + d4 * powers[4, i])
        for j in range(6):
            odd = c2 * inner[i, j] + c4 * last[i, j]
            if j < 3:
                odd += slope * x[j]
            forth[i, j] = first[i, j] / 2 + odd
            back[i, j] = first[i, j] / 2 - odd
