"""Loaded workspaces of 27 tips to measure methods on, and how they are timed."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.comparators.workload import Workload, workload_of
from beamopt.rod.equilibrium import solve_rod
from beamopt.rod.modes import StrainModes
from beamopt.rod.pressure_tree import parents_on_grid
from beamopt.rod.rod import Rod
from beamopt.scene.scene import load_scene

__all__ = ["SCENES", "SHARE", "Workspace", "as_shipped", "fastest", "workspace"]

SCENES = ("gravity", "tool-at-the-tip")
SHARE = 1e-3
"""Error of a tip that is asked for, over the length."""
FINEST = 24  # modes
TURN = 0.01  # s


@dataclass(frozen=True, eq=False)
class Workspace:
    """name : of the scene. density : of its actuator, per undeformed length [kg/mm]."""

    name: str
    rod: Rod
    rest: FloatArray
    density: float

    @cached_property
    def truth(self) -> FloatArray:
        """(27, 3) tips with many modes [mm]."""
        found = StrainModes(parents=parents_on_grid()).solve(self.rod, self.rest, FINEST)
        if not found.converged.all():
            raise RuntimeError(f"{self.name}: a case has no equilibrium")
        return found.tips

    def error_of(self, tips: FloatArray) -> float:
        """Largest distance of the tips from the truth over the length; infinite without a tip."""
        far = np.linalg.norm(tips - self.truth, axis=1).max() / self.rod.length
        return float(far) if np.isfinite(far) else np.inf

    def without_coupling(self) -> Workspace:
        """The same, but its transverse forces act in the shear centre."""
        (segment,) = self.rod.segments
        law = replace(segment.law, coupling=np.zeros((3, 3)))
        return replace(self, rod=replace(self.rod, segments=(replace(segment, law=law),)))


def workspace(name: str) -> Workspace:
    """That of a scene's target section."""
    scene = load_scene(name)
    load: Workload = workload_of(scene)
    area = float(load.section.moments.area)  # mm²
    return Workspace(name, load.rod, load.rest, scene.loads.density * 1e-9 * area)


def as_shipped(rod: Rod, rest: FloatArray) -> FloatArray:
    """(27, 3) tips to 0.1 % of the length, the way that a search has them solved [mm]."""
    return solve_rod(rod, rest, SHARE * rod.length, parents_on_grid()).tips


def fastest(actions: Sequence[Callable[[], object]], rounds: int) -> list[float]:
    """The fastest of several calls of each [s], in turn, after a turn that is not counted.

    In its turn a short one is called until TURN is over: what ran before it slows its first call.
    """
    times = np.full((rounds + 1, len(actions)), np.inf)
    for k in range(rounds + 1):
        for j, action in enumerate(actions):
            began = ended = time.perf_counter()
            while ended - began < TURN:
                started = time.perf_counter()
                action()
                ended = time.perf_counter()
                times[k, j] = min(times[k, j], ended - started)
    return [float(one) for one in times[1:].min(axis=0)]
