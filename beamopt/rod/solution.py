"""What a method finds out about a rod, and the face that all methods have."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from beamopt.base.arrays import FloatArray, IndexArray
from beamopt.rod.rod import Rod
from beamopt.rod.status import RodStatus

__all__ = ["Method", "RodSolution", "merged"]


@dataclass(frozen=True, eq=False)
class RodSolution:
    """Equilibria of one rod in n cases (pressures: rest strains).

    status : n of them; the other values of a case mean something only where it converged, and are
        NaN elsewhere, `factor` excepted.
    tips : (n, 3) position of the axis at the tip [mm].
    rotations : (n, 3, 3) of the section at the tip.
    factor : (n,) share of the loads up to which a stable equilibrium was found (1 if converged).
    error : (n,) the method's own estimate of the tips' error [mm]; NaN where it has none.
    iterations : (n,) Newton iterations, or evaluations for methods that count those.
    stations : (m,) undeformed arc lengths [mm]. centrelines : (n, m, 3) the axis there [mm].
    """

    status: tuple[RodStatus, ...]
    tips: FloatArray
    rotations: FloatArray
    factor: FloatArray
    error: FloatArray
    iterations: NDArray[np.int64]
    stations: FloatArray
    centrelines: FloatArray

    @classmethod
    def unsolved(cls, n: int, status: RodStatus, length: float) -> RodSolution:
        """The answer where none of n cases of a rod of that length [mm] is solved."""
        return cls(
            status=(status,) * n,
            tips=np.full((n, 3), np.nan),
            rotations=np.full((n, 3, 3), np.nan),
            factor=np.zeros(n),
            error=np.full(n, np.nan),
            iterations=np.zeros(n, dtype=np.int64),
            stations=np.array([0.0, length]),
            centrelines=np.full((n, 2, 3), np.nan),
        )

    @property
    def converged(self) -> NDArray[np.bool_]:
        """(n,) where there is a tip."""
        return np.array([one is RodStatus.CONVERGED for one in self.status], dtype=bool)

    def failed(self, cases: Sequence[int], status: RodStatus) -> RodSolution:
        """The same, but for these cases, which have no tip."""
        statuses = tuple(status if k in cases else one for k, one in enumerate(self.status))
        tips, rotations = self.tips.copy(), self.rotations.copy()
        centrelines = self.centrelines.copy()
        for values in (tips, rotations, centrelines):
            values[list(cases)] = np.nan
        return replace(
            self, status=statuses, tips=tips, rotations=rotations, centrelines=centrelines
        )


def merged(coarse: RodSolution, fine: RodSolution, cases: IndexArray) -> RodSolution:
    """`coarse`, with `fine` in the place of some cases; centrelines on the stations of `coarse`.

    The iterations of both count.
    """
    status = list(coarse.status)
    for k, case in enumerate(cases):
        status[case] = fine.status[k]
    names = ("tips", "rotations", "factor", "error", "iterations", "centrelines")
    arrays = {name: getattr(coarse, name).copy() for name in names}
    for name in ("tips", "rotations", "factor", "error"):
        arrays[name][cases] = getattr(fine, name)
    arrays["iterations"][cases] += fine.iterations
    for k, case in enumerate(cases):
        for axis in range(3):
            along = fine.centrelines[k, :, axis]
            arrays["centrelines"][case, :, axis] = np.interp(coarse.stations, fine.stations, along)
    return replace(coarse, status=tuple(status), **arrays)


class Method(Protocol):
    """A way to solve rods."""

    @property
    def name(self) -> str:
        """One word for tables and figures."""
        ...

    @property
    def resolutions(self) -> Sequence[int]:
        """From coarse to fine: elements, steps, intervals or modes."""
        ...

    def solve(self, rod: Rod, rest: FloatArray, resolution: int) -> RodSolution:
        """Solve for the rest strains (n, segments, 6) of n cases."""
        ...
