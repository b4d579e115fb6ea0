"""Every rule of a seal on the final polygons: held within what straight edges take, or named."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from beamopt.outline.build import build_outline
from beamopt.outline.faults import FaultKind
from beamopt.outline.outline import Outline
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.seal import SealRules

GRID = PolarGrid()
SAGITTA = 0.04  # mm
RULES = [
    SealRules(1.0, 0.9, 0.5, 3.0, True),
    SealRules(1.5, 1.0, 1.0, 5.0, True),
    SealRules(0.3, 0.3, 0.2, 1.0, True),
]


def outlines(rules: SealRules) -> list[Outline]:
    return [
        build_outline(GRID, FeaturePoints.random(GRID, 60, np.random.default_rng([4, k])), rules)
        for k in range(10)
    ]


def polygons(outline: Outline) -> list[shapely.Polygon]:
    return [shapely.Polygon(one.exterior, one.holes) for one in outline.chambers]


@pytest.mark.parametrize("rules", RULES, ids=str)
def test_rules_hold_on_the_final_polygons(rules: SealRules) -> None:
    for outline in outlines(rules):
        named = {fault.status for fault in outline.faults}
        chambers = polygons(outline)
        places = shapely.get_coordinates(chambers)
        inner = min(one.exterior.distance(shapely.Point(0, 0)) for one in chambers)
        skin = min(25 - np.hypot(*places.T).max(), inner - 10)
        assert skin > rules.skin - 1.05 * SAGITTA or FaultKind.SKIN in named
        walls = [one.distance(other) for k, one in enumerate(chambers) for other in chambers[:k]]
        thin = {FaultKind.WALL, FaultKind.NECK} & named
        assert min(walls) > rules.wall - 2.1 * SAGITTA or thin
        assert min(one.area for one in outline.chambers) > 0.999 * rules.smallest_chamber
        for one in chambers:
            radius = 0.9 * rules.rounding
            opened = one.buffer(-radius, quad_segs=16).buffer(radius, quad_segs=16)
            corners = shapely.points(shapely.get_coordinates(one))
            assert shapely.distance(opened, corners).max() < 1.5 * SAGITTA
