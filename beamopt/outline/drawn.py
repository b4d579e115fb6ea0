"""Drawn chambers as polygons, their arcs as fine as the smooth outline's."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from beamopt.arrays import FloatArray
from beamopt.outline.ring import arc, circle
from beamopt.section.drawing import Circle, RingPiece, Shape
from beamopt.section.feature_points import SUPPLIES
from beamopt.section.grid import angle_between

if TYPE_CHECKING:
    from shapely import Geometry, Polygon

__all__ = ["drawn_regions"]


NOTHING = 1e-6  # mm; radii below it have no arc


def drawn_regions(shapes: Sequence[Shape], sagitta: float) -> tuple[Geometry, ...]:
    """For supplies 1, 2, 3 what is drawn of them; a later shape covers an earlier one."""
    import shapely

    drawn = {supply: shapely.Polygon() for supply in SUPPLIES}
    for shape in shapes:
        polygon = _circle(shape, sagitta) if isinstance(shape, Circle) else _piece(shape, sagitta)
        for supply in SUPPLIES:
            drawn[supply] = (
                drawn[supply].union(polygon)
                if supply == shape.supply
                else drawn[supply].difference(polygon)
            )
    return tuple(drawn[supply] for supply in SUPPLIES)


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
