"""The methods that are held against each other, each with the options that a person would take."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from beamopt.base.arrays import FloatArray, IndexArray
from beamopt.comparators.collocation import Collocation
from beamopt.comparators.multiple_shooting import MultipleShooting
from beamopt.comparators.shooting import Shooting
from beamopt.comparators.sweep import StepRule
from beamopt.rod.elements.method import Elements
from beamopt.rod.equilibrium import solve_rod
from beamopt.rod.modes import StrainModes
from beamopt.rod.rod import Rod
from beamopt.rod.solution import Method, RodSolution

__all__ = ["DEFAULT_RESOLUTIONS", "Adaptive", "all_methods", "limited"]

DEFAULT_RESOLUTIONS = {
    "adaptive": 3,
    "modes": 12,
    "elements": 32,
    "shooting": 64,
    "shooting-magnus": 64,
    "multiple-shooting": 64,
    "multiple-shooting-magnus": 64,
    "collocation": 5,
}
"""By name: what is sensible for a rod that nothing is known of."""


@dataclass(frozen=True)
class Adaptive:
    """The rod as the optimiser solves it: as fine as a tolerance takes (`solve_rod`).

    Resolution r asks for tips to 10⁻ʳ of the rod's length. parents : see `StrainModes`.
    """

    name: str = "adaptive"
    resolutions: Sequence[int] = (2, 3, 4, 5, 6, 7, 8, 9)
    parents: IndexArray | None = field(default=None, compare=False)

    def solve(self, rod: Rod, rest: FloatArray, resolution: int) -> RodSolution:
        """Solve for the rest strains (n, segments, 6) of n cases."""
        return solve_rod(rod, rest, 10.0**-resolution * rod.length, self.parents)


def all_methods(parents: IndexArray | None = None) -> tuple[Method, ...]:
    """All of them.

    parents : what the shipped ones make of the cases' order; the others begin each case at the one
        before, or at rest.
    """
    return (
        Adaptive(parents=parents),
        StrainModes(parents=parents),
        Elements(),
        Shooting(),
        Shooting(StepRule.MUNTHE_KAAS),
        MultipleShooting(),
        MultipleShooting(StepRule.MUNTHE_KAAS),
        Collocation(),
    )


def limited(method: Method, seconds: float) -> Method:
    """The same method, which gives a case up after a time, if it is one that can.

    seconds : of processor time.
    """
    if isinstance(method, Elements | Shooting | MultipleShooting | Collocation):
        return replace(method, seconds=seconds)
    return method
