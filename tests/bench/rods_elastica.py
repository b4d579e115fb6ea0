"""The loaded rod relaxed in PyElastica, only where `installed()`: damped dynamics until it rests.

The rod of reference is the one under pressure: elements have the length that pressure stretches
them to, and stiffnesses and `rest_kappa` refer to that. So PyElastica's dilatation, by which it
scales forces and moments like an incompressible solid's, stays within what the loads stretch, and
its equations are ours but for a share of that order. It has no coupling of twist and transverse
force: both sides are measured on a rod whose shear centre is its centroid.

Chosen for it, in good faith: it starts at rest under pressure instead of straight; masses are the
actuator's; the time step is 0.97 of an axial wave's through an element (1.03 is unstable) and
damping 0.65 of critical for the slowest motion of the straight rod, the best of 0.5, 0.65, 0.8, 1;
it stops at the step from which on its tip stays as near as is asked, which no user would know; what
building its rods takes is not counted. Its clamp, `OneEndFixedBC`, holds the first node and the
directors in the middle of the first element; `Clamp` says what that element then is.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from importlib import import_module
from importlib.util import find_spec
from time import perf_counter
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from beamopt.base.arrays import FloatArray
from beamopt.rod.rod import Rod

__all__ = ["Clamp", "Relaxation", "fewest_elements", "installed"]

CANTILEVER = 3.516
"""ω L² √(ρA/EI) of the slowest motion of a straight cantilever."""
HORIZON = 14.0  # of 1/ω: what a rod may take to come to rest


class Clamp(Enum):
    """What the first element is; the value is for people."""

    MANUAL = "clamped as in its manual"
    """It begins at the base; half of it stays straight, so that the error is of first order."""
    CENTRED = "clamp mended"
    """It begins half its length before the base, of twice the shear stiffness: of second order."""


def installed() -> bool:
    return find_spec("elastica") is not None


@dataclass(frozen=True, eq=False)
class Relaxation:
    """Cases of one rod in one simulator.

    rod : of one segment about its centroid, without coupling, under nothing but a dead line load.
    rest : (n, 6) strains without loads. density : per undeformed length [kg/mm].
    elements : of each rod. step : share of the time that an axial wave takes through an element.
    damping : over critical.
    """

    rod: Rod
    rest: FloatArray
    density: float
    elements: int
    clamp: Clamp = Clamp.CENTRED
    step: float = 0.97
    damping: float = 0.65

    @property
    def element(self) -> float:
        """Undeformed length of an element [mm]."""
        hidden = 0.5 if self.clamp is Clamp.CENTRED else 0.0
        return self.rod.length / (self.elements - hidden)

    @property
    def frequency(self) -> float:
        """Of the slowest motion of the straight rod [rad/s]."""
        softest = np.linalg.eigvalsh(self.rod.segments[0].law.bending[:2, :2])[0]
        return float(CANTILEVER * np.sqrt(softest / self.density) / self.rod.length**2)

    @property
    def time_step(self) -> float:
        """[s]."""
        flexibility = self.rod.segments[0].law.compliance[2, 2]
        return float(self.step * self.element * np.sqrt(self.density * flexibility))

    def started(self) -> tuple[Any, list[Any]]:
        """A simulator ready to be stepped, and its rods."""
        elastica = _elastica()
        parts = "BaseSystemCollection", "Constraints", "Forcing", "Damping"
        simulator = type("Simulator", tuple(getattr(elastica, name) for name in parts), {})()
        rods = [self._rod_of(rest) for rest in self.rest]
        down = self.rod.segments[0].line.force / self.density
        for one in rods:
            simulator.append(one)
            simulator.constrain(one).using(
                elastica.OneEndFixedBC, constrained_position_idx=(0,), constrained_director_idx=(0,)
            )
            simulator.add_forcing_to(one).using(elastica.GravityForces, acc_gravity=down)
            simulator.dampen(one).using(
                elastica.AnalyticalLinearDamper,
                uniform_damping_constant=2 * self.damping * self.frequency,
                time_step=self.time_step,
            )
        simulator.finalize()
        return simulator, rods

    def steps_to(self, tips: FloatArray, near: float) -> int | None:
        """Steps from which on no tip is farther than `near` from its own of `tips` (n, 3) [mm].

        None if they do not come to rest there.
        """
        simulator, rods = self.started()
        last_far = steps = 0
        for steps in self._stepped(simulator, int(HORIZON / self.frequency / self.time_step)):
            apart = np.linalg.norm(_tips_of(rods) - tips, axis=1)
            if not (apart <= near).all():
                last_far = steps
        return last_far + 1 if last_far < steps else None

    def timed(self, steps: int, repeats: int = 3) -> tuple[float, FloatArray]:
        """The fastest of several relaxations [s], and its tips (n, 3) [mm]."""
        times = []
        for _ in range(repeats):
            simulator, rods = self.started()
            began = perf_counter()
            for _ in self._stepped(simulator, steps):
                pass
            times.append(perf_counter() - began)
        return min(times), _tips_of(rods)

    def _stepped(self, simulator: Any, steps: int) -> Iterator[int]:
        stepper, time = _elastica().PositionVerlet(), np.float64(0.0)
        step = np.float64(self.time_step)
        for k in range(steps):
            time = stepper.step(simulator, time, step)
            yield k + 1

    def _rod_of(self, rest: FloatArray) -> Any:
        """One case at rest under pressure, with our stiffnesses and masses."""
        law, stretch, n = self.rod.segments[0].law, float(rest[5]), self.elements
        directors, position = self._at_rest(rest)
        radius = np.sqrt(1 / np.pi)
        one = _elastica().CosseratRod.straight_rod(
            n, position[:, 0], directors[2, :, 0], directors[0, :, 0], stretch * self.rod.length,
            radius, 1.0, youngs_modulus=1.0, position=position, directors=directors,
            rest_kappa=np.tile(rest[:3, None] / stretch, n - 1),
        )  # fmt: skip
        shear = np.linalg.inv(law.compliance) * stretch
        one.shear_matrix[:] = shear[:, :, None]
        if self.clamp is Clamp.CENTRED:
            one.shear_matrix[:, :, 0] *= 2  # of this element, half is the rod's
        one.bend_matrix[:] = law.bending[:, :, None] * stretch
        one.mass[:] = self.density * self.element
        one.mass[[0, -1]] /= 2
        inertia = np.zeros((3, 3))  # density · I / A
        inertia[:2, :2] = self.density * law.compliance[2, 2] * law.bending[:2, :2]
        inertia[2, 2] = np.trace(inertia)
        inertia *= self.element
        one.mass_second_moment_of_inertia[:] = inertia[:, :, None]
        one.inv_mass_second_moment_of_inertia[:] = np.linalg.inv(inertia)[:, :, None]
        return one

    def _at_rest(self, rest: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Directors (3, 3, n) as rows, and nodes (3, n + 1) [mm]."""
        turn = np.arange(self.elements)[:, None] * rest[:3] * self.element
        directors = Rotation.from_rotvec(turn).as_matrix()  # columns
        edges = directors[:, :, 2] * rest[5] * self.element
        position = np.concatenate([np.zeros((1, 3)), np.cumsum(edges, axis=0)])
        if self.clamp is Clamp.CENTRED:
            position -= edges[0] / 2
        return np.ascontiguousarray(directors.transpose(2, 1, 0)), position.T.copy()


def _elastica() -> Any:
    """The package without its types, which do not name what it exports."""
    return import_module("elastica")


def _tips_of(rods: list[Any]) -> FloatArray:
    return np.array([one.position_collection[:, -1] for one in rods])


def fewest_elements(
    cases: Sequence[tuple[Relaxation, FloatArray]], counts: Sequence[int], near: float
) -> tuple[int, list[int]]:
    """The first of `counts` with which all cases come to rest near their tips; steps of each.

    Raises
    ------
    RuntimeError : none does.
    """
    for count in counts:
        steps: list[int] = []
        for one, tips in cases:
            needed = replace(one, elements=count).steps_to(tips, near)
            if needed is None:
                break
            steps.append(needed)
        if len(steps) == len(cases):
            return count, steps
    raise RuntimeError(f"PyElastica is not near enough with up to {counts[-1]} elements")
