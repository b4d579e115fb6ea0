"""The ladder: an actuator's rod, and the lowest of three ways to solve it that is exact."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from enum import Enum
from functools import cached_property

import numpy as np

from beamopt.base.arrays import FloatArray, IndexArray
from beamopt.rod.arc import arc_centreline, arc_tip_directions, arc_tips
from beamopt.rod.chain import chain_centrelines, chain_tips
from beamopt.rod.equilibrium import MethodName, solve_rod
from beamopt.rod.law import cross, poissons_ratio, section_law
from beamopt.rod.modes import StrainModes
from beamopt.rod.response import Response
from beamopt.rod.rod import LineLoad, PointLoad, Rod, Segment
from beamopt.rod.status import RodStatus
from beamopt.section.moments import Moments
from beamopt.section.saint_venant import SaintVenant

__all__ = ["Loads", "RodModel", "RodPiece", "Rung", "SectionValues", "Tips"]

DRAWN, DRAWN_MODES = 41, 12  # points of a backbone; modes of a loaded one


class Rung(Enum):
    """How a rod is solved, from low to high."""

    ARC = "arc"
    CHAIN = "chain"
    LOADED = "loaded"

    @property
    def text(self) -> str:
        """What it is, for people."""
        return {
            Rung.ARC: "one exponential: a circular arc",
            Rung.CHAIN: "a chain of exponentials",
            Rung.LOADED: "equilibrium under loads, in modes of the curvature",
        }[self]


@dataclass(frozen=True, eq=False)
class SectionValues:
    """What the rod needs to know of one section."""

    moments: Moments
    saint_venant: SaintVenant | None = None


@dataclass(frozen=True, eq=False)
class RodPiece:
    """A piece of the actuator.

    share : of its length. turned : angle [rad] of its section about the axis. section : None for
    the section that is asked about.
    """

    share: float
    turned: float = 0.0
    section: SectionValues | None = None


@dataclass(frozen=True, eq=False)
class Loads:
    """Loads in the frame of the actuator's base.

    weight : (3,) per volume of material [mN/mm³]. line : per length, at the material centroid.
    tip : at the material centroid of the tip, its `at` from there.
    """

    weight: FloatArray = field(default_factory=lambda: np.zeros(3))
    line: LineLoad = field(default_factory=LineLoad)
    tip: PointLoad = field(default_factory=PointLoad)

    @cached_property
    def any(self) -> bool:
        """Whether there are any."""
        line, tip = self.line, self.tip
        forces = (self.weight, line.force, line.follower_force, tip.force, tip.moment)
        return any(np.any(load) for load in (*forces, tip.follower_force, tip.follower_moment))


@dataclass(frozen=True, eq=False)
class Tips:
    """positions : (n, 3) tips [mm]; directions : (n, 3) unit tangents R e3 of the axis there.

    NaN where `status` says that there is none; no directions where nobody asked.
    """

    positions: FloatArray
    status: tuple[RodStatus, ...]
    directions: FloatArray | None = None

    @property
    def failure(self) -> RodStatus | None:
        """How the first case without a tip ended; None where all have one."""
        return next((one for one in self.status if one is not RodStatus.CONVERGED), None)


@dataclass(frozen=True, eq=False)
class RodModel:
    """An actuator but for its section: what turns sections and pressures into tips.

    length : H [mm]. youngs_modulus, shear_modulus : E, G [kPa].
    response_of : what makes a response of a section's moments.
    pieces : from the base to the tip; shares add to 1.
    curvature : (3,) u at rest without pressure, in the base's axes: a pre-curved actuator [1/mm].
    rung : how it is solved. method : see `solve_rod`. tolerance : of a tip under loads [mm].
    twists : whether sections twist and shear after Saint-Venant; else they do not twist, κ = 1.

    The rod's axis goes through the material centroid of the base's section; where other sections
    follow, their centroids lie beside it. Tips are material centroids.
    """

    length: float
    youngs_modulus: float
    shear_modulus: float
    response_of: Callable[[Moments], Response]
    pieces: tuple[RodPiece, ...] = (RodPiece(1.0),)
    loads: Loads = field(default_factory=Loads)
    curvature: FloatArray = field(default_factory=lambda: np.zeros(3))
    rung: Rung = Rung.ARC
    method: MethodName = "modes"
    tolerance: float = 0.1
    twists: bool = False

    @property
    def poissons_ratio(self) -> float:
        """ν of E and G; see `law.poissons_ratio`."""
        return poissons_ratio(self.youngs_modulus, self.shear_modulus)

    @property
    def is_uniform(self) -> bool:
        """Whether all of its sections are the one that is asked about, as it stands."""
        return all(piece.section is None and piece.turned == 0.0 for piece in self.pieces)

    @property
    def lowest_rung(self) -> Rung:
        """The lowest rung that is exact."""
        if self.loads.any:
            return Rung.LOADED
        return Rung.ARC if self.is_uniform and self.curvature[2] == 0.0 else Rung.CHAIN

    @property
    def straight_length(self) -> float | None:
        """Its length [mm]; None where it is not straight without pressure."""
        straight = self.lowest_rung is Rung.ARC and not np.any(self.curvature)
        return self.length if straight else None

    def on(self, rung: Rung) -> RodModel:
        """The same actuator, solved in another way."""
        return replace(self, rung=rung)

    def tips(
        self,
        section: SectionValues,
        pressures: FloatArray,
        parents: IndexArray | None = None,
        *,
        all_or_none: bool = False,
    ) -> Tips:
        """Tips of the actuator with this section at the pressures (n, 3) [kPa].

        parents : (n, 3) see `StrainModes`. all_or_none : see `solve_rod`.
        """
        if self.rung is Rung.ARC:
            strains = self.arc_strains(section.moments, pressures)
            ways = arc_tip_directions(strains, self.length)
            return _all_found(arc_tips(strains, self.length), ways)
        rod, rest = self.rod(section), self.rest(section, pressures)
        if self.rung is Rung.CHAIN:
            position, rotation = chain_tips(rod, rest)
            return _all_found(self.centroids(section, position, rotation), rotation[..., 2])
        found = solve_rod(
            rod, rest, self.tolerance, parents, all_or_none=all_or_none, method=self.method
        )
        tips = self.centroids(section, found.tips, found.rotations)
        return Tips(tips, found.status, found.rotations[..., 2])

    def centroids(
        self, section: SectionValues, position: FloatArray, rotation: FloatArray
    ) -> FloatArray:
        """(n, 3) material centroids of the tip where its axis is at `position` (n, 3) [mm].

        rotation : (n, 3, 3) of the tip's section.
        """
        return np.asarray(position + rotation @ self._beside(section)[-1])

    def arcs(self, moments: Moments, pressures: FloatArray) -> FloatArray:
        """(…, n, 3) tips of the rods of one section or a batch (…), all of them arcs."""
        return arc_tips(self.arc_strains(moments, pressures), self.length)

    def arc_strains(self, moments: Moments, pressures: FloatArray) -> FloatArray:
        """(…, n, 3) strains ε, κ1, κ2 of these arcs [1, 1/mm, 1/mm]."""
        strains = self.response_of(moments).strains(pressures)
        if np.any(self.curvature):
            strains = strains + np.array([0.0, self.curvature[0], self.curvature[1]])
        return strains

    def backbones(
        self, section: SectionValues, pressures: FloatArray, parents: IndexArray | None = None
    ) -> FloatArray:
        """(n, m, 3) the axis from base to tip [mm] at the pressures (n, 3) [kPa]; NaN without."""
        if self.rung is Rung.ARC:
            strains = self.arc_strains(section.moments, pressures)
            return arc_centreline(strains, np.linspace(0, self.length, DRAWN))
        rod, rest = self.rod(section), self.rest(section, pressures)
        if self.rung is Rung.CHAIN:
            return chain_centrelines(rod, rest, max(2, DRAWN // len(self.pieces)))
        found = StrainModes(parents=parents).solve(rod, rest, DRAWN_MODES)
        base = np.broadcast_to(rod.base.position, (len(rest), 1, 3))
        return np.concatenate([base, found.centrelines, found.tips[:, None, :]], axis=1)

    def rod(self, section: SectionValues) -> Rod:
        """The rod of the actuator with this section, without pressure."""
        segments = []
        for piece, beside in zip(self.pieces, self._beside(section), strict=True):
            values = piece.section or section
            known = values.saint_venant if self.twists else None
            law = section_law(
                values.moments,
                self.youngs_modulus,
                self.shear_modulus,
                torsion_constant=None if known is None else known.torsion_constant,
                shear_area=None if known is None else known.shear_area,
                shear_centre=None if known is None else known.shear_centre,
            )
            weight = self.loads.weight * float(values.moments.area)
            line = self.loads.line
            segments.append(
                Segment(
                    piece.share * self.length,
                    law.turned(piece.turned).about(beside[:2]),
                    line=LineLoad(weight + line.force, line.follower_force, beside),
                )
            )
        tip = replace(self.loads.tip, at=self.loads.tip.at + beside)
        return Rod((*segments[:-1], replace(segments[-1], end=tip)))

    def rest(self, section: SectionValues, pressures: FloatArray) -> FloatArray:
        """(n, pieces, 6) strains (u, v) of the rod without loads at the pressures (n, 3) [kPa]."""
        rest = np.zeros((len(pressures), len(self.pieces), 6))
        for k, (piece, beside) in enumerate(zip(self.pieces, self._beside(section), strict=True)):
            strains = self.response_of((piece.section or section).moments).strains(pressures)
            cosine, sine = np.cos(piece.turned), np.sin(piece.turned)
            rest[:, k, :3] = self.curvature
            rest[:, k, 0] += cosine * strains[:, 1] - sine * strains[:, 2]
            rest[:, k, 1] += sine * strains[:, 1] + cosine * strains[:, 2]
            rest[:, k, 5] = 1 + strains[:, 0]
            rest[:, k, 3:] -= rest[:, k, :3] @ cross(beside)  # uᵀ [c]× = u × c
        return rest

    def _beside(self, section: SectionValues) -> list[FloatArray]:
        """(3,) of every piece: its material centroid, seen from the axis [mm]."""
        centroids = []
        for piece in self.pieces:
            x, y = (piece.section or section).moments.centroid
            cosine, sine = np.cos(piece.turned), np.sin(piece.turned)
            centroids.append(np.array([cosine * x - sine * y, sine * x + cosine * y, 0.0]))
        return [centroid - centroids[0] for centroid in centroids]


def _all_found(positions: FloatArray, directions: FloatArray) -> Tips:
    return Tips(positions, (RodStatus.CONVERGED,) * len(positions), directions)
