"""Rods that the tests of the elements share."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from beamopt.base.arrays import FloatArray
from beamopt.rod.elements.method import Elements
from beamopt.rod.law import SectionLaw
from beamopt.rod.rod import STRAIGHT, Base, LineLoad, PointLoad, Rod, Segment
from beamopt.rod.solution import RodSolution
from beamopt.rod.status import RodStatus

METHOD = Elements()
RIGID = np.zeros((3, 3))
PLANE = SectionLaw(np.eye(3), RIGID, RIGID, (0,))
BENDS = SectionLaw(np.eye(3), RIGID, RIGID)
SPACE = SectionLaw(np.diag([1.0, 1.3, 0.8]), np.diag([2e-3, 1e-3, 1e-3]), RIGID, (0, 1, 2))


def solved(rod: Rod, elements: int, method: Elements = METHOD) -> RodSolution:
    return method.solve(rod, rod.rest[None], elements)


def tip(rod: Rod, elements: int) -> FloatArray:
    solution = solved(rod, elements)
    assert solution.status == (RodStatus.CONVERGED,)
    return np.asarray(solution.tips[0])


def cantilever(load: float) -> Rod:
    """Length 1, EI = 1, dead load `load` sideways at its tip."""
    return Rod((Segment(1.0, BENDS, end=PointLoad(force=np.array([load, 0, 0]))),))


def general(conservative: bool) -> Rod:
    """Two segments with a kink, couplings, and every kind of load."""
    rng = np.random.default_rng(1)
    segments = []
    for length in (0.7, 0.4):
        root = rng.normal(size=(3, 3))
        bending = root @ root.T + np.eye(3)
        law = SectionLaw(bending, 0.05 * SPACE.bending, 0.1 * rng.normal(size=(3, 3)), (0, 1, 2))
        line = LineLoad(force=rng.normal(size=3), at=0.1 * rng.normal(size=3))
        end = PointLoad(force=rng.normal(size=3), at=0.1 * rng.normal(size=3))
        if not conservative:
            line = replace(line, follower_force=rng.normal(size=3))
            end = replace(
                end,
                moment=rng.normal(size=3),
                follower_force=rng.normal(size=3),
                follower_moment=rng.normal(size=3),
            )
        rest = STRAIGHT + 0.3 * rng.normal(size=6)
        kink = Rotation.from_rotvec(rng.normal(size=3)).as_matrix()
        segments.append(Segment(length, law, rest, kink, line, end))
    return Rod(tuple(segments), Base(rng.normal(size=3), Rotation.random(rng=rng).as_matrix()))
