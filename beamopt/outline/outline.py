"""An outline: the polygons of material and chambers, what they measure, what is wrong with them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.outline.faults import Fault, Severity
from beamopt.outline.green import loop_integrals
from beamopt.section.feature_points import MATERIAL, SUPPLIES
from beamopt.section.moments import Moments

__all__ = ["Chamber", "Loop", "Outline", "Piece", "Views"]


@dataclass(frozen=True, eq=False)
class Loop:
    """A closed line of straight edges with material on its left.

    points : (n, 2) vertices [mm], the first one not repeated; counter-clockwise around a piece of
        material, clockwise around a hole in it.
    supply : 0 a free surface (outer, inner, a sector's ends), 1…3 the wall of a chamber.
    """

    points: FloatArray
    supply: int

    def __post_init__(self) -> None:
        self.points.setflags(write=False)

    def scaled(self, by: float) -> Loop:
        """The same line, `by` times as large."""
        return Loop(by * self.points, self.supply)


@dataclass(frozen=True, eq=False)
class Piece:
    """One connected piece of material."""

    exterior: Loop
    holes: tuple[Loop, ...]

    @property
    def loops(self) -> tuple[Loop, ...]:
        """The exterior, then the holes."""
        return (self.exterior, *self.holes)

    @cached_property
    def area(self) -> float:
        """Area of material [mm²]."""
        return float(sum(loop_integrals(loop.points)[0] for loop in self.loops))

    @property
    def is_island(self) -> bool:
        """Whether it touches no surface: it hangs in a chamber."""
        return all(loop.supply != MATERIAL for loop in self.loops)

    def scaled(self, by: float) -> Piece:
        """The same piece, `by` times as large."""
        return Piece(self.exterior.scaled(by), tuple(hole.scaled(by) for hole in self.holes))


@dataclass(frozen=True, eq=False)
class Chamber:
    """One connected chamber; its loops are those of its walls, run through the other way round.

    supply : 1…3.
    exterior : (n, 2) vertices, counter-clockwise [mm].
    holes : (n, 2) vertices each, clockwise, around material (and what that encloses) [mm].
    """

    supply: int
    exterior: FloatArray
    holes: tuple[FloatArray, ...]

    def __post_init__(self) -> None:
        for loop in (self.exterior, *self.holes):
            loop.setflags(write=False)

    @cached_property
    def integrals(self) -> FloatArray:
        """(6,) of {1, x, y, x², y², xy} over the chamber, about the axis [mm², mm³, mm⁴]."""
        loops = (self.exterior, *self.holes)
        return np.asarray(sum(loop_integrals(loop) for loop in loops))

    @property
    def area(self) -> float:
        """Area [mm²]."""
        return float(self.integrals[0])

    def scaled(self, by: float) -> Chamber:
        """The same chamber, `by` times as large."""
        return Chamber(self.supply, by * self.exterior, tuple(by * hole for hole in self.holes))


class Views(NamedTuple):
    """Moments of one section as it is seen from coarse to fine."""

    raster: Moments
    smooth: Moments
    outline: Moments


@dataclass(frozen=True, eq=False)
class Outline:
    """A section as simple polygons that share no area.

    pieces : connected pieces of material, the largest first.
    chambers : supply by supply, the largest first.
    faults : what is wrong, the worst first; empty when nothing is. Where a chamber is open
        (`FaultKind.UNSEALED`) the polygons are the fine ones, not resampled, and a loop may run
        along a surface and a chamber; it then counts as a surface.
    smooth_moments : of the smooth section before it was resampled.
    outer_radius : of the ring, disc or sector that the section is cut from [mm].
    """

    pieces: tuple[Piece, ...]
    chambers: tuple[Chamber, ...]
    faults: tuple[Fault, ...]
    smooth_moments: Moments
    outer_radius: float

    @property
    def buildable(self) -> bool:
        """Whether a solid can be made of it: nothing fatal, thin walls or not."""
        return self.worst is not Severity.FATAL

    @property
    def keeps_rules(self) -> bool:
        """Whether it can be built and every skin, wall and neck is as thick as asked."""
        return self.worst in (None, Severity.NOTICE)

    @property
    def worst(self) -> Severity | None:
        """The gravest fault's severity, or None without any."""
        found = {fault.severity for fault in self.faults}
        return next((severity for severity in reversed(Severity) if severity in found), None)

    @property
    def islands(self) -> tuple[Piece, ...]:
        """Pieces of material that hang in a chamber."""
        return tuple(piece for piece in self.pieces if piece.is_island)

    def chambers_of(self, supply: int) -> tuple[Chamber, ...]:
        """The chambers of one supply, the largest first."""
        return tuple(chamber for chamber in self.chambers if chamber.supply == supply)

    @property
    def edges(self) -> int:
        """Edges of all loops of material."""
        return sum(len(loop.points) for piece in self.pieces for loop in piece.loops)

    @cached_property
    def moments(self) -> Moments:
        """Moments of exactly these polygons, about the grid's axis."""
        raw = np.zeros((1 + len(SUPPLIES), 6))
        for piece in self.pieces:
            for loop in piece.loops:
                raw[MATERIAL] += loop_integrals(loop.points)
        for chamber in self.chambers:
            raw[chamber.supply] += chamber.integrals
        return Moments(raw)

    def scaled(self, by: float) -> Outline:
        """The outline of a section that is `by` times as large."""
        if by == 1:
            return self
        return Outline(
            tuple(piece.scaled(by) for piece in self.pieces),
            tuple(chamber.scaled(by) for chamber in self.chambers),
            tuple(fault.scaled(by) for fault in self.faults),
            Moments(self.smooth_moments.raw * by ** np.array([2, 3, 3, 4, 4, 4])),
            by * self.outer_radius,
        )

    def views(self, raster: Moments) -> Views:
        """The section's moments in the search's raster, smooth, and as these polygons."""
        return Views(raster, self.smooth_moments, self.moments)
