"""From the regions that supplies claim to chambers with skins, walls and rounded corners."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.outline.rays import thin_places
from beamopt.outline.ring import fine_sagitta, quad_segs, shrunk_ring
from beamopt.section.grid import PolarGrid
from beamopt.section.seal import SealRules

if TYPE_CHECKING:
    from shapely import Geometry, Polygon

__all__ = ["Region", "loops_of", "parts_of", "sealed_chambers"]

Region = tuple["Polygon", ...]
"""The chambers of one supply, apart from each other."""

ROUNDS = 12
"""Times that necks are cut; most sections need one or two, and what is left is named."""

MARGIN = 0.01
"""Share of a wall that a cut neck gets more than asked: flats of arcs may not make it one again."""

NARROWEST = 0.05
"""mm; channels narrower than twice this go even where no corner is rounded."""

LOCAL = 0.5
"""mm; in wider offsets no edge is longer: GEOS drops corners that stand out by a hundredth."""

CONTACT = 1e-3
"""mm; regions nearer to each other than this touch: no ray fits between them."""


def sealed_chambers(
    grid: PolarGrid,
    claimed: Sequence[Geometry],
    territory: Sequence[Geometry] | None,
    rules: SealRules,
) -> tuple[Region, ...]:
    """Chambers of supplies 1, 2, 3 that keep the rules.

    claimed : what each supply would like to have.
    territory : disjoint sets that hold the claims, or None: then walls between supplies are made
        by cutting alone.

    1. A chamber stays `skin` from every surface and half a wall from the edge of its territory.
    2. It is closed by half a wall: material within it that is thinner, between two of its parts,
       becomes chamber. Both bounds are erosions by at least that much or are kept by cutting with
       them, so neither skin nor walls suffer.
    3. It is opened by `rounding`, which rounds its corners and removes slivers.
    4. Where material is still thinner than a wall, a disc as wide as the wall is put there, and 3
       is done again. Chambers only shrink by that, so it comes to rest.
    """
    import shapely

    inside = shrunk_ring(grid, rules.skin)
    half = rules.wall / 2
    chambers = []
    for k, claim in enumerate(claimed):
        bound = inside
        if territory is not None and half > 0:
            bound = bound.intersection(_offset(territory[k], -half))
        elif territory is None:
            bound = bound.difference(shapely.union_all([*claimed[:k], *claimed[k + 1 :]]))
        chamber = claim.intersection(bound)
        if half > 0:
            chamber = _offset(_offset(chamber, half), -half).intersection(bound)
        chambers.append(chamber)
    if territory is None and half > 0:
        chambers = _parted(chambers, half)
    regions = [_opened(chamber, rules.rounding) for chamber in chambers]
    for _ in range(ROUNDS if half > 0 else 0):
        regions = _without_islands(regions, grid, rules)
        cut = _necks(regions, rules.wall)
        if cut is None:
            break
        regions = [
            _opened(shapely.MultiPolygon(region).difference(cut), rules.rounding)
            for region in regions
        ]
    regions = [
        tuple(part for part in region if part.area >= rules.smallest_chamber) for region in regions
    ]
    regions = _without_islands(regions, grid, rules)
    tolerance = fine_sagitta(grid) / 5  # drops the crumbs that cutting leaves on straight edges
    return tuple(tuple(shapely.simplify(part, tolerance) for part in region) for region in regions)


def _offset(geometry: Geometry, by: float, quarter: int | None = None) -> Geometry:
    if abs(by) > LOCAL:  # a short edge beside a long one would turn all of it
        geometry = geometry.segmentize(LOCAL)
    return geometry.buffer(by, quad_segs=quarter or quad_segs(abs(by)))


def _opened(geometry: Geometry, rounding: float) -> Region:
    """What a disc of radius `rounding` [mm] reaches from inside.

    Opening cuts off the vertices of arcs, by more the larger the disc: a large one comes back as a
    polygon of its area, and what that has beyond the circle reaches them.
    """
    if 0 < rounding <= LOCAL:
        return parts_of(_offset(_offset(geometry, -rounding), rounding))
    if rounding > 0:
        quarter = 3 * quad_segs(rounding) // 4  # so few that it reaches a fine sagitta beyond
        step = np.pi / 2 / quarter
        polygon = rounding * float(np.sqrt(step / np.sin(step)))
        back = _offset(_offset(geometry, -rounding), polygon, quarter)
        return parts_of(back.intersection(geometry))
    # mitred, so that corners stay sharp
    thinned = geometry.buffer(-NARROWEST, join_style="mitre")
    return parts_of(thinned.buffer(NARROWEST, join_style="mitre").intersection(geometry))


def _parted(chambers: Sequence[Geometry], half: float) -> list[Geometry]:
    """Chambers of different supplies cut back by half a wall where they touch."""
    near = [chamber.buffer(CONTACT) for chamber in chambers]
    for i in range(len(chambers)):
        for j in range(i):
            contact = near[i].intersection(near[j])
            if not contact.is_empty:
                wall = _offset(contact, half)
                chambers = [chamber.difference(wall) for chamber in chambers]
    return list(chambers)


def _necks(regions: Sequence[Region], wall: float) -> Geometry | None:
    """Discs that make every place where material is too thin as thick as a wall."""
    import shapely

    loops = [loop for region in regions for part in region for loop in loops_of(part)]
    thin = thin_places(loops, (1 - MARGIN / 4) * wall, spacing=wall / 6, opposed=0.5)
    if not thin.thickness.size:
        return None
    radius = (1 + MARGIN) / 2 * wall
    discs = shapely.buffer(shapely.points(thin.middle), radius, quad_segs=quad_segs(radius))
    return shapely.union_all(discs)  # many that overlap: far faster than one offset of all


def _without_islands(regions: Sequence[Region], grid: PolarGrid, rules: SealRules) -> list[Region]:
    """Holes of chambers filled, where only material stands in them that touches no surface."""
    import shapely

    if not rules.remove_islands:
        return list(regions)
    everything = shapely.MultiPolygon([part for region in regions for part in region])
    axis = shapely.Point(0, 0)
    filled = []
    for region in regions:
        parts = []
        for part in region:
            kept = []
            for hole in part.interiors:
                inside = shapely.Polygon(hole)
                on_inner_surface = grid.inner_radius > 0 and inside.contains(axis)
                if on_inner_surface or inside.intersection(everything).area > 0:
                    kept.append(hole)
            parts.append(shapely.Polygon(part.exterior, kept))
        filled.append(tuple(parts))
    return filled


def parts_of(geometry: Geometry) -> Region:
    """The polygons of a geometry, lines and points left out."""
    import shapely

    parts = shapely.get_parts(geometry)
    flat = [piece for part in parts for piece in shapely.get_parts(part)]
    return tuple(part for part in flat if part.geom_type == "Polygon" and part.area > 0)


def loops_of(polygon: Polygon) -> list[FloatArray]:
    """(n, 2) loops of a chamber [mm], material on their left."""
    import shapely

    turned = shapely.orient_polygons(polygon, exterior_cw=True)
    return [
        np.asarray(shapely.get_coordinates(ring))[:-1]
        for ring in (turned.exterior, *turned.interiors)
    ]
