"""Equilibria to a tolerance: as many modes as that takes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from beamopt.arrays import FloatArray, IndexArray
from beamopt.rod.modes import StrainModes
from beamopt.rod.rod import Rod
from beamopt.rod.solution import RodSolution, merged
from beamopt.rod.status import RodStatus

__all__ = ["MODES", "solve_rod"]

MODES = (2, 4, 7, 12, 20)
"""Modes a segment, from coarse to fine."""

COARSE = 1e-3  # rad: the last step of the iteration at a tolerance of 0.1 % of the length

SAME_LOAD = 0.01  # a failure is believed when two resolutions end within this share of each other


def solve_rod(
    rod: Rod,
    rest: FloatArray,
    tolerance: float,
    parents: IndexArray | None = None,
    *,
    all_or_none: bool = False,
) -> RodSolution:
    """Equilibria for the rest strains (n, segments, 6) of n cases.

    Parameters
    ----------
    tolerance : of the tips' estimated error [mm].
    parents : (n, 3) see `StrainModes`.
    all_or_none : look no further where one case fails; the others then may be SKIPPED.

    Returns
    -------
    RodSolution : at the coarsest resolution that is fine enough for each case; UNRESOLVED where the
        finest is not. A failure counts once a finer resolution fails at the same share of the load.
    """
    close = min(COARSE, float(np.sqrt(COARSE**2 * tolerance / rod.length / 1e-3)))
    how = StrainModes(all_or_none=all_or_none, close=close)
    found = replace(how, parents=parents).solve(rod, rest, MODES[0])
    for modes in MODES[1:]:
        open_ = _unfinished(found, tolerance)
        if not open_.size:
            return found
        finer = how.solve(rod, rest[open_], modes)
        settled = _settled(found, finer, open_)
        found = merged(found, finer, open_)
        if settled:
            return found
    late = [k for k in _unfinished(found, tolerance) if found.status[k] is RodStatus.CONVERGED]
    return found.failed(late, RodStatus.UNRESOLVED)


def _unfinished(found: RodSolution, tolerance: float) -> IndexArray:
    return np.flatnonzero(~(found.converged & (found.error <= tolerance)))


def _settled(found: RodSolution, finer: RodSolution, at: IndexArray) -> bool:
    """Whether all that is open failed twice in the same way."""
    return all(
        finer.status[k] is not RodStatus.CONVERGED
        and found.status[case] is finer.status[k]
        and abs(found.factor[case] - finer.factor[k]) <= SAME_LOAD * finer.factor[k]
        for k, case in enumerate(at)
    )
