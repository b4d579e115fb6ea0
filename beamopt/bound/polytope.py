"""Half spaces around a convex set, least squares within them, and the set's nearest point."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from beamopt.base.arrays import FloatArray

__all__ = ["Cuts", "Nearest", "least_squares_within", "nearest_point"]

Support = Callable[[FloatArray], tuple[float, FloatArray]]
"""h(d) of a direction (n,) and the point (n,) of the set where it is attained."""

Residuals = Callable[[FloatArray], tuple[FloatArray, FloatArray] | None]
"""Residuals (m,) at a point (n,) and their derivatives (m, n); None where there are none."""

SAME = 1e-9  # distance at which a point counts as the set's own
DEEP = 0.9  # a cut that takes this share of the distance is good enough
MOST_POINTS = 200
MOST_STEPS, MOST_DAMPING = 200, 1e10
SETTLED = 1e-12


@dataclass(frozen=True, eq=False)
class Cuts:
    """Half spaces: points x with normals (k, n) · x ≤ limits (k,)."""

    normals: FloatArray
    limits: FloatArray

    def with_more(self, other: Cuts) -> Cuts:
        """These and others."""
        normals = np.vstack([self.normals, other.normals])
        return Cuts(normals, np.concatenate([self.limits, other.limits]))

    def excess(self, point: FloatArray) -> float:
        """How far a point (n,) is beyond the worst of them; negative inside."""
        return float((self.normals @ point - self.limits).max())

    def deepest(self, point: FloatArray, count: int) -> Cuts:
        """The `count` of them that a point (n,) is farthest beyond."""
        kept = np.argsort(self.limits - self.normals @ point, kind="stable")[:count]
        return Cuts(self.normals[kept], self.limits[kept])

    def nearest(self, point: FloatArray) -> FloatArray | None:
        """The point within them that is nearest to (n,); None where there is none."""
        step = _least_distance(-self.normals, self.normals @ point - self.limits)
        return None if step is None else point + step


@dataclass(frozen=True, eq=False)
class Nearest:
    """Where a point is against a convex set.

    point : (n,) of the set, nearest but for `DEEP`. distance : to it.
    cuts : half spaces around the set that were met; where the point is outside, it is beyond one.
    corners : (k, n) points of the set that were met.
    """

    point: FloatArray
    distance: float
    cuts: Cuts
    corners: FloatArray


def nearest_point(support: Support, point: FloatArray, known: FloatArray) -> Nearest:
    """The nearest point of a convex set that is known by its support function.

    The set's points found so far span a polytope; its nearest point x gives the direction
    d = point − x, and the set's farthest point along d joins them (Frank and Wolfe's method with
    all weights corrected, after Wolfe). It ends where a cut takes most of the distance |d|, which
    is then known from both sides, or where d vanishes.

    known : (k, n) points of the set, one or more.
    """
    corners, normals, limits, met = known, [], [], []
    for _ in range(MOST_POINTS):
        weights = _mixture(corners, point)
        corners, weights = corners[weights > 0], weights[weights > 0]
        nearest = weights @ corners
        away = point - nearest
        distance = float(np.linalg.norm(away))
        if distance < SAME:
            break
        normal = away / distance
        limit, corner = support(normal)
        normals.append(normal)
        limits.append(limit)
        progress = limit - float(normal @ nearest)
        if float(normal @ point) - limit > DEEP * distance or progress < SAME * 1e-2:
            break
        corners = np.vstack([corners, corner])
        met.append(corner)
    cuts = Cuts(np.reshape(normals, (-1, len(point))), np.array(limits))
    return Nearest(nearest, distance, cuts, np.vstack([corners, *met]))


def least_squares_within(
    residuals: Residuals, cuts: Cuts, start: FloatArray
) -> tuple[FloatArray, float]:
    """A local minimum of |residuals|² within cuts, and its value.

    Levenberg and Marquardt's method; every step solves its linear least squares problem under the
    cuts exactly. start : (n,) within the cuts, with residuals.

    Raises
    ------
    ValueError : there are no residuals at the start.
    """
    point, found, damping = start, residuals(start), 1e-3
    if found is None:
        raise ValueError("no residuals at the start")
    value = float(found[0] @ found[0])
    for _ in range(MOST_STEPS):
        steepness = float((found[1] ** 2).sum())
        if steepness == 0:  # nothing moves the residuals
            break
        step = _step(*found, damping * steepness, cuts, point)
        trial = None if step is None else residuals(point + step)
        lowered = np.inf if trial is None else float(trial[0] @ trial[0])
        if trial is not None and step is not None and lowered < value:
            settled = value - lowered <= SETTLED * value
            point, found, value, damping = point + step, trial, lowered, max(damping / 5, 1e-14)
            if settled:
                break
        else:
            damping *= 5
            if damping > MOST_DAMPING:
                break
    return point, value


def _step(
    residual: FloatArray, slopes: FloatArray, damping: float, cuts: Cuts, point: FloatArray
) -> FloatArray | None:
    """min |residual + slopes x|² + damping |x|² with normals · (point + x) ≤ limits.

    With the triangle R of the stacked matrix and x = R⁻¹ y + x0, x0 the free minimum, the sum is
    |y|² and a constant: the least y under the cuts (Lawson and Hanson's least distance).
    """
    count = len(point)
    stacked = np.vstack([slopes, np.sqrt(damping) * np.eye(count)])
    q, r = np.linalg.qr(stacked)
    free = np.linalg.solve(r, -q.T @ np.concatenate([residual, np.zeros(count)]))
    beyond = cuts.normals @ (point + free) - cuts.limits
    if (beyond <= 0).all():
        return np.asarray(free)
    least = _least_distance(-np.linalg.solve(r.T, cuts.normals.T).T, beyond)
    return None if least is None else np.asarray(free + np.linalg.solve(r, least))


def _least_distance(normals: FloatArray, limits: FloatArray) -> FloatArray | None:
    """The shortest x (n,) with normals (k, n) · x ≥ limits (k,); None where there is none.

    After Lawson and Hanson: with the weights u ≥ 0 that bring [normalsᵀ; limitsᵀ] u nearest to
    (0, …, 0, 1) and the difference r, x = −r_1…n / r_n+1.
    """
    from scipy.optimize import nnls

    if (limits <= 0).all():
        return np.zeros(normals.shape[1])
    scale = np.maximum(np.linalg.norm(normals, axis=1), 1e-300)
    rows = np.column_stack([normals, limits]) / scale[:, None]
    goal = np.zeros(rows.shape[1])
    goal[-1] = 1.0
    try:
        weights, _ = nnls(rows.T, goal, maxiter=20 * len(rows))
    except RuntimeError:  # it turned in circles
        return None
    difference = rows.T @ weights - goal
    if abs(difference[-1]) < 1e-14:
        return None
    return np.asarray(-difference[:-1] / difference[-1])


def _mixture(corners: FloatArray, point: FloatArray) -> FloatArray:
    """(k,) weights, at least 0 and 1 together, of the mixture that is nearest to a point (n,)."""
    from scipy.optimize import nnls

    if len(corners) == 1:
        return np.ones(1)
    moved = corners - point  # so that a point of the set is 0, without cancellation
    heavy = 1e3 * max(1e-12, float(np.linalg.norm(moved, axis=1).max()))
    rows = np.vstack([moved.T, np.full(len(corners), heavy)])
    goal = np.zeros(len(rows))
    goal[-1] = heavy
    weights, _ = nnls(rows, goal, maxiter=50 * len(corners))
    return np.asarray(weights / weights.sum())
