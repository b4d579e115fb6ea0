"""Invariances: what is done to a section is done to its tips."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from beamopt.rod.arc import arc_tips
from beamopt.rod.response import linear_response
from beamopt.section.cross_section import CrossSection
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.target.workspace import pressure_grid
from tests.validation.check import Check, Row

GRID = PolarGrid()
PRESSURES = pressure_grid((0.0, 50.0, 100.0))

TOLERANCE = 1e-9
"""Relative to the actuator's length; rounding of rotated positions is all that is left."""


def tips(points: FeaturePoints, youngs_modulus: float = 300.0, scale: float = 1.0) -> np.ndarray:
    moments = CrossSection.from_points(GRID, points).moments
    strains = linear_response(moments, youngs_modulus).strains(scale * PRESSURES)
    return arc_tips(strains, 100.0)


def rotated(points: FeaturePoints, columns: int) -> float:
    """Largest distance between the tips of the rotated section and the rotated tips."""
    angle = columns * 2 * np.pi / GRID.angular
    c, s = np.cos(angle), np.sin(angle)
    turned = FeaturePoints(c * points.x - s * points.y, s * points.x + c * points.y, points.type)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    return _farthest(tips(turned), tips(points) @ turn.T)


def mirrored(points: FeaturePoints) -> float:
    flipped = FeaturePoints(points.x, -points.y, points.type)
    return _farthest(tips(flipped), tips(points) * (1, -1, 1))


def permuted(points: FeaturePoints, order: tuple[int, int, int]) -> float:
    """Supply k becomes supply order[k]: its pressure is then read from that column."""
    renamed = points.with_types(np.array([0, *order], dtype=np.uint8)[points.type])
    moments = CrossSection.from_points(GRID, renamed).moments
    columns = np.argsort(order)
    strains = linear_response(moments, 300.0).strains(PRESSURES[:, columns])
    return _farthest(arc_tips(strains, 100.0), tips(points))


def stiffened(points: FeaturePoints) -> float:
    return _farthest(tips(points, 600.0, 2.0), tips(points))


def _farthest(a: np.ndarray, b: np.ndarray) -> float:
    """Largest distance of two sets of tips over the actuator's length."""
    return float(np.linalg.norm(a - b, axis=1).max() / 100)


def random_points(seed: int) -> FeaturePoints:
    rng = np.random.default_rng([seed])
    return FeaturePoints.random(GRID, int(rng.choice([3, 30, 100])), rng)


def checks(full: bool) -> list[Check]:
    designs = 500 if full else 20

    def worst(name: str, measure: Callable[[FeaturePoints, np.random.Generator], float]) -> Check:
        def rows() -> Iterator[Row]:
            differences = [
                measure(random_points(seed), np.random.default_rng([seed, 1]))
                for seed in range(designs)
            ]
            what = f"{name}, worst of {designs} designs, relative to the length"
            yield Row(what, "invariance", 0.0, max(differences), TOLERANCE)

        return Check(name, rows)

    return [
        worst(
            "rotating by whole columns rotates the tips", lambda p, g: rotated(p, g.integers(360))
        ),
        worst("mirroring mirrors the tips", lambda p, g: mirrored(p)),
        worst(
            "permuting supplies permutes the tips",
            lambda p, g: permuted(p, tuple(int(k) + 1 for k in g.permutation(3))),
        ),
        worst("twice E at twice P changes nothing", lambda p, g: stiffened(p)),
    ]
