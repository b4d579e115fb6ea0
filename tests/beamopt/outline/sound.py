"""What must be true of every outline, whatever it was made of."""

import numpy as np
import pytest
import shapely

from beamopt.outline.faults import FaultKind, Severity
from beamopt.outline.outline import Chamber, Outline
from beamopt.section.grid import PolarGrid
from tests.beamopt.outline.necks import polygon_of


def chamber_polygon(chamber: Chamber) -> shapely.Polygon:
    return shapely.Polygon(chamber.exterior, chamber.holes)


def check_sound(outline: Outline, grid: PolarGrid) -> None:
    """Simple polygons, oriented and named, that share nothing and leave nothing out."""
    raw = outline.moments.raw
    assert np.isfinite(raw).all()
    assert np.isfinite(outline.smooth_moments.raw).all()
    assert outline.smooth_moments.raw[:, 0].sum() == pytest.approx(grid.area, rel=1e-9)
    assert all(str(fault) for fault in outline.faults)
    ranks = [list(Severity).index(fault.severity) for fault in outline.faults]
    assert ranks == sorted(ranks, reverse=True)
    if not outline.buildable:
        open_ones = {FaultKind.UNSEALED, FaultKind.INVALID, FaultKind.NO_MATERIAL}
        if open_ones & {fault.status for fault in outline.faults}:
            return
    material = [polygon_of(piece) for piece in outline.pieces]
    chambers = [chamber_polygon(chamber) for chamber in outline.chambers]
    everything = material + chambers
    assert shapely.is_valid(everything).all()
    whole = shapely.union_all(everything)
    assert whole.area == pytest.approx(sum(part.area for part in everything), rel=1e-9)
    digits = 1e-12 * grid.outer_radius**2  # of the two large areas that a thin ring is between
    assert raw[:, 0].sum() == pytest.approx(whole.area, rel=1e-9, abs=digits)
    assert len(shapely.get_parts(whole)) == 1
    expected = 1 if grid.is_full_ring and grid.inner_radius > 0 else 0
    assert len(shapely.get_parts(whole)[0].interiors) == expected
    # chambers touch material only: along their own loops, never each other
    for k, one in enumerate(chambers):
        assert all(one.disjoint(other) for other in chambers[:k])
    for piece in outline.pieces:
        assert shapely.LinearRing(piece.exterior.points).is_ccw
        assert not any(shapely.LinearRing(hole.points).is_ccw for hole in piece.holes)
        assert not any(loop.points.flags.writeable for loop in piece.loops)
    walls = {
        (loop.supply, frozenset(map(tuple, loop.points.tolist())))
        for piece in outline.pieces
        for loop in piece.loops
        if loop.supply
    }
    own = {
        (chamber.supply, frozenset(map(tuple, points.tolist())))
        for chamber in outline.chambers
        for points in (chamber.exterior, *chamber.holes)
    }
    assert walls == own
    areas = [piece.area for piece in outline.pieces]
    assert areas == sorted(areas, reverse=True)
