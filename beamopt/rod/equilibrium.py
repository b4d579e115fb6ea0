"""Equilibria to a tolerance: as fine as that takes, by the method that can."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from beamopt.rod.elements.method import Elements
from beamopt.rod.modes import StrainModes
from beamopt.rod.rod import Rod
from beamopt.rod.solution import RodSolution, merged
from beamopt.rod.status import RodStatus

__all__ = ["ELEMENTS", "MODES", "MethodName", "solve_rod"]

MODES = (2, 4, 7, 12, 20)
"""Modes a segment, from coarse to fine."""

ELEMENTS = (16, 64, 256)
"""Elements in all, from coarse to fine."""

MethodName = Literal["modes", "elements"]
"""Modes first, and elements for what they leave open; or elements alone."""

COARSE = 1e-3  # rad: the last step of the iteration at a tolerance of 0.1 % of the length
SAME_LOAD = 0.01  # a failure is believed when two resolutions end within this share of each other
SAME_STEP = 1e-3  # and this share of the load, some of the smallest steps

Level = Callable[[FloatArray], RodSolution]


def solve_rod(
    rod: Rod,
    rest: FloatArray,
    tolerance: float,
    parents: IndexArray | None = None,
    *,
    all_or_none: bool = False,
    method: MethodName = "modes",
) -> RodSolution:
    """Equilibria for the rest strains (n, segments, 6) of n cases.

    Parameters
    ----------
    tolerance : of the tips' estimated error [mm].
    parents : (n, 3) see `StrainModes`.
    all_or_none : look no further where one case fails, nor by elements; the others then may be
        SKIPPED.
    method : see `MethodName`.

    Returns
    -------
    RodSolution : at the coarsest resolution that is fine enough for each case; UNRESOLVED where the
        finest is not. A failure counts once a finer resolution fails at the same share of the load.
    """
    elements = Elements(estimates=True)
    by_elements = [_level(elements, rod, count * len(rod.segments)) for count in ELEMENTS]
    if method == "elements":
        found, open_ = _refined(by_elements, rest, tolerance, all_or_none)
    else:
        close = min(COARSE, COARSE * float(np.sqrt(tolerance / (1e-3 * rod.length))))
        modes = StrainModes(all_or_none=all_or_none, close=close)
        first = _level(replace(modes, parents=parents), rod, MODES[0])
        by_modes = [first, *(_level(modes, rod, count) for count in MODES[1:])]
        found, open_ = _refined(by_modes, rest, tolerance, all_or_none)
        if open_.size and not all_or_none:
            other, left = _refined(by_elements[1:], rest[open_], tolerance, all_or_none)
            found, open_ = merged(found, other, open_), open_[left]
    late = [k for k in open_.tolist() if found.status[k] is RodStatus.CONVERGED]
    return found.failed(late, RodStatus.UNRESOLVED) if late else found


def _level(method: StrainModes | Elements, rod: Rod, resolution: int) -> Level:
    return lambda rest: method.solve(rod, rest, resolution)


def _refined(
    levels: Sequence[Level], rest: FloatArray, tolerance: float, all_or_none: bool
) -> tuple[RodSolution, IndexArray]:
    """The cases as fine as each needs, and those that the finest level leaves open."""
    found = levels[0](rest)
    open_ = np.flatnonzero(~(found.converged & (found.error <= tolerance)))
    for level in levels[1:]:
        if not open_.size:
            break
        finer = level(rest[open_])
        good = np.array([_is_good(finer, k, tolerance) for k in range(len(open_))])
        fails = np.array(
            [_is_same_failure(found, case, finer, k) for k, case in enumerate(open_.tolist())]
        )
        found, open_ = merged(found, finer, open_), open_[~(good | fails)]
        if all_or_none and fails.any():
            return found, open_[:0]
    return found, open_


def _is_good(found: RodSolution, k: int, tolerance: float) -> bool:
    return found.status[k] is RodStatus.CONVERGED and bool(found.error[k] <= tolerance)


def _is_same_failure(coarse: RodSolution, case: int, fine: RodSolution, k: int) -> bool:
    status = fine.status[k]
    if status in (RodStatus.CONVERGED, RodStatus.SKIPPED) or coarse.status[case] is not status:
        return False
    apart = abs(coarse.factor[case] - fine.factor[k])
    return bool(apart <= SAME_LOAD * fine.factor[k] + SAME_STEP)
