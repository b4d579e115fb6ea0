"""Where growing loads lead a rod from rest: two methods that follow them have to agree."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.rod.elements.method import Elements
from beamopt.rod.modes import StrainModes
from beamopt.rod.rod import Rod
from beamopt.rod.solution import RodSolution
from beamopt.rod.status import RodStatus
from beamopt.rod_map.verdict import Truth, Witness, apart

__all__ = ["compared", "true_equilibrium"]

MODES, FINER_MODES = 20, 32
ELEMENTS = 128  # and twice as many where that is not enough
MOST_ITERATIONS = 10_000  # of the elements; four seconds with `ELEMENTS` of them
SAME = 0.005  # tips so little apart agree
SAME_LOAD = 0.1  # of each other: shares of the load up to which there is an equilibrium

NONE: FloatArray = np.full(3, np.nan)


def true_equilibrium(rod: Rod, rest: FloatArray) -> Truth:
    """Strain modes that follow the load against elements that do, in steps of half a radian.

    rest : (1, segments, 6). Where the two differ both are refined, and the elements extrapolated
    (second order). Where one then is in trouble of its own, and the other one agrees with itself,
    that one is believed alone. Without an equilibrium both have to say so, and one of them why.
    """
    follower, elements = StrainModes(direct=False), Elements(most_iterations=MOST_ITERATIONS)
    modes, coarse = follower.solve(rod, rest, MODES), elements.solve(rod, rest, ELEMENTS)
    first = compared(modes, coarse, rod.length)
    if first.known or RodStatus.CONVERGED not in (modes.status[0], coarse.status[0]):
        return first
    fine, refined = coarse, modes
    if coarse.converged[0]:
        fine = _extrapolated(coarse, elements.solve(rod, rest, 2 * ELEMENTS))
    if modes.converged[0]:
        refined = follower.solve(rod, rest, FINER_MODES)
    second = compared(refined, fine, rod.length)
    if second.known:
        return second
    for own, other, coarser, witness in (
        (fine, refined, coarse, Witness.ELEMENTS),
        (refined, fine, modes, Witness.MODES),
    ):
        ended = other.status[0]
        in_trouble = ended is not RodStatus.CONVERGED and not ended.is_physical
        gap = apart(own.tips[0], coarser.tips[0], rod.length)
        if in_trouble and gap <= SAME:
            return Truth(witness, own.status[0], own.tips[0], gap)
    return second


def compared(modes: RodSolution, elements: RodSolution, length: float) -> Truth:
    """The truth where two solutions of one case agree."""
    one, other = modes.status[0], elements.status[0]
    gap = apart(modes.tips[0], elements.tips[0], length)
    if RodStatus.CONVERGED in (one, other):
        return Truth(Witness.BOTH if gap <= SAME else Witness.NEITHER, one, modes.tips[0], gap)
    a, b = float(modes.factor[0]), float(elements.factor[0])
    same_load = abs(a - b) <= SAME_LOAD * max(a, b)
    status = one if one.is_physical else other
    known = status.is_physical and (same_load or one is other is RodStatus.CRUSHED)
    return Truth(Witness.BOTH if known else Witness.NEITHER, status, NONE, np.nan)


def _extrapolated(coarse: RodSolution, fine: RodSolution) -> RodSolution:
    """Tips of twice the elements without the error of second order."""
    return replace(fine, tips=fine.tips + (fine.tips - coarse.tips) / 3)
