"""What is wrong with an outline, found on the polygons themselves."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from beamopt.outline.faults import Fault, FaultKind
from beamopt.outline.outline import Piece
from beamopt.outline.rays import thin_places
from beamopt.outline.smoothing import Region, loops_of
from beamopt.section.feature_points import SUPPLIES
from beamopt.section.seal import SealRules

if TYPE_CHECKING:
    from shapely import Geometry, Polygon

__all__ = ["TOUCH", "contacts", "nearest", "pinches", "self_contacts", "thicknesses", "topology"]

TOUCH = 0.01
"""mm; what is nearer is not separated by a wall."""

PINCH = 0.05  # mm; drawn shapes that touch overlap by their polygons in less than twice this
SPACING = 0.1  # mm between rays
APART = 100.0  # times as far along a wall as across: no corner of material of more than 1.2°
FACING = 0.7  # cosine: walls that close in on each other by more than 45° are a corner's two sides


def contacts(regions: Sequence[Region], ring: Polygon) -> list[Fault]:
    """Chambers that are open to a surface or to another supply, or that touch one another."""
    faults = []
    for supply, distance, place in _to_surface(regions, ring, TOUCH):
        faults.append(Fault(FaultKind.UNSEALED, distance, place, (supply,)))
    for supplies, distance, place in _between(regions, TOUCH):
        kind = FaultKind.UNSEALED if len(supplies) > 1 else FaultKind.INVALID
        faults.append(Fault(kind, distance, place, supplies))
    return faults


def self_contacts(regions: Sequence[Region]) -> list[Fault]:
    """Chambers that nearly meet themselves: material within them as thin as what touches."""
    return [
        Fault(FaultKind.INVALID, distance, place, (supply,))
        for supply, distance, place in _within_parts(regions, TOUCH, 1.0, APART, 5.0)
    ]


def pinches(regions: Sequence[Region]) -> list[Fault]:
    """Drawn shapes of one supply that touch: two lobes with no more than a point between them."""
    import shapely

    faults = []
    for supply, region in zip(SUPPLIES, regions, strict=True):
        for part in region:
            lobes = shapely.get_parts(part.buffer(-PINCH, quad_segs=1))
            for one, other in combinations(lobes, 2):
                line = shapely.shortest_line(one, other)
                if line.length < 4 * PINCH:
                    place = _xy(line.interpolate(0.5, normalized=True))
                    faults.append(Fault(FaultKind.INVALID, 0.0, place, (supply,)))
    return faults


def nearest(regions: Sequence[Region], ring: Polygon, reach: float) -> float:
    """Least distance between two chambers, or one and a surface; `reach` when none is nearer."""
    surface = [distance for _, distance, _ in _to_surface(regions, ring, reach)]
    between = [distance for _, distance, _ in _between(regions, reach)]
    return min([reach, *surface, *between])


def thicknesses(
    regions: Sequence[Region], ring: Polygon, rules: SealRules, tolerance: float
) -> list[Fault]:
    """Skins, walls and necks more than `tolerance` [mm] thinner than asked.

    Distances between different polygons are exact; within one chamber, rays look for material
    between two of its walls that face each other.
    """
    faults = []
    for supply, distance, place in _to_surface(regions, ring, rules.skin - tolerance):
        faults.append(Fault(FaultKind.SKIN, distance, place, (supply,), rules.skin))
    below = rules.wall - tolerance
    for supplies, distance, place in _between(regions, below):
        kind = FaultKind.WALL if len(supplies) > 1 else FaultKind.NECK
        faults.append(Fault(kind, distance, place, supplies, rules.wall))
    for supply, distance, place in _within_parts(regions, below, FACING, 3.0, 2 * rules.wall):
        faults.append(Fault(FaultKind.NECK, distance, place, (supply,), rules.wall))
    return faults


def _within_parts(
    regions: Sequence[Region], below: float, opposed: float, around: float, apart: float
) -> list[tuple[int, float, tuple[float, float]]]:
    """Supply, thickness and place of material between two walls of one chamber, the thinnest first.

    Of places nearer to each other than `apart` [mm] only the thinnest: a long thin wall is one.
    """
    loops = [
        (supply, part, loop)
        for supply, region in zip(SUPPLIES, regions, strict=True)
        for part in region
        for loop in loops_of(part)
    ]
    if below <= 0:
        return []
    thin = thin_places([loop for _, _, loop in loops], below, SPACING, opposed, around)
    found: list[tuple[int, float, tuple[float, float]]] = []
    for k in np.argsort(thin.thickness, kind="stable"):
        (supply, part, _), (_, other, _) = loops[thin.start[k]], loops[thin.hit[k]]
        x, y = (float(value) for value in thin.middle[k])
        if part is other and all(np.hypot(x - a, y - b) > apart for _, _, (a, b) in found):
            found.append((supply, float(thin.thickness[k]), (x, y)))
    return found


def topology(pieces: Sequence[Piece], regions: Sequence[Region]) -> list[Fault]:
    """Missing material, pieces that do not hang together, islands, missing chambers."""
    faults = []
    if not pieces:
        faults.append(Fault(FaultKind.NO_MATERIAL))
    standing = [piece for piece in pieces if not piece.is_island]
    if len(standing) > 1:
        place = _inner_point(standing[1])
        faults.append(Fault(FaultKind.PIECES, float(len(standing)), place))
    for piece in pieces:
        if piece.is_island:
            around = (piece.exterior.supply,)
            faults.append(Fault(FaultKind.ISLAND, piece.area, _inner_point(piece), around))
    for supply, region in zip(SUPPLIES, regions, strict=True):
        if not region:
            faults.append(Fault(FaultKind.NO_CHAMBER, supplies=(supply,)))
    return faults


def _inner_point(piece: Piece) -> tuple[float, float]:
    import shapely

    polygon = shapely.Polygon(piece.exterior.points, [hole.points for hole in piece.holes])
    return _xy(polygon.point_on_surface())


def _xy(point: Geometry) -> tuple[float, float]:
    return float(point.x), float(point.y)


def _to_surface(
    regions: Sequence[Region], ring: Polygon, below: float
) -> list[tuple[int, float, tuple[float, float]]]:
    """Supply, distance and place of every chamber nearer than that to a surface."""
    import shapely

    found = []
    surface = ring.boundary
    shapely.prepare(surface)
    for supply, region in zip(SUPPLIES, regions, strict=True):
        for part in region:
            if below <= 0 or not shapely.dwithin(surface, part.boundary, below):
                continue
            line = shapely.shortest_line(surface, part.boundary)
            found.append((supply, line.length, _xy(line.interpolate(0.5, normalized=True))))
    return found


def _between(
    regions: Sequence[Region], below: float
) -> list[tuple[tuple[int, ...], float, tuple[float, float]]]:
    """Supplies, distance and place of every two chambers nearer than that to each other."""
    import shapely

    parts = [
        (supply, part) for supply, region in zip(SUPPLIES, regions, strict=True) for part in region
    ]
    if below <= 0 or len(parts) < 2:
        return []
    shapes = np.array([part for _, part in parts])
    first, second = shapely.STRtree(shapes).query(shapes, predicate="dwithin", distance=below)
    found = []
    for i, j in sorted(zip(first.tolist(), second.tolist(), strict=True)):
        if i < j:
            line = shapely.shortest_line(shapes[i], shapes[j])
            supplies = tuple(sorted({parts[i][0], parts[j][0]}))
            found.append((supplies, line.length, _xy(line.interpolate(0.5, normalized=True))))
    return found
