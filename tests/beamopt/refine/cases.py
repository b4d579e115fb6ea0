"""Grids, sections and judges that the tests of refining share, and exact moments to compare."""

from functools import lru_cache

import numpy as np
import shapely

from beamopt.base.arrays import FloatArray
from beamopt.judge.judge import Judge
from beamopt.outline.cells import _cells
from beamopt.outline.green import loop_integrals
from beamopt.refine.truth import Judged, View, judged_on
from beamopt.scene.scene import Scene, load_scene
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid

ARC_VERTICES = 40_000  # of a full circle; chords are then 10⁻⁷ mm off
SMALL = ("grid.radial=32", "grid.angular=90", "section.feature_points=25")


def points_of(*rows: tuple[float, float, int]) -> FeaturePoints:
    return FeaturePoints(*zip(*rows, strict=True))


def scattered(grid: PolarGrid, count: int, seed: int) -> FeaturePoints:
    """Points anywhere around the ring, some of them outside of it."""
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(-1.2, 1.2, (2, count)) * grid.outer_radius
    return FeaturePoints(x, y, rng.integers(0, 4, count))


def domain_polygon(grid: PolarGrid, skin: float = 0.0) -> shapely.Polygon:
    """The ring or sector as a polygon; narrowed by `skin` on its round surfaces."""
    outer, hole = grid.outer_radius - skin, grid.inner_radius > 0
    inner = grid.inner_radius + skin if hole else 0.0
    turns = max(2, round(ARC_VERTICES * grid.span / 360))
    angle = np.radians(grid.start + np.linspace(0, grid.span, turns + 1))
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    if grid.is_full_ring:
        return shapely.Polygon(outer * circle, [inner * circle] if hole else [])
    inside = inner * circle[::-1] if hole else np.zeros((1, 2))
    return shapely.Polygon(np.concatenate([outer * circle, inside]))


def exact_moments(points: FeaturePoints, domain: shapely.Polygon) -> FloatArray:
    """(4, 6) moments of every type: each cell as a polygon, clipped to the domain."""
    raw = np.zeros((4, 6))
    cells = _cells(points.x, points.y, 100.0 * max(domain.bounds))
    for cell, kind in zip(cells, points.type, strict=True):
        if len(cell) < 3:
            continue
        clipped = shapely.orient_polygons(shapely.Polygon(cell).intersection(domain))
        for part in shapely.get_parts(clipped):
            if part.area > 0:
                for loop in (part.exterior, *part.interiors):
                    raw[kind] += loop_integrals(shapely.get_coordinates(loop)[:-1])
    return raw


@lru_cache
def scene_of(name: str, *overrides: str) -> Scene:
    return load_scene(name, overrides)


@lru_cache
def judge_of(name: str = "random-section", *overrides: str) -> Judge:
    scene = scene_of(name, *(overrides or SMALL))
    return Judge.of_scene(scene, scene.load_target())


def random_points(seed: int, name: str = "random-section", *overrides: str) -> FeaturePoints:
    return scene_of(name, *(overrides or SMALL)).random_points(np.random.default_rng(seed))


def judged(judge: Judge, points: FeaturePoints, view: View = View.RASTER) -> Judged:
    return judged_on(judge, view)(points)
