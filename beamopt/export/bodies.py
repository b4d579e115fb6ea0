"""Which solids there are: the body, and the mould that leaves its chambers and its hole free."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from beamopt.base.errors import InputError
from beamopt.export.faces import Contour, Face, SectionFaces
from beamopt.outline.ring import circle
from beamopt.section.grid import PolarGrid

__all__ = ["BASE_MARGIN", "BASE_THICKNESS", "ExtrudedFace", "body_solids", "mould_solids"]

BASE_THICKNESS = 5.0
"""mm, of the plate that the cores stand on."""

BASE_MARGIN = 5.0
"""mm that the plate is wider than the actuator, all round."""


@dataclass(frozen=True, slots=True, eq=False)
class ExtrudedFace:
    """A plane face extruded along z, less closed cavities within it.

    low, high : where it begins and ends [mm]; z = 0 is the actuator's base.
    cavities : solids wholly inside it that are empty.
    """

    name: str
    contours: tuple[Contour, ...]
    low: float
    high: float
    cavities: tuple[ExtrudedFace, ...] = ()

    @property
    def volume(self) -> float:
        """Volume with true circles [mm³]."""
        area = sum(contour.area for contour in self.contours)
        return area * (self.high - self.low) - sum(one.volume for one in self.cavities)

    @property
    def polygon_volume(self) -> float:
        """Volume within plane faces [mm³], as an STL file has it."""
        area = sum(contour.polygon_area for contour in self.contours)
        return area * (self.high - self.low) - sum(one.polygon_volume for one in self.cavities)


def body_solids(faces: SectionFaces, length: float, cap: float = 0.0) -> tuple[ExtrudedFace, ...]:
    """What is cast: every connected piece of material from z = 0 to `length`.

    cap : thickness of a plate of the same material at each end [mm], which closes the chambers and
        leaves the ring's hole open; it reaches from −cap to 0 and from `length` to `length` + cap,
        so that the length between the plates is the model's. With 0 the chambers are open at
        both ends: the model's caps have neither mass nor thickness.

    Raises
    ------
    InputError : caps were asked for, but the chambers are open to a surface or to each other.
    """
    if cap == 0:
        return tuple(ExtrudedFace(face.name, face.contours, 0.0, length) for face in faces.pieces)
    if faces.is_open:
        said = "must be 0: chambers are open, end plates would not close them"
        raise InputError("--cap", "", f"{cap:g}", said)
    cavities = _extruded(faces.chambers, length)
    return (ExtrudedFace("body", faces.ring, -cap, length + cap, cavities),)


def mould_solids(
    faces: SectionFaces,
    grid: PolarGrid,
    length: float,
    sagitta: float,
    base_thickness: float = BASE_THICKNESS,
) -> tuple[ExtrudedFace, ...]:
    """What keeps the chambers free while the body is cast: cores on a round plate.

    One core a chamber from z = 0 to `length`, with a hole where an island of material is; for a
    whole ring with a hole also "core-hole" in the middle; below them "base-plate", which is
    5 mm wider than the actuator. The outer shell is not among them: a tube of the outer diameter
    does. A sector's flat sides and its inner surface belong to the shell, too.
    """
    cores = _extruded(faces.chambers, length)
    if grid.is_full_ring and grid.inner_radius > 0:
        cores += (ExtrudedFace("core-hole", (_hole(faces, grid, sagitta),), 0.0, length),)
    radius = grid.outer_radius + BASE_MARGIN
    rim = Contour(circle(radius, sagitta), radius, True)
    return (*cores, ExtrudedFace("base-plate", (rim,), -base_thickness, 0.0))


def _extruded(chambers: Sequence[Face], length: float) -> tuple[ExtrudedFace, ...]:
    return tuple(ExtrudedFace(face.name, face.contours, 0.0, length) for face in chambers)


def _hole(faces: SectionFaces, grid: PolarGrid, sagitta: float) -> Contour:
    """The inner circle, with the body's own vertices where the body has it."""
    for contour in faces.ring:
        if contour.radius is not None and contour.area < 0:
            return contour.reversed
    return Contour(circle(grid.inner_radius, sagitta), grid.inner_radius, True)
