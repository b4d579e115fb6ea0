"""The loaded rod by scipy's `solve_bvp`, from a straight rod or from the one at rest.

Twice: with the compiled right-hand side and Jacobians of `Collocation`, and plainly, as a reader of
scipy's manual would write it, in numpy and without Jacobians. Every case begins anew. At the
settings that reach the accuracy, a guess handed on from case to case does not save time: it lies on
a finer mesh or has to be taken off it, and is no better than the rod at rest.
"""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum

import numpy as np
from scipy.integrate import solve_bvp

from beamopt.base.arrays import FloatArray
from beamopt.comparators.loaded import Loaded, at_rest, loaded_rod
from beamopt.comparators.quaternion_form import arcs_at_rest, boundary, jacobians, slopes
from beamopt.rod.rod import STRAIGHT, Rod

__all__ = ["Start", "compiled_tips", "plain_tips"]

Slopes = Callable[[FloatArray, FloatArray], FloatArray]


class Start(Enum):
    """The guess; the value is for people."""

    STRAIGHT = "from straight"
    REST = "from the shape at rest"


def compiled_tips(
    rod: Rod, rest: FloatArray, start: Start, nodes: int, tolerance: float
) -> FloatArray:
    """(n, 3) tips at the rest strains (n, segments, 6) [mm]; NaN where scipy finds none."""
    x = np.linspace(0, 1, nodes)
    model = loaded_rod(rod, 1)
    tips = np.full((len(rest), 3), np.nan)
    for k, strains in enumerate(at_rest(rest, rod.length)):
        model = model._replace(rest=strains)
        known = strains if start is Start.REST else np.tile(STRAIGHT, (len(strains), 1))
        guess = arcs_at_rest(model._replace(rest=known), x)
        found = _solved(model, x, guess, tolerance)
        if found is not None:
            tips[k] = rod.base.position + rod.length * found
    return tips


def _solved(model: Loaded, x: FloatArray, guess: FloatArray, tolerance: float) -> FloatArray | None:
    n = len(guess)

    def fun(_: FloatArray, y: FloatArray) -> FloatArray:
        return slopes(model, np.ascontiguousarray(y))[0]

    def fun_jac(_: FloatArray, y: FloatArray) -> FloatArray:
        return jacobians(model, np.ascontiguousarray(y))

    def bc(ya: FloatArray, yb: FloatArray) -> FloatArray:
        return boundary(model, ya.copy(), yb.copy())[:, 0].copy()

    def bc_jac(ya: FloatArray, yb: FloatArray) -> tuple[FloatArray, FloatArray]:
        all_slopes = boundary(model, ya.copy(), yb.copy())
        return all_slopes[:, 1 : 1 + n], all_slopes[:, 1 + n :]

    found = solve_bvp(fun, bc, x, guess, fun_jac=fun_jac, bc_jac=bc_jac, tol=tolerance)
    return np.array(found.y[-13:-10, -1]) if found.success else None


def plain_tips(rod: Rod, rest: FloatArray, nodes: int, tolerance: float) -> FloatArray:
    """The same from a straight rod, in mm, mN and numpy.

    rod : of one segment from the origin along z, under a dead line load at its axis and a dead
    force at its tip. Unknowns: position, quaternion, force and moment in space.
    """
    (segment,) = rod.segments
    s = np.linspace(0, rod.length, nodes)
    tips = np.full((len(rest), 3), np.nan)
    for k, strains in enumerate(rest[:, 0]):
        fun = _plain_slopes(rod, strains)
        guess = np.zeros((13, nodes))
        guess[2], guess[3] = s, 1.0

        def bc(ya: FloatArray, yb: FloatArray) -> FloatArray:
            base = [*ya[:3], ya[3] - 1, *ya[4:7]]
            turning = np.cross(
                _rotation(yb[3:7, None])[:, :, 0] @ segment.end.at, segment.end.force
            )
            return np.array([*base, *(yb[7:10] - segment.end.force), *(yb[10:] - turning)])

        found = solve_bvp(fun, bc, s, guess, tol=tolerance)
        if found.success:
            tips[k] = found.y[:3, -1]
    return tips


def _plain_slopes(rod: Rod, rest: FloatArray) -> Slopes:
    (segment,) = rod.segments
    law, free = segment.law, list(segment.law.free)
    give = np.zeros((3, 3))
    give[np.ix_(free, free)] = np.linalg.inv(law.bending[np.ix_(free, free)])

    def slopes_of(_: FloatArray, y: FloatArray) -> FloatArray:
        R = _rotation(y[3:7])
        force = np.einsum("jim,jm->im", R, y[7:10])
        moment = np.einsum("jim,jm->im", R, y[10:13])
        bent = give @ (moment - law.coupling @ force)
        u = rest[:3, None] + bent
        v = rest[3:, None] + law.compliance @ force - law.coupling.T @ bent
        along = np.einsum("ijm,jm->im", R, v)
        result = np.empty_like(y)
        result[:3] = along
        q0, q = y[3], y[4:7]
        result[3] = -np.sum(q * u, axis=0) / 2
        result[4:7] = (q0 * u + np.cross(q, u, axis=0)) / 2
        result[7:10] = -segment.line.force[:, None]
        result[10:] = -np.cross(along, y[7:10], axis=0)
        return result

    return slopes_of


def _rotation(q: FloatArray) -> FloatArray:
    """(3, 3, m) rotations of quaternions (4, m) of any length but none."""
    w, x, y, z = q / np.linalg.norm(q, axis=0)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
