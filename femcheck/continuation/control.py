"""What is held while Newton's method iterates: the pressures, or a mix of pressure and volume."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from beamopt.base.arrays import FloatArray
from femcheck.continuation.direct import DirectSolver
from femcheck.solid.equilibrium import Equilibrium, Forces
from femcheck.solid.state import State

__all__ = ["ArcControl", "Control", "FixedLoad", "Mix"]


class Control(Protocol):
    """Gives the step of an iteration, and the pressures that belong to it."""

    @property
    def pressures(self) -> FloatArray:
        """(3,) present pressures [kPa]."""
        ...

    @property
    def is_fixed(self) -> bool:
        """Whether they stay."""
        ...

    def step(
        self, problem: Equilibrium, state: State, forces: Forces, solver: DirectSolver
    ) -> FloatArray:
        """(unknowns,) step to the linearised equilibrium; the tangent is factored in `solver`."""
        ...

    def advance(self, share: float) -> None:
        """Take so much of the change of pressures that belongs to the last step."""
        ...


class FixedLoad:
    """Pressures that stay as they are."""

    is_fixed = True

    def __init__(self, pressures: FloatArray) -> None:
        self.pressures = pressures

    def step(
        self, problem: Equilibrium, state: State, forces: Forces, solver: DirectSolver
    ) -> FloatArray:
        """The plain Newton step."""
        return solver.solve(-forces.reduced)

    def advance(self, share: float) -> None:
        """Nothing changes."""


class Mix(NamedTuple):
    """by_volume · v + by_load · P, where v = direction · V is what works with P [1/mm³; 1/kPa]."""

    by_volume: float
    by_load: float


class ArcControl:
    """Pressures P · direction with P unknown; held is a mix of P and the volume it works on.

    With nothing of the volume in the mix that is load control, with nothing of P volume control;
    between the two, along the tangent of the path, it passes limit points.

    Parameters
    ----------
    direction : (3,) load.
    load : P to begin with [kPa].
    mix, target : what is held, and at which value.
    """

    is_fixed = False

    def __init__(self, direction: FloatArray, load: float, mix: Mix, target: float) -> None:
        self._direction = direction
        self.load = load
        self._mix = mix
        self._target = target
        self._change = 0.0

    @property
    def pressures(self) -> FloatArray:
        """(3,) present pressures [kPa]."""
        return self.load * self._direction

    def step(
        self, problem: Equilibrium, state: State, forces: Forces, solver: DirectSolver
    ) -> FloatArray:
        """The step at constant load, and as much of the change with the load as holds the mix."""
        gradient = problem.volume_gradient(state, self._direction)
        volume = float(self._direction @ problem.volumes(state))
        by_volume, by_load = self._mix
        constant, by_unit = solver.solve(-forces.reduced), solver.solve(gradient)
        missing = self._target - by_volume * volume - by_load * self.load
        rate = by_volume * float(gradient @ by_unit) + by_load
        self._change = (missing - by_volume * float(gradient @ constant)) / rate
        return np.asarray(constant + self._change * by_unit)

    def advance(self, share: float) -> None:
        """Take so much of the change of P that belongs to the last step."""
        self.load += share * self._change
