"""Drawn chambers as polygons, their arcs as fine as the smooth outline's."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.outline.cells import LATTICE
from beamopt.outline.faults import Fault, FaultKind
from beamopt.outline.ring import arc, circle, fine_sagitta, ring_polygon
from beamopt.outline.smoothing import parts_of
from beamopt.section.drawing import Circle, RingPiece, Shape
from beamopt.section.feature_points import SUPPLIES
from beamopt.section.grid import PolarGrid, angle_between

if TYPE_CHECKING:
    from shapely import Geometry, Polygon

__all__ = ["drawing_faults", "drawn_regions", "least_width", "outside", "solid", "too_thin"]


NOTHING = 1e-6  # mm; radii below it have no arc


def drawn_regions(shapes: Sequence[Shape], sagitta: float) -> tuple[Geometry, ...]:
    """For supplies 1, 2, 3 what is drawn of them; a later shape covers an earlier one.

    Two polygons of one arc differ by up to a sagitta: what is narrower than two of them is none,
    and so is a gap between two ring pieces of one supply.
    """
    import shapely

    polygons = _drawn_polygons(shapes, sagitta)
    drawn = {supply: shapely.Polygon() for supply in SUPPLIES}
    for number in _visible(polygons, sagitta):
        own, polygon = shapes[number].supply, polygons[number]
        for supply in SUPPLIES:
            drawn[supply] = (
                _joined(drawn[supply], polygon, isinstance(shapes[number], RingPiece), sagitta)
                if supply == own
                else _without(drawn[supply], polygon, sagitta)
            )
    return tuple(drawn[supply] for supply in SUPPLIES)


def _drawn_polygons(shapes: Sequence[Shape], sagitta: float) -> list[Geometry]:
    """Each shape as a polygon of its area, whatever covers it."""
    import shapely

    polygons = [
        _circle(shape, sagitta) if isinstance(shape, Circle) else _piece(shape, sagitta)
        for shape in shapes
    ]
    # the arcs of corners that only just fit may cross by a rounding
    return [
        polygon if polygon.is_valid else shapely.MultiPolygon(parts_of(shapely.make_valid(polygon)))
        for polygon in polygons
    ]


def _hidden(polygons: Sequence[Geometry], sagitta: float) -> list[int]:
    """Numbers of the polygons of which later ones leave nothing, ascending."""
    visible = set(_visible(polygons, sagitta))
    return [number for number in range(len(polygons)) if number not in visible]


def least_width(grid: PolarGrid) -> float:
    """A drawn chamber that is nowhere wider can not be told from the edges of its arcs [mm]."""
    return 2 * fine_sagitta(grid)


def too_thin(shapes: Sequence[Shape], grid: PolarGrid) -> list[int]:
    """Numbers of the shapes that are nowhere as wide as the least width, ascending."""
    sagitta = fine_sagitta(grid)
    polygons = _drawn_polygons(shapes, sagitta)
    return [number for number, polygon in enumerate(polygons) if solid(polygon, sagitta).is_empty]


def outside(shapes: Sequence[Shape], grid: PolarGrid) -> list[int]:
    """Numbers of the shapes of which the ring or sector has no part that wide, ascending."""
    sagitta = fine_sagitta(grid)
    ring = ring_polygon(grid)
    return [
        number
        for number, polygon in enumerate(_drawn_polygons(shapes, sagitta))
        if solid(polygon.intersection(ring, grid_size=LATTICE), sagitta).is_empty
    ]


def drawing_faults(
    shapes: Sequence[Shape], ring: Polygon, sagitta: float, chambers: Sequence[Sequence[Polygon]]
) -> list[Fault]:
    """Drawn chambers that a surface cuts, that later ones hide, and that came to nothing.

    chambers : what there is of supplies 1, 2, 3 in the section.
    """
    import shapely

    polygons = _drawn_polygons(shapes, sagitta)
    covered, faults = set(_hidden(polygons, sagitta)), []
    for number, (shape, polygon) in enumerate(zip(shapes, polygons, strict=True)):
        supplies, middle = (shape.supply,), _xy(polygon.point_on_surface())
        if number in covered:
            faults.append(Fault(FaultKind.HIDDEN, polygon.area, middle, supplies, drawn=number))
            continue
        beyond = _without(polygon, ring, sagitta)
        if not beyond.is_empty:
            cuts = shapely.get_parts(shapely.line_merge(ring.boundary.intersection(polygon)))
            cut = max(cuts, key=shapely.length, default=polygon.boundary)
            place = _xy(cut.interpolate(0.5, normalized=True))
            faults.append(Fault(FaultKind.CUT, beyond.area, place, supplies, drawn=number))
        own = shapely.MultiPolygon(list(chambers[shape.supply - 1]))
        if solid(polygon.intersection(own, grid_size=LATTICE), sagitta).is_empty:
            faults.append(Fault(FaultKind.LOST, polygon.area, middle, supplies, drawn=number))
    return faults


def _xy(point: Geometry) -> tuple[float, float]:
    return float(point.x), float(point.y)


def _visible(polygons: Sequence[Geometry], sagitta: float) -> list[int]:
    """Numbers of the polygons of which later ones leave something, ascending.

    Each is compared with its neighbours only: a union of all later ones would be quadratic.
    """
    import shapely

    tree, found = shapely.STRtree(polygons), set[int]()
    for number in reversed(range(len(polygons))):
        near = tree.query(polygons[number], predicate="intersects").tolist()
        later = [polygons[other] for other in sorted(near) if other in found]
        cover = shapely.union_all(later, grid_size=LATTICE)
        if not _without(polygons[number], cover, sagitta).is_empty:
            found.add(number)
    return sorted(found)


def _without(geometry: Geometry, polygon: Geometry, sagitta: float) -> Geometry:
    """What a polygon leaves of a geometry; no slivers and spikes narrower than two sagittas."""
    if not geometry.intersects(polygon):
        return geometry
    return solid(geometry.difference(polygon, grid_size=LATTICE), sagitta)


def _joined(geometry: Geometry, polygon: Geometry, ring_piece: bool, sagitta: float) -> Geometry:
    """Both, and the gaps narrower than two sagittas beside a ring piece.

    Circles that touch get no bridge: they have no side in common.
    """
    import shapely

    if not geometry.dwithin(polygon, 2 * sagitta):
        return geometry.union(polygon)
    joined = geometry.union(polygon, grid_size=LATTICE)
    if not ring_piece:
        return joined
    closed = _offset(_offset(joined, sagitta), -sagitta)
    gaps = parts_of(closed.difference(joined, grid_size=LATTICE))
    beside = [gap for gap in gaps if gap.dwithin(polygon, LATTICE)]
    return shapely.union_all([joined, *beside], grid_size=LATTICE)


def _offset(geometry: Geometry, by: float) -> Geometry:
    """Moved by less than any edge, corners sharp [mm]."""
    with np.errstate(invalid="ignore"):  # mitres of straight corners divide 0 by 0 in GEOS
        return geometry.buffer(by, join_style="mitre")


def solid(geometry: Geometry, sagitta: float) -> Geometry:
    """A geometry's polygons without slivers and spikes narrower than two sagittas [mm]."""
    import shapely

    geometry = shapely.MultiPolygon(parts_of(geometry))  # not the lines where polygons touch
    thick = _offset(_offset(geometry, -sagitta), 2 * sagitta)
    return geometry.intersection(thick, grid_size=LATTICE)


def _circle(shape: Circle, sagitta: float) -> Polygon:
    import shapely

    return shapely.Polygon(circle(shape.radius, sagitta) + np.asarray(shape.center))


def _piece(shape: RingPiece, sagitta: float) -> Polygon:
    import shapely

    (inner, outer), (first, last) = shape.r, shape.phi
    inner = inner if inner > NOTHING else 0.0
    between = angle_between(first, last)
    if between == 360:
        rim = circle(outer, sagitta)
        return shapely.Polygon(rim, [inner / outer * rim[::-1]] if inner > 0 else [])
    span = np.radians(between)
    start = _side(inner, outer, shape.corner, sagitta)
    other = start[::-1] * [1.0, -1.0]  # the other side is the mirror image …
    cosine, sine = np.cos(span), np.sin(span)
    other = other @ np.array([[cosine, sine], [-sine, cosine]])  # … turned by the whole span
    a, b = (np.arctan2(*end[::-1]) for end in (start[-1], start[0]))
    rim = arc(outer, a, span - a, sagitta)
    back = arc(inner, span - b, b, sagitta) if inner > 0 else np.zeros((1, 2))
    loop = np.concatenate([start, rim[1:-1], other, back[1:-1]])
    turn = np.radians(first)
    cosine, sine = np.cos(turn), np.sin(turn)
    loop = loop @ np.array([[cosine, sine], [-sine, cosine]])
    return shapely.Polygon(loop)


def _side(inner: float, outer: float, c: float, sagitta: float) -> FloatArray:
    """(n, 2) the side along the x-axis, from the inner arc to the outer one, corners included.

    A corner's circle has its centre c from the side and touches the side and the arc.
    """
    if c < NOTHING:
        return np.array([[inner, 0.0], [outer, 0.0]])
    ends = []
    for middle, from_side in ((inner + c, np.pi), (outer - c, 0.0)):
        touch = np.sqrt(max(middle**2 - c**2, 0.0))
        tangent = np.arctan2(c, touch) + from_side  # direction to where it touches the arc
        side = 1.5 * np.pi if from_side else -0.5 * np.pi
        first, last = sorted((tangent, side))
        ends.append(arc(c, first, last, sagitta) + np.array([touch, c]))
    return np.concatenate(ends)
