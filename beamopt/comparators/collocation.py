"""Collocation: scipy's `solve_bvp` on the rod's equations with a quaternion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from time import thread_time
from typing import Any
from warnings import catch_warnings, simplefilter

import numpy as np
from scipy.integrate import solve_bvp
from scipy.interpolate import PPoly

from beamopt.base.arrays import FloatArray
from beamopt.comparators.following import Attempt, solve_cases
from beamopt.comparators.growing import under
from beamopt.comparators.loaded import Loaded, at_rest, loaded_rod
from beamopt.comparators.quaternion_form import (
    arcs_at_rest,
    boundary,
    jacobians,
    rotation_of,
    slopes,
)
from beamopt.rod.rod import Rod
from beamopt.rod.solution import RodSolution
from beamopt.rod.status import RodStatus

__all__ = ["Collocation"]

STATUS = {
    0: RodStatus.CONVERGED,
    1: RodStatus.UNRESOLVED,
    2: RodStatus.DIVERGED,
    3: RodStatus.DIVERGED,
}
"""What `solve_bvp` calls success, too many nodes, a singular Jacobian, a missed boundary."""
INTERVALS_DRAWN = 32
"""Of a segment's axis, in the solution."""


@dataclass(frozen=True)
class Collocation:
    """Lobatto collocation of order four (Kierzenka & Shampine, ACM TOMS 27, 2001) from scipy.

    Segments lie side by side on the interval 0…1: 13 unknown functions each (h, q, n, m).
    Right-hand side, its Jacobian and those of the boundary are compiled. Resolution r asks for
    residuals below 10⁻ʳ, of the differential equations relative to 1 + |slope| and of the boundary;
    converged means that scipy finds them so.

    nodes : of the first mesh. most_nodes : of the finest.
    warm : start from the case before, not from the rod at rest. Its values are taken on the first
        mesh: scipy only ever adds nodes, so that a mesh handed on grows from case to case.
    first_step : share of the loads that is tried first from the rod at rest.
    seconds : of processor time that a case may take; the very first call compiles, and that counts.
    """

    nodes: int = 9
    most_nodes: int = 10_000
    warm: bool = False
    first_step: float = 1.0
    seconds: float = 60.0
    resolutions: Sequence[int] = field(default=(2, 3, 4, 5, 6, 7, 8, 9))
    name: str = "collocation"

    def solve(self, rod: Rod, rest: FloatArray, resolution: int) -> RodSolution:
        """Solve for the rest strains (n, segments, 6) of n cases, to 10^−resolution."""
        if len(rod.base.hinges):
            return RodSolution.unsolved(len(rest), RodStatus.NOT_REPRESENTABLE, rod.length)
        model = loaded_rod(rod, 1)
        cases = [
            _Case(rod, model._replace(rest=one), self, resolution)
            for one in at_rest(rest, rod.length)
        ]
        inside = np.linspace(0, 1, INTERVALS_DRAWN + 1)[1:]
        starts = np.cumsum(model.lengths) - model.lengths
        stations = np.append(0.0, starts[:, None] + model.lengths[:, None] * inside)
        return solve_cases(
            cases,
            stations * rod.length,
            self.seconds,
            self.first_step,
            from_previous=self.warm,
        )


class _OutOfTimeError(Exception):
    """Out of time: the only way out of `solve_bvp`."""


@dataclass(frozen=True, eq=False)
class _Mesh:
    """x (m,), y (13 s, m) on it, and the polynomials in between, if they are a solution's."""

    x: FloatArray
    y: FloatArray
    between: PPoly[np.float64] | None = None


class _Case:
    """One case; its shape is a mesh and the unknowns there."""

    def __init__(self, rod: Rod, model: Loaded, method: Collocation, resolution: int) -> None:
        self.rod = rod
        self.model = model
        self.method = method
        self.tolerance = 10.0**-resolution
        self.evaluations = 0
        x = np.linspace(0, 1, method.nodes)
        self.at_rest = _Mesh(x, arcs_at_rest(model, x))

    def unloaded(self) -> _Mesh:
        return self.at_rest

    def attempt(self, guess: _Mesh, factor: float, seconds: float) -> Attempt[_Mesh]:
        before, end = self.evaluations, thread_time() + seconds
        tip = self.at_rest.y[-13:, -1]
        model = under(self.model, factor, tip[:3], rotation_of(tip[3:7]))
        try:
            found = self._solve_bvp(model, guess, end)
        except _OutOfTimeError:
            return Attempt(RodStatus.TOO_SLOW, guess, self.evaluations - before)
        except (ValueError, RuntimeError, ArithmeticError):  # not finite
            return Attempt(RodStatus.DIVERGED, guess, self.evaluations - before)
        status = STATUS[found.status]
        if status is RodStatus.CONVERGED:
            _, least = slopes(model, found.y)
            if not least > 0:
                status = RodStatus.CRUSHED
        shape = _Mesh(found.x, found.y, found.sol)
        return Attempt(status, shape, self.evaluations - before)

    def _solve_bvp(self, model: Loaded, guess: _Mesh, end: float) -> Any:
        n = len(guess.y)

        def fun(_: FloatArray, y: FloatArray) -> FloatArray:
            if thread_time() > end:
                raise _OutOfTimeError
            self.evaluations += 1
            return slopes(model, np.ascontiguousarray(y))[0]

        def fun_jac(_: FloatArray, y: FloatArray) -> FloatArray:
            return jacobians(model, np.ascontiguousarray(y))

        def bc(ya: FloatArray, yb: FloatArray) -> FloatArray:
            return boundary(model, ya.copy(), yb.copy())[:, 0].copy()

        def bc_jac(ya: FloatArray, yb: FloatArray) -> tuple[FloatArray, FloatArray]:
            all_slopes = boundary(model, ya.copy(), yb.copy())
            return all_slopes[:, 1 : 1 + n], all_slopes[:, 1 + n :]

        with np.errstate(all="ignore"), catch_warnings():
            simplefilter("ignore")
            return solve_bvp(
                fun,
                bc,
                self.at_rest.x,
                guess.y if guess.between is None else guess.between(self.at_rest.x),
                fun_jac=fun_jac,
                bc_jac=bc_jac,
                tol=self.tolerance,
                max_nodes=self.method.most_nodes,
            )

    def drawn(self, shape: _Mesh) -> tuple[FloatArray, FloatArray]:
        assert shape.between is not None
        y = shape.between(np.linspace(0, 1, INTERVALS_DRAWN + 1))
        parts = y.reshape(-1, 13, INTERVALS_DRAWN + 1)[:, :3]
        line = np.concatenate([parts[0, :, :1], *(part[:, 1:] for part in parts)], axis=1).T
        line = self.rod.base.position + self.rod.length * line
        return line, rotation_of(shape.y[-10:-6, -1])
