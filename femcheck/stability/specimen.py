"""One actuator of the map: its section, length, material, element, and how finely it is meshed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from math import ceil

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.outline.build import build_outline
from beamopt.rod.arc import arc_tips
from beamopt.rod.response import linear_response
from beamopt.section.drawing import Shape
from beamopt.section.grid import PolarGrid
from beamopt.section.seal import SealRules
from femcheck.material.fibre import Thread
from femcheck.material.neo_hookean import NeoHookean
from femcheck.mesh.extrusion import stations
from femcheck.mesh.geo import SectionSizes
from femcheck.mesh.gmsh_section import Mesher, MeshFailure
from femcheck.solid.elements import DEFAULT_ELEMENT, ELEMENTS
from femcheck.solid.winding import Wound
from femcheck.solved.case import Solid
from femcheck.stability.ending import MapEnding

__all__ = ["Absent", "Specimen", "beam_tips", "solid_of"]

RULES = SealRules(skin=0.5, wall=0.5, rounding=0.3, smallest_chamber=3.0)
"""No section here comes near them: they say that its chambers are closed."""

FINER_SAGITTA, FINER_SIZE, MORE_LAYERS = 0.2, 0.5, 1.5


@dataclass(frozen=True, slots=True)
class Specimen:
    """An actuator whose first supply is under pressure.

    Parameters
    ----------
    shapes : the chambers.
    outer_radius, inner_radius : of the ring or disc [mm].
    length : H [mm].
    law : its material.
    thread : what every chamber is wound with; None where none is.
    element : name of the element.
    layers, grading : along the actuator, see `femcheck.mesh.extrusion.stations`.
    sagitta : how far the polygons of the section may be from its arcs [mm]; less at thin walls.
    size : of the triangles, over the usual one.
    """

    shapes: tuple[Shape, ...]
    outer_radius: float
    inner_radius: float
    length: float
    law: NeoHookean
    thread: Thread | None = None
    element: str = DEFAULT_ELEMENT
    layers: int = 3
    grading: float = 1.5
    sagitta: float = 0.2
    size: float = 2.0

    @property
    def slenderness(self) -> float:
        """H/D: length over outer diameter."""
        return self.length / (2 * self.outer_radius)

    @property
    def finer(self) -> Specimen:
        """The same on a mesh as fine as that of a check."""
        return replace(
            self,
            layers=ceil(MORE_LAYERS * self.layers),
            sagitta=FINER_SAGITTA * self.sagitta,
            size=FINER_SIZE * self.size,
        )


@dataclass(frozen=True, slots=True)
class Absent:
    """No solid, and why."""

    ending: MapEnding
    reason: str


@lru_cache(maxsize=4)
def solid_of(specimen: Specimen) -> Solid | Absent:
    """The solid of a specimen; meshed once a process."""
    law, element = specimen.law, specimen.element
    if law.volumetric_compliance is not None and not ELEMENTS[element].has_pair:
        said = f"{element} has no stable pair for ν = {law.poisson_ratio:g}"
        return Absent(MapEnding.NO_PAIR, said)
    grid = PolarGrid(inner_radius=specimen.inner_radius, outer_radius=specimen.outer_radius)
    outline = build_outline(grid, list(specimen.shapes), RULES, specimen.sagitta)
    section = Mesher().mesh(outline, SectionSizes(factor=specimen.size))
    if isinstance(section, MeshFailure):
        return Absent(MapEnding.NO_MESH, str(section))
    heights = stations(specimen.length, specimen.layers, specimen.grading)
    wound = None if specimen.thread is None else (Wound.CHAMBERS, specimen.thread)
    return Solid("specimen", section, heights, element, law, wound=wound)


def beam_tips(specimen: Specimen, solid: Solid, pressures: FloatArray) -> FloatArray:
    """(n, 3) tips [mm] of the beam on the meshed section, at pressures (n,) [kPa] of supply 1."""
    response = linear_response(solid.section.moments, specimen.law.youngs_modulus)
    loads = np.asarray(pressures)[:, None] * np.array([1.0, 0.0, 0.0])
    return arc_tips(response.strains(loads), specimen.length)
