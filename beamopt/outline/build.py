"""From a grid and feature points (or a drawing) to the outline of the section."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.outline.cells import regions as cell_regions
from beamopt.outline.cells import territories
from beamopt.outline.drawn import drawing_faults, drawn_regions, solid
from beamopt.outline.faults import Fault, FaultKind, worst_first
from beamopt.outline.inspection import (
    TOUCH,
    contacts,
    nearest,
    pinches,
    self_contacts,
    thicknesses,
    topology,
)
from beamopt.outline.outline import Chamber, Loop, Outline, Piece
from beamopt.outline.resampling import resample
from beamopt.outline.ring import USUAL_RADIUS, fine_sagitta, ring_polygon, usual_sagitta
from beamopt.outline.smoothing import Region, loops_of, parts_of, sealed_chambers
from beamopt.section.cell_owners import points_with_cells
from beamopt.section.drawing import Circle, Shape
from beamopt.section.feature_points import MATERIAL, SUPPLIES, FeaturePoints
from beamopt.section.grid import THINNEST, PolarGrid
from beamopt.section.moments import Moments
from beamopt.section.seal import SealRules

if TYPE_CHECKING:
    from shapely import Geometry, Polygon

__all__ = ["SLACK", "build_outline"]

SLACK = 0.02
"""mm at an outer radius of 25; skins, walls and necks may be thinner than asked by this and twice
the sagitta: vertices of both sides stand out into them by up to one sagitta each."""

LATTICE = 2.0**-31  # mm; lengths at the usual radius are rounded to this: the same at any size
SAME = 1e-6  # of an area: two that differ by less are one
APART = 2.0**-21  # mm; points nearer to each other are one vertex
TRIES = 4  # at resampling, each with a quarter of the sagitta


def build_outline(
    grid: PolarGrid,
    source: FeaturePoints | Sequence[Shape],
    rules: SealRules,
    sagitta: float | None = None,
    *,
    inspected: bool = True,
) -> Outline:
    """The section of feature points or of a drawing as polygons, sealed where `rules` are.

    Without a skin nothing is changed: chambers are the Voronoi cells or the drawn shapes as they
    are, clipped to the ring, and `rules.wall` is only checked.

    Where the polygons can not be made, the outline is empty and its only fault is
    `FaultKind.INVALID`.

    Edges are straight; the polygons that stand for curves have the curves' area. All is done in a
    section of 25 mm outer radius and then scaled, so that a section has one shape at every size.

    sagitta : how far edges may be from the smooth outline [mm]; less where walls are thin. None
        takes 0.0016 of the outer radius: 0.04 mm at 25 mm.
    inspected : whether skins, walls and necks of the polygons are measured.

    Raises
    ------
    ValueError : a feature point that has a cell is farther than 4·10⁶ outer radii from the axis, or
        the sagitta is not positive.
    """
    size = grid.outer_radius / USUAL_RADIUS
    sagitta = usual_sagitta(grid) if sagitta is None else sagitta
    if not 0 < sagitta < np.inf:
        raise ValueError(f"sagitta = {sagitta}: must be above 0 mm")
    if isinstance(source, FeaturePoints):
        source = points_with_cells(grid, source)
    from shapely.errors import GEOSException

    usual = _at_usual_size(grid, source, rules, size)
    try:
        return _build(*usual, sagitta / size, inspected).scaled(size)
    except GEOSException:  # polygons that touch in a way that their overlay can not resolve
        nothing = Moments(np.zeros((1 + len(SUPPLIES), 6)))
        return Outline((), (), (Fault(FaultKind.INVALID),), nothing, grid.outer_radius)


def _at_usual_size(
    grid: PolarGrid, source: FeaturePoints | Sequence[Shape], rules: SealRules, size: float
) -> tuple[PolarGrid, FeaturePoints | Sequence[Shape], SealRules]:
    """The same section with an outer radius of 25 mm; lengths rounded, so that sizes agree."""
    inner, skin, wall, rounding = (
        _usual(length, size)
        for length in (grid.inner_radius, rules.skin, rules.wall, rules.rounding)
    )
    thinnest = USUAL_RADIUS - THINNEST * USUAL_RADIUS
    ring = replace(grid, inner_radius=min(inner, thinnest), outer_radius=USUAL_RADIUS)
    area = rules.smallest_chamber / size**2
    usual = SealRules(skin, wall, rounding, area, rules.remove_islands)
    if isinstance(source, FeaturePoints):
        x, y = (np.rint(a / size / LATTICE) * LATTICE for a in (source.x, source.y))
        return ring, FeaturePoints(x, y, source.type), usual
    return ring, [_usual_shape(shape, size) for shape in source], usual


def _usual(length: float, size: float) -> float:
    return round(length / size / LATTICE) * LATTICE


def _usual_shape(shape: Shape, size: float) -> Shape:
    if isinstance(shape, Circle):
        x, y = (_usual(value, size) for value in shape.center)
        return Circle(shape.supply, (x, y), max(_usual(shape.radius, size), LATTICE))
    inner, outer = (_usual(radius, size) for radius in shape.r)
    corner = min(_usual(shape.corner, size), max(outer - inner, LATTICE) / 2)
    return replace(shape, r=(inner, max(outer, inner + LATTICE)), corner=corner)


def _build(
    grid: PolarGrid,
    source: FeaturePoints | Sequence[Shape],
    rules: SealRules,
    sagitta: float,
    inspected: bool,
) -> Outline:
    import shapely

    ring = ring_polygon(grid)
    smooth = _smooth(grid, source, rules, ring)
    moments = _smooth_moments(grid, smooth)
    faults = contacts(smooth, ring)
    if not (rules.sealed and rules.wall > TOUCH):  # else cut, as thick as a wall
        faults += self_contacts(smooth)
    if not (rules.sealed or isinstance(source, FeaturePoints)):
        faults += pinches(smooth)
    notices = (
        []
        if isinstance(source, FeaturePoints)
        else drawing_faults(source, ring, fine_sagitta(grid), smooth)
    )
    if faults:
        # arcs of chambers along surfaces leave crescents that are no material
        pieces = tuple(
            piece
            for piece in _pieces(ring, smooth)
            if 2 * piece.area > TOUCH * shapely.length(shapely.LinearRing(piece.exterior.points))
        )
        faults += topology(pieces, smooth) + notices
        chambers = _chambers(smooth)
        return Outline(pieces, chambers, worst_first(faults), moments, grid.outer_radius)
    # an eighth of the thinnest wall, so that chords of its two sides can not meet
    fine = min(sagitta, nearest(smooth, ring, 8 * sagitta) / 8)
    if grid.inner_radius > 0:
        fine = min(fine, (grid.outer_radius - grid.inner_radius) / 8)
    for _ in range(TRIES):
        coarse_ring = _resampled(ring, fine)
        regions = tuple(tuple(_resampled(part, fine) for part in region) for region in smooth)
        if _is_sound(coarse_ring, regions):
            break
        fine /= 4
    else:
        faults = [Fault(FaultKind.INVALID)]
    pieces = _pieces(coarse_ring, regions)
    if inspected:
        faults += thicknesses(regions, coarse_ring, rules, 2 * fine + SLACK)
    faults += topology(pieces, regions) + notices
    chambers = _chambers(regions)
    return Outline(pieces, chambers, worst_first(faults), moments, grid.outer_radius)


def _smooth(
    grid: PolarGrid, source: FeaturePoints | Sequence[Shape], rules: SealRules, ring: Polygon
) -> tuple[Region, ...]:
    extent = 4 * grid.outer_radius + 2 * rules.wall
    claimed: tuple[Geometry, ...]
    if isinstance(source, FeaturePoints):
        claimed = cell_regions(source, extent)
    else:
        claimed = drawn_regions(source, fine_sagitta(grid))
    if not rules.sealed and isinstance(source, FeaturePoints):
        return tuple(parts_of(claim.intersection(ring)) for claim in claimed)
    if not rules.sealed:
        fine = fine_sagitta(grid)
        return tuple(parts_of(solid(claim.intersection(ring), fine)) for claim in claimed)
    territory = territories(source, extent) if isinstance(source, FeaturePoints) else None
    return sealed_chambers(grid, claimed, territory, rules)


def _smooth_moments(grid: PolarGrid, smooth: Sequence[Region]) -> Moments:
    """Chambers as they are; material is what they leave of the ring, whose moments are exact."""
    raw = np.zeros((1 + len(SUPPLIES), 6))
    for chamber in _chambers(smooth):
        raw[chamber.supply] += chamber.integrals
    radial = grid.radial_integrals.sum(axis=1)[[0, 1, 1, 2, 2, 2]]
    raw[MATERIAL] = radial * grid.angular_integrals[-1] - raw[1:].sum(axis=0)
    return Moments(raw)


def _resampled(polygon: Polygon, sagitta: float) -> Polygon:
    import shapely

    # every loop the same way round, so that equal loops get equal vertices
    loops = [loop[::-1] for loop in loops_of(polygon)]
    exterior, *holes = (resample(loop, sagitta) for loop in loops)
    return shapely.Polygon(exterior, holes)


def _is_sound(ring: Polygon, regions: Sequence[Region]) -> bool:
    """Whether every polygon is simple, lies within the ring and touches no other."""
    import shapely

    parts = np.array([part for region in regions for part in region], dtype=object)
    if not (ring.is_valid and shapely.is_valid(parts).all()):
        return False
    if not parts.size:
        return True
    first, second = shapely.STRtree(parts).query(parts, predicate="intersects")
    return bool((first == second).all() and ring.contains_properly(parts).all())


def _chambers(regions: Sequence[Region]) -> tuple[Chamber, ...]:
    chambers = []
    for supply, region in zip(SUPPLIES, regions, strict=True):
        for part in sorted(region, key=lambda part: -part.area):
            exterior, *holes = (_locked(loop[::-1]) for loop in loops_of(part))
            chambers.append(Chamber(supply, exterior, tuple(holes)))
    return tuple(chambers)


def _locked(points: FloatArray) -> FloatArray:
    points = np.ascontiguousarray(points)
    points.setflags(write=False)
    return points


def _key(point: Sequence[float]) -> tuple[int, ...]:
    return tuple(round(value / APART) for value in point)


def _pieces(ring: Polygon, regions: Sequence[Region]) -> tuple[Piece, ...]:
    """What chambers leave of the ring, each loop named after the chamber that its points are of."""
    import shapely

    parts = [part for region in regions for part in region]
    chambers = shapely.union_all(parts)
    area = sum(part.area for part in parts)
    if abs(chambers.area - area) > SAME * area:
        # without a grid GEOS may lose one of several that touch within a rounding
        chambers = shapely.union_all(parts, grid_size=LATTICE)
    material = parts_of(ring.difference(chambers))
    owner = {
        _key(point): supply
        for supply, region in zip(SUPPLIES, regions, strict=True)
        for part in region
        for point in shapely.get_coordinates(part).tolist()
    }
    pieces = []
    for polygon in sorted(material, key=lambda polygon: -polygon.area):
        loops = []
        for points in (loop[::-1] for loop in loops_of(polygon)):
            owners = {owner.get(_key(point), MATERIAL) for point in points.tolist()}
            loops.append(Loop(_locked(points), owners.pop() if len(owners) == 1 else MATERIAL))
        pieces.append(Piece(loops[0], tuple(loops[1:])))
    return tuple(pieces)
