"""Equilibria of a loaded rod in Legendre modes of its curvature."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from beamopt.rod.balance import unknown_count
from beamopt.rod.direct import read_case, solve_directly
from beamopt.rod.following import Follower
from beamopt.rod.newton import CLOSE, DIVERGED, FOUND, evaluate, newton
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
    """One rod in n cases, with `modes` a segment, and what is found of each."""

    def __init__(self, rod: Rod, rest: FloatArray, modes: int) -> None:
        self.arrays, self.rest = pack(rod), rest
        lengths = np.array([one.length for one in rod.segments])
        coiled = float(np.max(np.linalg.norm(rest[:, :, :3], axis=-1) * lengths, initial=0.0))
        # R turns with the curvature: a point more for every radian or two of a coiled rest shape
        more = math.ceil(0.7 * max(coiled - COILED, 0.0)) if coiled < MOST_COILED else 0
        self.at = stations_of(tuple(lengths.tolist()), modes, more)
        self.conservative = rod.is_conservative
        n, points = len(rest), len(self.at.at)
        self.shape = empty_shape(points, len(rod.segments), len(self.at.step))
        self.starts, self.turns = np.zeros((n, 3)), np.zeros((n, 3))
        self.unknowns = np.zeros((n, unknown_count(self.arrays, self.at)))
        self.ended = np.full(n, DIVERGED, dtype=np.int64)
        self.iterations, self.factor = np.zeros(n, dtype=np.int64), np.ones(n)
        self.status = [RodStatus.CONVERGED] * n
        self.values, self.centrelines = np.full((n, 14), np.nan), np.full((n, points, 3), np.nan)
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
        n = len(self.rest)
        begin = np.full((n, 3), -1, dtype=np.int64) if how.parents is None else how.parents
        direct = how.direct and not self.held  # shallow arches snap without turning much
        if direct:
            solve_directly(
                self.arrays, self.at, self.rest, self.starts, self.turns, begin,
                self.conservative, how.close, self.unknowns, self.ended, self.iterations,
                self.values, self.centrelines, self.shape,
            )  # fmt: skip
        fails = False
        for case in np.flatnonzero(self.ended != FOUND).tolist():
            if fails:
                self.status[case] = RodStatus.SKIPPED
                continue
            if not (direct and self._beside(case, begin[case], how.close)):
                self._follow(case)
            fails = how.all_or_none and self.status[case] is not RodStatus.CONVERGED
        return RodSolution(
            tuple(self.status),
            self.values[:, :3],
            self.values[:, 3:12].reshape(n, 3, 3),
            self.factor,
            self.values[:, 13],
            self.iterations,
            self.at.at,
            self.centrelines,
        )

    def _beside(self, case: int, parents: IndexArray, close: float) -> bool:
        """Iterate from parents that had to be followed; whether that arrives."""
        a, b, c = parents.tolist()
        if a < 0 or self.ended[a] != FOUND:
            return False
        unknowns = self.unknowns[case]
        unknowns[:] = self.unknowns[a]
        if b >= 0 and c >= 0 and self.ended[b] == FOUND and self.ended[c] == FOUND:
            unknowns += self.unknowns[b] - self.unknowns[c]
        one = (self.arrays, self.at, self.rest[case], self.starts[case], self.turns[case])
        ended, count = newton(*one, self.conservative, True, close, 1.0, unknowns, self.shape)
        self.iterations[case] += count
        if ended == FOUND:
            self._read(case)
        return bool(ended == FOUND)

    def _follow(self, case: int) -> None:
        """Let the load grow from nothing."""
        one = (self.arrays, self.at, self.rest[case], self.starts[case], self.turns[case])
        follower = Follower(*one, self.conservative, self.shape)
        found = follower.follow(self.unknowns[case])
        self.status[case], self.factor[case] = found[:2]
        self.iterations[case] += found[2]
        if self.status[case] is RodStatus.CONVERGED:
            self._read(case)

    def _read(self, case: int) -> None:
        """Keep the shape as it stands."""
        self.ended[case] = FOUND
        rest, unknowns = self.rest[case], self.unknowns[case]
        out = self.values[case], self.centrelines[case]
        read_case(self.arrays, self.at, rest, unknowns, self.shape, *out)
