"""A rod: segments of uniform section, one after the other, with loads and two ends."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.rod.law import SectionLaw

__all__ = ["STRAIGHT", "Base", "LineLoad", "PointLoad", "Rod", "Segment", "Tip"]

STRAIGHT: FloatArray = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
"""Rest strains (u1, u2, u3, v1, v2, v3) of a straight, unloaded rod."""


def _nothing() -> FloatArray:
    return np.zeros(3)


@dataclass(frozen=True, eq=False)
class PointLoad:
    """Force and moment at the end of a segment.

    force, moment : (3,) dead: their directions stay in space [mN], [mN·mm].
    follower_force, follower_moment : (3,) turn with the section they act on; given in its axes.
    at : (3,) where both forces act, in the section's axes from the rod's axis [mm].
    """

    force: FloatArray = field(default_factory=_nothing)
    moment: FloatArray = field(default_factory=_nothing)
    follower_force: FloatArray = field(default_factory=_nothing)
    follower_moment: FloatArray = field(default_factory=_nothing)
    at: FloatArray = field(default_factory=_nothing)


@dataclass(frozen=True, eq=False)
class LineLoad:
    """Force per undeformed length of a segment.

    force : (3,) dead [mN/mm]: a weight, for example.
    follower_force : (3,) turns with the section; in its axes [mN/mm].
    at : (3,) where both act, in the section's axes from the rod's axis [mm].
    """

    force: FloatArray = field(default_factory=_nothing)
    follower_force: FloatArray = field(default_factory=_nothing)
    at: FloatArray = field(default_factory=_nothing)


@dataclass(frozen=True, eq=False)
class Segment:
    """A piece of uniform section.

    length : undeformed [mm].
    law : of its section, about the rod's axis.
    rest : (6,) strains (u, v) without loads [1/mm, 1]; pressures move them.
    kink : (3, 3) rotation from the section before it (or the base) to this one's first.
    line : load along it. end : load at its end; that of the last segment is the tip's.
    """

    length: float
    law: SectionLaw
    rest: FloatArray = field(default_factory=STRAIGHT.copy)
    kink: FloatArray = field(default_factory=lambda: np.eye(3))
    line: LineLoad = field(default_factory=LineLoad)
    end: PointLoad = field(default_factory=PointLoad)


@dataclass(frozen=True, eq=False)
class Base:
    """Where the rod begins: position (3,) [mm] and rotation (3, 3), section axes to space.

    hinges : (k, 3) axis in space about which the base turns freely; k = 0 is a clamp.
    """

    position: FloatArray = field(default_factory=_nothing)
    rotation: FloatArray = field(default_factory=lambda: np.eye(3))
    hinges: FloatArray = field(default_factory=lambda: np.zeros((0, 3)))


@dataclass(frozen=True, eq=False)
class Tip:
    """What is prescribed at the tip: position (3,) [mm], rotation (3, 3); None leaves it free.

    A prescribed tip is led there from where the unloaded rod's tip is, as loads grow from 0 to 1.
    """

    position: FloatArray | None = None
    rotation: FloatArray | None = None


@dataclass(frozen=True, eq=False)
class Rod:
    """Segments from the base to the tip."""

    segments: tuple[Segment, ...]
    base: Base = field(default_factory=Base)
    tip: Tip = field(default_factory=Tip)

    def __post_init__(self) -> None:
        if not self.segments:
            raise ValueError("segments: at least one")
        if any(not 0 < segment.length < np.inf for segment in self.segments):
            raise ValueError("length of a segment: positive, in mm")
        if len({segment.law.free for segment in self.segments}) > 1:
            raise ValueError("free: the same curvatures in all segments")
        if self.base.hinges.shape not in ((0, 3), (1, 3)):
            raise ValueError("hinges: at most one axis, (k, 3)")

    @property
    def length(self) -> float:
        """Undeformed length [mm]."""
        return sum(segment.length for segment in self.segments)

    @property
    def free(self) -> tuple[int, ...]:
        """The curvatures that may differ from those at rest: 0 and 1 bend, 2 twists."""
        return self.segments[0].law.free

    @cached_property
    def rest(self) -> FloatArray:
        """(segments, 6) strains without loads."""
        return np.array([segment.rest for segment in self.segments])

    @cached_property
    def is_loaded(self) -> bool:
        """Whether anything but its rest strains moves it."""
        held = self.tip.position is not None or self.tip.rotation is not None
        return held or any(
            np.any(load)
            for one in self.segments
            for load in (
                *(one.line.force, one.line.follower_force, one.end.force, one.end.moment),
                *(one.end.follower_force, one.end.follower_moment),
            )
        )

    @cached_property
    def is_conservative(self) -> bool:
        """Whether all loads have a potential: dead forces, and moments where it bends in plane."""
        in_space = len(self.free) > 1
        return not any(
            np.any(one.line.follower_force)
            or np.any(one.end.follower_force)
            or (in_space and (np.any(one.end.moment) or np.any(one.end.follower_moment)))
            for one in self.segments
        )

    def scaled(self, factor: float) -> Rod:
        """The same rod with all loads times `factor`; a prescribed tip stays."""
        return replace(self, segments=tuple(_scaled(one, factor) for one in self.segments))


def _scaled(segment: Segment, factor: float) -> Segment:
    line, end = segment.line, segment.end
    line = replace(line, force=factor * line.force, follower_force=factor * line.follower_force)
    end = replace(
        end,
        force=factor * end.force,
        moment=factor * end.moment,
        follower_force=factor * end.follower_force,
        follower_moment=factor * end.follower_moment,
    )
    return replace(segment, line=line, end=end)
