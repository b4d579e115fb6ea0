"""The plane faces of a section that solids and drawings are made of; true circles kept as such."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.errors import InputError
from beamopt.outline.faults import FaultKind
from beamopt.outline.green import loop_integrals
from beamopt.outline.outline import Outline
from beamopt.outline.ring import USUAL_RADIUS, fine_sagitta
from beamopt.section.feature_points import MATERIAL, SUPPLIES
from beamopt.section.grid import PolarGrid

if TYPE_CHECKING:
    from shapely import Polygon

__all__ = ["Contour", "Face", "SectionFaces", "polygon_of", "section_faces"]

SHORTEST = 1e-4
"""mm at an outer radius of 25; vertices nearer to each other than this are one: no kernel tells
shorter edges from none."""

LATTICE = 1e-6  # mm at an outer radius of 25, that lines are snapped to where they touch themselves

SMALLEST = 1e-4
"""mm² at an outer radius of 25; what is smaller is a crumb of clipping and no hole or face."""

REFUSED = (FaultKind.INVALID, FaultKind.NO_MATERIAL)


@dataclass(frozen=True, slots=True, eq=False)
class Contour:
    """A closed line around a face or a hole in it.

    points : (n, 2) vertices [mm], the first one not repeated; counter-clockwise around a face,
        clockwise around a hole.
    radius : of the circle about the axis that the points lie on [mm]; None where it is none.
    is_surface : whether it is a surface of the actuator and no chamber's wall.
    """

    points: FloatArray
    radius: float | None = None
    is_surface: bool = False

    @property
    def polygon_area(self) -> float:
        """Area that the straight edges enclose [mm²]; negative for a hole."""
        return float(loop_integrals(self.points)[0])

    @property
    def area(self) -> float:
        """Area that it encloses [mm²], of the circle where it is one; negative for a hole."""
        if self.radius is None:
            return self.polygon_area
        return float(np.copysign(np.pi * self.radius**2, self.polygon_area))

    @property
    def reversed(self) -> Contour:
        """The same line the other way round."""
        return Contour(self.points[::-1], self.radius, self.is_surface)


@dataclass(frozen=True, slots=True, eq=False)
class Face:
    """A connected part of the section.

    name : body, body-2 … for material; core-S-K for chamber K of supply S.
    supply : 0 material, 1…3 a chamber.
    contours : around it, then around its holes.
    """

    name: str
    supply: int
    contours: tuple[Contour, ...]

    @property
    def area(self) -> float:
        """Area with true circles [mm²]."""
        return sum(contour.area for contour in self.contours)

    @property
    def polygon_area(self) -> float:
        """Area within straight edges [mm²], as the beam's section has it."""
        return sum(contour.polygon_area for contour in self.contours)


@dataclass(frozen=True, slots=True, eq=False)
class SectionFaces:
    """A whole section: pieces of material, chambers supply by supply, the largest first.

    is_open : whether a chamber is open to a surface or to another supply.
    """

    pieces: tuple[Face, ...]
    chambers: tuple[Face, ...]
    is_open: bool

    @property
    def ring(self) -> tuple[Contour, ...]:
        """The surfaces alone, the outer one first: the section as if nothing were in it."""
        surfaces = [one for face in self.pieces for one in face.contours if one.is_surface]
        return tuple(sorted(surfaces, key=lambda contour: -contour.polygon_area))

    def chamber_area(self, supply: int) -> float:
        """Area of all chambers of a supply [mm²]."""
        return float(sum(face.area for face in self.chambers if face.supply == supply))


def section_faces(outline: Outline, grid: PolarGrid, sagitta: float) -> SectionFaces:
    """The faces of an outline.

    A surface that is the ring's whole outer or inner circle becomes that circle; everything else
    keeps the outline's straight edges, as do surfaces that a chamber opens.

    sagitta : how far the outline's edges may be from the smooth section [mm].

    Raises
    ------
    InputError : the outline's polygons are invalid, or there is no material.
    """
    for fault in outline.faults:
        if fault.status in REFUSED:
            raise InputError("design", "", None, f"no solid can be made of it: {fault}")
    is_open = any(fault.status is FaultKind.UNSEALED for fault in outline.faults)
    slack = 2 * fine_sagitta(grid) + (0.0 if is_open else 1.1 * sagitta)
    unit = grid.outer_radius / USUAL_RADIUS
    pieces: list[Face] = []
    for piece in outline.pieces:
        contours = [
            _surface(loop.points, grid, slack, unit)
            if loop.supply == MATERIAL
            else Contour(_clean(loop.points, unit))
            for loop in piece.loops
        ]
        name = f"body-{len(pieces) + 1}" if pieces else "body"
        pieces.append(Face(name, MATERIAL, _without_crumbs(contours, unit)))
    chambers = []
    for supply in SUPPLIES:
        for number, chamber in enumerate(outline.chambers_of(supply), 1):
            loops = [Contour(_clean(loop, unit)) for loop in (chamber.exterior, *chamber.holes)]
            chambers.append(Face(f"core-{supply}-{number}", supply, _without_crumbs(loops, unit)))
    solid = [tuple(f for f in faces if f.contours) for faces in (pieces, chambers)]
    found = SectionFaces(solid[0], solid[1], is_open)
    _check(found)
    return found


def polygon_of(contours: Sequence[Contour]) -> Polygon:
    """What contours enclose, with straight edges."""
    import shapely

    exterior, *holes = (contour.points for contour in contours)
    return shapely.Polygon(exterior, holes)


def _surface(points: FloatArray, grid: PolarGrid, slack: float, unit: float) -> Contour:
    """A free surface, as the ring's circle where no vertex and no edge is farther off than `slack`.

    The edges count too: a straight cut through the ring may have both its ends on the circle.
    """
    if grid.is_full_ring:
        radius = grid.outer_radius if loop_integrals(points)[0] > 0 else grid.inner_radius
        middles = (points + np.roll(points, -1, axis=0)) / 2
        nearest, farthest = (np.hypot(*middles.T).min(), np.hypot(*points.T).max())
        if radius - slack <= nearest and farthest <= radius + slack:
            return Contour(points, radius, True)
    return Contour(_clean(points, unit), None, True)


def _clean(points: FloatArray, unit: float = 1.0) -> FloatArray:
    """Without vertices that stand where the one before stands, and without slits of no width."""
    shortest = SHORTEST * unit
    while len(points) > 2:
        before, after = np.roll(points, 1, axis=0), np.roll(points, -1, axis=0)
        repeated = np.hypot(*(points - before).T) < shortest
        spike = np.hypot(*(after - before).T) < shortest
        if not (repeated | spike).any():
            break
        points = points[~repeated] if repeated.any() else points[~spike]
    return _without_slits(points, unit)


def _without_slits(points: FloatArray, unit: float) -> FloatArray:
    """A line that comes back to where it was, as between drawn chambers side by side, snapped.

    Where that leaves more than one part the line stays as it is.
    """
    import shapely
    from scipy.spatial import cKDTree

    if len(points) < 3 or not cKDTree(points).query_pairs(SHORTEST * unit):
        return points
    snapped = shapely.get_parts(shapely.set_precision(shapely.Polygon(points), LATTICE * unit))
    parts = [part for part in snapped if part.area > SMALLEST * unit**2]
    if len(parts) != 1 or len(parts[0].interiors):
        return points
    turned = shapely.orient_polygons(parts[0], exterior_cw=loop_integrals(points)[0] < 0)
    return np.asarray(shapely.get_coordinates(turned.exterior)[:-1])


def _without_crumbs(contours: Sequence[Contour], unit: float) -> tuple[Contour, ...]:
    """No hole, and no face, that is too small to be one."""
    whole = [one for one in contours if len(one.points) > 2 and abs(one.area) > SMALLEST * unit**2]
    return tuple(whole) if whole and whole[0] is contours[0] else ()


def _check(faces: SectionFaces) -> None:
    import shapely

    for face in (*faces.pieces, *faces.chambers):
        polygon = polygon_of(face.contours)
        if not polygon.is_valid:
            said = f"no solid can be made of it: {shapely.is_valid_reason(polygon).lower()}"
            raise InputError("design", face.name, None, said)
    if not faces.pieces:
        raise InputError("design", "", None, "no material")
