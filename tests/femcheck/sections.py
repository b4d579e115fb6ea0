"""Sections to be meshed: three drawn chambers, thin walls, an island, and what no solid is of."""

import numpy as np

from beamopt.outline.build import build_outline
from beamopt.outline.outline import Outline
from beamopt.section.drawing import Circle, RingPiece, Shape
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.seal import SealRules

RULES = SealRules(skin=1.0, wall=0.9, rounding=0.5, smallest_chamber=3.0)
THREE: list[Shape] = [
    RingPiece(supply, (13, 22), (120 * (supply - 1) - 40, 120 * (supply - 1) + 40), 1.0)
    for supply in (1, 2, 3)
]


def three_chambers(sagitta: float = 0.04) -> Outline:
    return build_outline(PolarGrid(), THREE, RULES, sagitta)


def voronoi(seed: int) -> Outline:
    points = FeaturePoints.random(PolarGrid(), 70, np.random.default_rng(seed))
    return build_outline(PolarGrid(), points, RULES)


def thin_wall(wall: float) -> Outline:
    """Two chambers so near each other; the rules ask for no more."""
    half = np.degrees(wall / 2 / 17.5)
    shapes: list[Shape] = [
        RingPiece(1, (13, 22), (0, 60 - half), 1.0),
        RingPiece(2, (13, 22), (60 + half, 120), 1.0),
    ]
    return build_outline(PolarGrid(), shapes, SealRules(1.0, wall / 2, 0.2, 1.0), 0.04)


def island() -> Outline:
    """Material in the middle of a chamber: what a later drawing cuts out of it and is filled."""
    points = [(0.0, 0.0, 0)]
    points += [(17.5 + 3.5 * np.cos(a), 3.5 * np.sin(a), 1) for a in np.arange(0, 6.28, 0.5)]
    points += [(17.5, 0.0, 0)]
    points += [(17.5 * np.cos(a), 17.5 * np.sin(a), 0) for a in np.arange(0.7, 5.7, 0.4)]
    points += [(10.0, y, 0) for y in (-3.0, 0.0, 3.0)] + [(25.0, y, 0) for y in (-3.0, 0.0, 3.0)]
    x, y, kind = np.array(points).T
    source = FeaturePoints(x, y, kind.astype(np.uint8))
    return build_outline(PolarGrid(), source, SealRules(1.0, 0.9, 0.3, 1.0))


def two_pieces() -> Outline:
    """A chamber all the way round: a tube within a tube."""
    return build_outline(PolarGrid(), [RingPiece(1, (15, 20), (0, 360))], RULES)


def unsealed() -> Outline:
    return build_outline(PolarGrid(), [Circle(1, (24, 0), 4)], SealRules())
