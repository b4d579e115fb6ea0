"""What a drawing of a section says and where its labels stand, whatever format it is drawn in."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from beamopt.export.faces import Contour, Face, SectionFaces, polygon_of
from beamopt.scene.design import Design
from beamopt.section.feature_points import SUPPLIES
from beamopt.section.grid import PolarGrid
from beamopt.section.seal import SealRules

if TYPE_CHECKING:
    from shapely import Polygon

__all__ = ["SCALE_BAR", "Drawing", "Label", "is_thinner", "section_drawing"]

SCALE_BAR = 10.0
"""mm; the bar that a ruler is held against."""

LARGEST, SMALLEST = 5.0, 0.8  # mm, heights of the numbers in chambers
SAME = 0.995  # of a skin or wall that was asked for; less is said
LONGEST = 60  # characters of a name or a note


@dataclass(frozen=True, slots=True)
class Label:
    """A supply's number in one of its chambers.

    x, y : its middle [mm]. height : of its digits [mm].
    """

    supply: int
    x: float
    y: float
    height: float


@dataclass(frozen=True, slots=True, eq=False)
class Drawing:
    """A section seen from the tip, and what is written beside it; lengths in mm.

    bounds : least x and y, greatest x and y of the section.
    outer_diameter, inner_diameter : of a whole ring; None for a sector, inner 0 for a disc.
    least_skin : least distance between a chamber and a surface; 0 where one is open, None
        without chambers.
    least_wall : least distance between two chambers; None with fewer than two.
    """

    title: str
    faces: SectionFaces
    bounds: tuple[float, float, float, float]
    labels: tuple[Label, ...]
    outer_diameter: float | None
    inner_diameter: float | None
    least_skin: float | None
    least_wall: float | None
    lines: tuple[str, ...]


def is_thinner(least: float | None, asked: float) -> bool:
    """True if a least skin or wall is so much thinner than asked that a person should know."""
    return least is not None and least < SAME * asked


def section_drawing(
    design: Design, faces: SectionFaces, name: str, sagitta: float, cap: float = 0.0
) -> Drawing:
    """The drawing of a design's section.

    Skins and walls are measured on what is drawn; a wall within one chamber is not among them.
    """
    import shapely

    grid = design.grid.build()
    x0, y0, x1, y1 = shapely.MultiPolygon([polygon_of(f.contours) for f in faces.pieces]).bounds
    if grid.is_full_ring:
        x0, y0, x1, y1 = (sign * grid.outer_radius for sign in (-1, -1, 1, 1))
    skin, wall = (0.0, 0.0) if faces.is_open else _thinnest(faces)
    return Drawing(
        title=_short(name),
        faces=faces,
        bounds=(x0, y0, x1, y1),
        labels=tuple(_label(face) for face in faces.chambers),
        outer_diameter=2 * grid.outer_radius if grid.is_full_ring else None,
        inner_diameter=2 * grid.inner_radius if grid.is_full_ring else None,
        least_skin=skin,
        least_wall=wall,
        lines=(
            *_origin(design),
            _size(design, grid, cap),
            _areas(faces),
            _thickness(faces, skin, wall, design.seal.rules),
            f"seen from the tip; edges within {sagitta:g} mm of the smooth section",
        ),
    )


def _thinnest(faces: SectionFaces) -> tuple[float | None, float | None]:
    """Least distances from a chamber to a surface, and between two chambers [mm]."""

    chambers = [polygon_of(face.contours) for face in faces.chambers]
    skins = [_skin(one, surface) for one in chambers for surface in faces.ring]
    walls = [one.distance(other) for one, other in combinations(chambers, 2)]
    return min(skins, default=None), min(walls, default=None)


def _skin(chamber: Polygon, surface: Contour) -> float:
    """Distance from a chamber to a surface [mm], to the circle where it is one."""
    import shapely

    if surface.radius is None:
        return float(chamber.distance(shapely.LinearRing(surface.points)))
    if surface.area > 0:
        corners = shapely.get_coordinates(chamber)
        return float(surface.radius - np.hypot(*corners.T).max())
    return float(chamber.exterior.distance(shapely.Point(0.0, 0.0)) - surface.radius)


def _label(face: Face) -> Label:
    """The number in the middle of the largest circle that its chamber holds."""
    import shapely

    line = shapely.maximum_inscribed_circle(polygon_of(face.contours), tolerance=0.02)
    (x, y), _ = shapely.get_coordinates(line).tolist()
    height = min(max(line.length, SMALLEST), LARGEST)
    return Label(face.supply, x, y, height)


def _origin(design: Design) -> Iterator[str]:
    """Where a search made it, as its notes say."""
    notes = design.notes
    loss = notes.get("L")
    said = [
        f"scene {_short(notes['scene'])}" if notes.get("scene") else "",
        f"seed {_short(notes['seed'])}" if notes.get("seed") is not None else "",
        f"L = {loss:.4g} mm²" if isinstance(loss, float) else "",
    ]
    if any(said):
        yield ", ".join(part for part in said if part)


def _size(design: Design, grid: PolarGrid, cap: float) -> str:
    length = f"length {design.actuator.length:g} mm"
    length += f" and two end plates of {cap:g} mm" if cap else ""
    outer, inner = grid.outer_radius, grid.inner_radius
    if grid.is_full_ring:
        hole = f"inner diameter {2 * inner:g} mm, " if inner else ""
        return f"outer diameter {2 * outer:g} mm, {hole}{length}"
    first, span = grid.start, grid.span
    return f"sector {first:g}…{first + span:g}°, radii {inner:g} and {outer:g} mm, {length}"


def _areas(faces: SectionFaces) -> str:
    material = sum(face.area for face in faces.pieces)
    supplies = [f"{supply}: {_area(faces.chamber_area(supply))}" for supply in SUPPLIES]
    return f"material {_area(material)} mm², chambers {', '.join(supplies)} mm²"


def _area(area: float) -> str:
    return f"{area:.1f}" if area >= 10 or area == 0 else f"{area:.3g}"


def _thickness(
    faces: SectionFaces, skin: float | None, wall: float | None, rules: SealRules
) -> str:
    if faces.is_open:
        return "chambers are open to a surface or to each other: no least skin or wall"
    parts = [
        "no chambers" if skin is None else f"least skin {skin:.2f} mm{_asked(skin, rules.skin)}",
        ""
        if wall is None
        else f"least wall between chambers {wall:.2f} mm{_asked(wall, rules.wall)}",
    ]
    return ", ".join(part for part in parts if part)


def _asked(least: float, asked: float) -> str:
    return f" (asked {asked:g})" if is_thinner(least, asked) else ""


def _short(value: object) -> str:
    """One line of what a person wrote, printable and not too long."""
    text = " ".join("".join(c if c.isprintable() else " " for c in str(value)).split())
    return text if len(text) <= LONGEST else text[: LONGEST - 1] + "…"
