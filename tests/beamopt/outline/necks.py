"""Thin material found another way than the package does: by pairs of places, not by rays."""

import numpy as np
import shapely
from scipy.spatial import cKDTree

from beamopt.base.arrays import FloatArray
from beamopt.outline.outline import Outline, Piece

SPACING = 0.06


def polygon_of(piece: Piece) -> shapely.Polygon:
    return shapely.Polygon(piece.exterior.points, [hole.points for hole in piece.holes])


def thinnest(outline: Outline, reach: float) -> tuple[float, FloatArray]:
    """Least length [mm] of a straight way through material from one place of the chambers' walls
    to another one that is far from it along them, or `reach`; and its middle.
    """
    places, at, loop_of, lengths = [], [], [], []
    for piece in outline.pieces:
        for loop in piece.loops:
            if loop.supply == 0:
                continue
            ring = shapely.LinearRing(loop.points)
            count = int(np.ceil(ring.length / SPACING))
            along = np.arange(count) * ring.length / count
            # vertices as well: the convex ones of chambers are nearest to what is across
            along = np.union1d(along, shapely.line_locate_point(ring, shapely.points(loop.points)))
            places.append(shapely.get_coordinates(shapely.line_interpolate_point(ring, along)))
            at.append(along)
            loop_of.append(np.full(len(along), len(lengths)))
            lengths.append(ring.length)
    if not places:
        return reach, np.zeros(2)
    xy, s, own = (np.concatenate(part) for part in (places, at, loop_of))
    i, j = cKDTree(xy).query_pairs(reach, output_type="ndarray").T
    apart = np.abs(s[i] - s[j])
    way = np.where(own[i] == own[j], np.minimum(apart, np.array(lengths)[own[i]] - apart), np.inf)
    far = way > 2.2 * reach
    i, j = i[far], j[far]
    length = np.hypot(*(xy[i] - xy[j]).T)
    material = shapely.union_all([polygon_of(piece) for piece in outline.pieces])
    shapely.prepare(material)
    inside = np.ones(len(i), dtype=np.bool_)
    for share in (0.1, 0.5, 0.9):
        inside &= shapely.contains_xy(material, *(xy[i] + share * (xy[j] - xy[i])).T)
    if not inside.any():
        return reach, np.zeros(2)
    k = np.flatnonzero(inside)[np.argmin(length[inside])]
    return float(length[k]), (xy[i[k]] + xy[j[k]]) / 2
