"""Rods to test with."""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.rod.law import SectionLaw
from beamopt.rod.modes import StrainModes
from beamopt.rod.rod import STRAIGHT, Base, LineLoad, PointLoad, Rod, Segment, Tip
from beamopt.rod.solution import RodSolution

BEND, SPACE, PLANE = (0, 1), (0, 1, 2), (1,)
"""Free curvatures: it bends only, it twists as well, it bends about one axis only."""


def plain_law(
    bending: float = 1.0, twisting: float = 1.0, free: tuple[int, ...] = SPACE
) -> SectionLaw:
    """Neither shears nor stretches."""
    parts = np.diag([bending, bending, twisting])
    return SectionLaw(parts, np.zeros((3, 3)), np.zeros((3, 3)), free)


def definite(rng: np.random.Generator, size: int) -> FloatArray:
    """A random symmetric positive definite matrix, condition some 10."""
    a = rng.normal(size=(size, size))
    return np.asarray(a @ a.T + size * np.eye(size))


def rotation(rng: np.random.Generator) -> FloatArray:
    q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return np.asarray(q * np.sign(np.linalg.det(q)))


def turned(axis: int, angle: float) -> FloatArray:
    """The rotation about a coordinate axis."""
    c, s = np.cos(angle), np.sin(angle)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    R = np.eye(3)
    R[i, i], R[i, j], R[j, i], R[j, j] = c, -s, s, c
    return R


def random_law(rng: np.random.Generator, free: tuple[int, ...] = SPACE) -> SectionLaw:
    """Bending about 5, compliance about 0.1, coupling about 0.1."""
    coupling = 0.1 * rng.normal(size=(3, 3))
    return SectionLaw(definite(rng, 3), 0.02 * definite(rng, 3), coupling, free)


def random_rod(
    rng: np.random.Generator,
    *,
    free: tuple[int, ...] = SPACE,
    load: float = 1.0,
    follows: bool = True,
    moments: bool = True,
    hinge: bool = False,
    held: bool = False,
) -> Rod:
    """Two segments, 0.7 and 0.5 long, with kink, couplings, curved and loaded beside the axis."""

    def vector(size: float) -> FloatArray:
        return size * rng.normal(size=3)

    def segment(length: float, kink: FloatArray) -> Segment:
        law = random_law(rng, free)
        rest = STRAIGHT + np.array([*vector(0.3), *(0.1 * rng.normal(size=2)), 0.0])
        follow, turn = load * follows, load * moments
        line = LineLoad(vector(load), vector(follow), vector(0.1))
        end = PointLoad(
            vector(load), vector(turn), vector(follow), vector(turn * follows), vector(0.1)
        )
        return Segment(length, law, rest, kink, line, end)

    segments = (segment(0.7, np.eye(3)), segment(0.5, rotation(rng)))
    axis = vector(1.0)[None] / 2 if hinge else np.zeros((0, 3))
    tip = Tip(vector(1.0), rotation(rng)) if held else Tip()
    return Rod(segments, Base(vector(1.0), rotation(rng), axis), tip)


def solved(rod: Rod, modes: int = 12) -> RodSolution:
    """One case: as it is at rest."""
    return StrainModes().solve(rod, rod.rest[None], modes)
