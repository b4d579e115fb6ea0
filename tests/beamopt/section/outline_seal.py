"""The rules of a sealed section carried out on polygons: what the raster is an approximation of."""

from __future__ import annotations

import numpy as np
import shapely
from shapely import Geometry, MultiPoint, Point, Polygon

from beamopt.base.arrays import FloatArray
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.seal import SealRules

QUARTER = 64  # segments of a quarter circle
FAR = 400.0  # mm


def ring(grid: PolarGrid, skin: float = 0.0) -> Geometry:
    """The ring or sector [mm], less a skin on all its surfaces."""
    outer = Point(0, 0).buffer(grid.outer_radius - skin, quad_segs=QUARTER * 4)
    if grid.inner_radius > 0:
        outer -= Point(0, 0).buffer(grid.inner_radius + skin, quad_segs=QUARTER * 4)
    if grid.is_full_ring:
        return outer
    phi = np.radians(np.linspace(grid.start, grid.start + grid.span, 200))
    arc = FAR * np.stack([np.cos(phi), np.sin(phi)], axis=1)
    return outer & Polygon([(0.0, 0.0), *arc]).buffer(-skin, join_style="mitre")


def regions(points: FeaturePoints) -> list[Geometry]:
    """Union of the Voronoi cells of each type 0…3, far beyond the ring."""
    box = shapely.box(-FAR, -FAR, FAR, FAR)
    positions = np.stack([points.x, points.y], axis=1)
    if len(positions) == 1:
        cells = [box]
    else:
        many = shapely.voronoi_polygons(MultiPoint(positions), extend_to=box)
        cells = [cell & box for cell in shapely.get_parts(many)]
    tree = shapely.STRtree(cells)
    found = [cells[tree.query(Point(*at), "within")[0]] for at in positions]
    return [
        shapely.union_all([c for c, t in zip(found, points.type, strict=True) if t == kind])
        for kind in range(4)
    ]


def sealed_chambers(grid: PolarGrid, points: FeaturePoints, rules: SealRules) -> list[Geometry]:
    """Chambers of supplies 1, 2, 3 after skin, wall, closing and opening; nothing is filled."""
    every = np.asarray(points.type)
    chambers = FeaturePoints(*(part[every > 0] for part in (points.x, points.y, every)))
    drawn, owned = regions(points), regions(chambers)
    found = []
    for supply in (1, 2, 3):
        free = ring(grid, rules.skin)
        if rules.wall:
            free &= owned[supply].buffer(-rules.wall / 2, quad_segs=QUARTER)
        chamber = drawn[supply] & free
        if rules.wall:
            chamber = _moved(_moved(chamber, rules.wall / 2), -rules.wall / 2) & free
        if rules.rounding:
            chamber = _moved(_moved(chamber, -rules.rounding), rules.rounding)
        found.append(chamber)
    return found


def _moved(shape: Geometry, distance: float) -> Geometry:
    return shape.buffer(distance, quad_segs=QUARTER)


def first_moments(shape: Geometry) -> FloatArray:
    """Area [mm²] and first moments about the axis [mm³]."""
    c = shape.centroid
    return np.array([shape.area, shape.area * c.x, shape.area * c.y]) if shape.area else np.zeros(3)
