"""Rods and methods that the tests of the comparators share."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from beamopt.base.arrays import FloatArray
from beamopt.comparators.collocation import Collocation
from beamopt.comparators.multiple_shooting import MultipleShooting
from beamopt.comparators.shooting import Shooting
from beamopt.comparators.sweep import StepRule
from beamopt.rod.law import SectionLaw
from beamopt.rod.rod import Base, LineLoad, PointLoad, Rod, Segment
from beamopt.rod.solution import Method, RodSolution

RUNGE_KUTTA, MAGNUS = StepRule.RUNGE_KUTTA, StepRule.MUNTHE_KAAS
METHODS: list[tuple[Method, int]] = [
    (Shooting(RUNGE_KUTTA), 200),
    (Shooting(MAGNUS), 200),
    (MultipleShooting(RUNGE_KUTTA, intervals=10), 200),
    (MultipleShooting(MAGNUS, intervals=10), 200),
    (Collocation(), 8),
]
"""Methods with a resolution that gives a tip to about 1e-7 of the length."""
NAMES = [method.name for method, _ in METHODS]

X, Y, Z = np.eye(3)


def rigid_in_stretch(EI: float, GJ: float | None = None) -> SectionLaw:
    """A section that bends (and twists) but neither shears nor stretches."""
    free = (0, 1) if GJ is None else (0, 1, 2)
    return SectionLaw(np.diag([EI, EI, GJ or 0.0]), np.zeros((3, 3)), np.zeros((3, 3)), free)


def cantilever(
    length: float, law: SectionLaw, end: PointLoad | None = None, line: LineLoad | None = None
) -> Rod:
    segment = Segment(length, law, end=end or PointLoad(), line=line or LineLoad())
    return Rod((segment,))


def solve(method: Method, rod: Rod, resolution: int) -> RodSolution:
    return method.solve(rod, rod.rest[None], resolution)


def tangle() -> Rod:
    """Two segments with everything: coupling, twist, kinks, oblique weight, follower loads."""
    rng = np.random.default_rng(7)
    laws = []
    for scale in (1.0, 0.6):
        factor = rng.normal(size=(6, 6))
        matrix = np.eye(6) + 0.05 * (factor + factor.T)
        laws.append(
            SectionLaw(
                bending=scale * 3e4 * matrix[:3, :3],
                compliance=matrix[3:, 3:] / 400,
                coupling=rng.normal(size=(3, 3)),
                free=(0, 1, 2),
            )
        )
    rest = rng.normal(size=(2, 6)) * [0.01, 0.01, 0.005, 0.02, 0.02, 0.05] + [0, 0, 0, 0, 0, 1]
    kinks = Rotation.from_rotvec(rng.normal(size=(2, 3)) * 0.2).as_matrix()
    first = Segment(
        60.0,
        laws[0],
        rest[0],
        kinks[0],
        LineLoad(np.array([0.03, -0.05, -0.04]), np.array([0.02, 0.01, 0.0]), rng.normal(size=3)),
        PointLoad(
            rng.normal(size=3), 30 * rng.normal(size=3), rng.normal(size=3), at=rng.normal(size=3)
        ),
    )
    second = Segment(
        40.0,
        laws[1],
        rest[1],
        kinks[1],
        LineLoad(np.array([0.02, -0.03, -0.03]), at=rng.normal(size=3)),
        PointLoad(
            2 * rng.normal(size=3),
            50 * rng.normal(size=3),
            2 * rng.normal(size=3),
            50 * rng.normal(size=3),
            rng.normal(size=3),
        ),
    )
    base = Base(np.array([3.0, -2.0, 5.0]), Rotation.from_rotvec([0.3, 0.5, -0.2]).as_matrix())
    return Rod((first, second), base)


def turned(rod: Rod, Q: FloatArray, shift: FloatArray) -> Rod:
    """The same in another frame: positions Q x + shift, dead loads Q f."""
    segments = tuple(
        Segment(
            one.length,
            one.law,
            one.rest,
            one.kink,
            LineLoad(Q @ one.line.force, one.line.follower_force, one.line.at),
            PointLoad(
                Q @ one.end.force,
                Q @ one.end.moment,
                one.end.follower_force,
                one.end.follower_moment,
                one.end.at,
            ),
        )
        for one in rod.segments
    )
    return Rod(segments, Base(Q @ rod.base.position + shift, Q @ rod.base.rotation))
