"""Equilibria of a loaded rod in Legendre modes of its curvature."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from beamopt.arrays import FloatArray, IndexArray
from beamopt.rod.balance import unknown_count
from beamopt.rod.direct import read_case, solve_directly
from beamopt.rod.following import Follower
from beamopt.rod.newton import CLOSE, DIVERGED, FOUND, evaluate
from beamopt.rod.packed import pack, stations_of
from beamopt.rod.rod import Rod
from beamopt.rod.rotation import rotation_vector
from beamopt.rod.shape import empty_shape
from beamopt.rod.solution import RodSolution
from beamopt.rod.status import RodStatus

__all__ = ["StrainModes"]

COILED, MOST_COILED = 2.5, 200.0  # rad of a segment at rest: from where, and how far, points follow


@dataclass(frozen=True)
class StrainModes:
    """Galerkin's method in the curvature: u = u* + Σ q_b P_b(s), a minimum of the potential.

    Strain-based modes (Renda et al. 2020, Boyer et al. 2021), with the strain v eliminated: for
    given curvatures the forces follow from the loads, and v from the section's law in every point.
    So the unknowns are bending (and twist) alone, their tangent is the potential's second
    derivative, and it is positive where the equilibrium is stable.

    parents : (n, 3) cases a, b, c earlier in the row: a + b − c is where a case begins, −1 for
        "from rest"; None begins all from rest.
    all_or_none : after a case that fails the later ones that are not found directly are SKIPPED.
    direct : iterate at full load first, unless the tip is held, and follow the load only where that
        leads out of the well that it began in; False follows always.
    close : rad that the last step of the iteration at full load may turn a section by. What is left
        then is its square.
    """

    name: str = "modes"
    resolutions: Sequence[int] = (1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 24)
    parents: IndexArray | None = field(default=None, compare=False)
    all_or_none: bool = False
    direct: bool = True
    close: float = CLOSE

    def solve(self, rod: Rod, rest: FloatArray, resolution: int) -> RodSolution:
        """Solve for the rest strains (n, segments, 6) with `resolution` modes a segment."""
        cases = _Cases(rod, np.ascontiguousarray(rest, dtype=np.float64), resolution)
        return cases.solve(self)


class _Cases:
    """One rod in n cases, with `modes` a segment."""

    def __init__(self, rod: Rod, rest: FloatArray, modes: int) -> None:
        self.arrays, self.rest = pack(rod), rest
        lengths = np.array([one.length for one in rod.segments])
        coiled = float(np.max(np.linalg.norm(rest[:, :, :3], axis=-1) * lengths, initial=0.0))
        # R turns with the curvature: a point more for every radian or two of a coiled rest shape
        more = math.ceil(0.7 * max(coiled - COILED, 0.0)) if coiled < MOST_COILED else 0
        self.at = stations_of(tuple(lengths.tolist()), modes, more)
        self.conservative = rod.is_conservative
        segments = len(rod.segments)
        self.shape = empty_shape(len(self.at.at), segments, len(self.at.step))
        n = len(rest)
        self.starts, self.turns = np.zeros((n, 3)), np.zeros((n, 3))
        self.held = rod.tip.position is not None or rod.tip.rotation is not None
        if self.held:
            for case in range(n):
                self._find_unloaded_tip(case)

    def _find_unloaded_tip(self, case: int) -> None:
        rod, at, shape, rest = self.arrays, self.at, self.shape, self.rest[case]
        none, nowhere = np.zeros(unknown_count(rod, at)), np.zeros(3)
        evaluate(rod, at, rest, nowhere, nowhere, 0.0, none, shape, np.empty(none.size))
        self.starts[case] = shape.end_position[-1]
        if len(rod.held_rotation):
            self.turns[case] = rotation_vector(rod.held_rotation[0] @ shape.end_rotation[-1].T)

    def solve(self, how: StrainModes) -> RodSolution:
        """Directly where that is safe, else following the load."""
        rod, at, n = self.arrays, self.at, len(self.rest)
        ended, iterations = np.zeros(n, dtype=np.int64), np.zeros(n, dtype=np.int64)
        values, centrelines = np.full((n, 14), np.nan), np.full((n, len(at.at), 3), np.nan)
        unknowns = np.zeros((n, unknown_count(rod, at)))
        begin = np.full((n, 3), -1, dtype=np.int64) if how.parents is None else how.parents
        if how.direct and not self.held:  # shallow arches snap without turning much
            self._directly(how.close, begin, unknowns, ended, iterations, values, centrelines)
        else:
            ended[:] = DIVERGED
        status, factor = [RodStatus.CONVERGED] * n, np.ones(n)
        fails = False
        for case in np.flatnonzero(ended != FOUND).tolist():
            if fails:
                status[case] = RodStatus.SKIPPED
                continue
            status[case], factor[case], count = self._followed(
                case, unknowns[case], values[case], centrelines[case]
            )
            iterations[case] += count
            fails = how.all_or_none and status[case] is not RodStatus.CONVERGED
        for case in np.flatnonzero(~(values[:, 12] > 0.0)).tolist():
            if status[case] is RodStatus.CONVERGED:
                status[case] = RodStatus.CRUSHED
                values[case], centrelines[case] = np.nan, np.nan
        tips, rotations, error = values[:, :3], values[:, 3:12].reshape(n, 3, 3), values[:, 13]
        return RodSolution(
            tuple(status), tips, rotations, factor, error, iterations, at.at, centrelines
        )

    def _directly(
        self,
        close: float,
        begin: IndexArray,
        unknowns: FloatArray,
        ended: IndexArray,
        iterations: IndexArray,
        values: FloatArray,
        centrelines: FloatArray,
    ) -> None:
        solve_directly(
            self.arrays, self.at, self.rest, self.starts, self.turns, begin, self.conservative,
            False, close, unknowns, ended, iterations, values, centrelines, self.shape,
        )  # fmt: skip

    def _followed(
        self, case: int, unknowns: FloatArray, values: FloatArray, centreline: FloatArray
    ) -> tuple[RodStatus, float, int]:
        rest, shape = self.rest[case], self.shape
        one = (self.arrays, self.at, rest, self.starts[case], self.turns[case])
        status, factor, count = Follower(*one, self.conservative, shape).follow(unknowns)
        if status is RodStatus.CONVERGED:
            read_case(self.arrays, self.at, rest, unknowns, shape, values, centreline)
        return status, factor, count
