"""Sections that nobody would draw, to break the outline with."""

from collections.abc import Iterator

import numpy as np

from beamopt.section.drawing import Circle, RingPiece, Shape
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.seal import SealRules

RING = PolarGrid()
RULES = SealRules(1.0, 0.9, 0.5, 3.0, True)
Case = tuple[str, PolarGrid, FeaturePoints | list[Shape], SealRules]

GRIDS = {
    "ring": RING,
    "disc": PolarGrid(0.0, 25.0),
    "half": PolarGrid(10.0, 25.0, 16, 30, 20.0, 200.0),
    "pie": PolarGrid(0.0, 25.0, 16, 30, 0.0, 300.0),
    "slit": PolarGrid(10.0, 25.0, 16, 30, 0.0, 359.999),
    "wedge": PolarGrid(10.0, 25.0, 16, 30, 10.0, 11.0),
    "thin": PolarGrid(24.0, 25.0),
    "thinnest": PolarGrid(25.0 - 2.5e-5, 25.0),
    "small": PolarGrid(0.1, 0.25, 4, 8),
    "large": PolarGrid(400.0, 1000.0),
    "coarse": PolarGrid(10.0, 25.0, 1, 1),
}
EXTREME = {
    "no rule": SealRules(),
    "only skin": SealRules(skin=0.5),
    "only wall": SealRules(wall=0.9),
    "hair skin": SealRules(0.001, 0.001, 0.0),
    "sharp": SealRules(1.0, 0.9, 0.0),
    "fat wall": SealRules(1.0, 8.0, 0.5),
    "fat skin": SealRules(7.6, 0.9, 0.5),
    "fat corners": SealRules(1.0, 0.9, 6.0),
    "giant": SealRules(1e3, 1e3, 1e3),
    "wall below rounding": SealRules(0.2, 0.1, 2.0, 0.0, True),
    "wall far above rounding": SealRules(0.5, 4.0, 0.01),
    "nothing is large enough": SealRules(1.0, 0.9, 0.5, 1e6),
    "islands stay": SealRules(1.0, 0.9, 0.5, 0.0, False),
}


def random_points(grid: PolarGrid, count: int, seed: int, material: float = 0.5) -> FeaturePoints:
    return FeaturePoints.random(grid, count, np.random.default_rng(seed), material)


def hostile_cases() -> Iterator[Case]:
    """A hundred and more: sets of points, grids, rules, drawings."""
    for name, points in POINTS.items():
        for rules in (RULES, EXTREME["islands stay"], SealRules()):
            yield f"points: {name}, skin {rules.skin:g}", RING, points, rules
    for name, grid in GRIDS.items():
        for seed in range(3):
            yield f"grid: {name} {seed}", grid, random_points(grid, 60, seed), RULES
        yield f"grid: {name}, tiny skin", grid, random_points(grid, 30, 3), EXTREME["hair skin"]
    for name, rules in EXTREME.items():
        yield f"rules: {name}", RING, random_points(RING, 80, 5), rules
        yield f"rules: {name}, half", GRIDS["half"], random_points(GRIDS["half"], 80, 6), rules
        yield f"rules: {name}, drawn", RING, DRAWINGS["crowd"], rules
    for name, drawing in DRAWINGS.items():
        yield f"drawing: {name}", RING, drawing, RULES
        yield f"drawing: {name}, unsealed", RING, drawing, SealRules()


def _ring_of_points(kinds: list[int], radii: tuple[float, ...]) -> FeaturePoints:
    """Circles of 24 points, circle k of type kinds[k]: annular cells."""
    phi = np.arange(24) * 2 * np.pi / 24
    x = np.concatenate([radius * np.cos(phi) for radius in radii])
    y = np.concatenate([radius * np.sin(phi) for radius in radii])
    return FeaturePoints(x, y, np.repeat(kinds, 24))


def _lattice(count: int, kinds: int) -> FeaturePoints:
    x, y = (a.ravel() for a in np.meshgrid(*2 * [np.linspace(-24, 24, count)]))
    return FeaturePoints(x, y, np.arange(x.size) % kinds)


_rng = np.random.default_rng(11)
_angle = _rng.uniform(0, 2 * np.pi, 90)
_fan = np.linspace(0, 2 * np.pi, 300, endpoint=False)

POINTS = {
    "none": FeaturePoints([], [], []),
    "one of material": FeaturePoints([1], [2], [0]),
    "one of a chamber": FeaturePoints([15], [2], [1]),
    "two": FeaturePoints([15, -15], [2, 0], [1, 2]),
    "two in one place": FeaturePoints([15, 15], [2, 2], [1, 2]),
    "two a picometre apart": FeaturePoints([15, 15 + 1e-9], [2, 2], [1, 2]),
    "two a hair apart": FeaturePoints([15, 15 + 1e-4], [2, 2], [1, 2]),
    "all in one place": FeaturePoints([5] * 9, [5] * 9, [1, 2, 3] * 3),
    "on a line": FeaturePoints(np.linspace(-25, 25, 40), np.zeros(40), np.arange(40) % 4),
    "on a circle": FeaturePoints(17 * np.cos(_fan), 17 * np.sin(_fan), np.arange(300) % 4),
    "hair-thin cells": FeaturePoints(
        _rng.normal(17, 0.01, 90), _rng.normal(0, 0.01, 90), np.arange(90) % 4
    ),
    "a lattice": _lattice(12, 4),
    "a fine lattice": _lattice(30, 3),
    "all of one supply": random_points(RING, 60, 1).with_types(np.ones(60, dtype=np.uint8)),
    "all of material": random_points(RING, 60, 2).with_types(np.zeros(60, dtype=np.uint8)),
    "no material": random_points(RING, 90, 3, 0.0),
    "hardly any material": random_points(RING, 90, 4, 0.03),
    "an annular chamber": _ring_of_points([0, 2, 0], (12.0, 17.5, 23.0)),
    "annular chambers": _ring_of_points([1, 2, 3], (12.0, 17.5, 23.0)),
    "an annulus and points": _ring_of_points([0, 1], (12.0, 24.0)),
    "far outside": FeaturePoints(1e5 * np.cos(_angle), 1e5 * np.sin(_angle), np.arange(90) % 4),
    "some far outside": FeaturePoints(
        np.concatenate([17 * np.cos(_angle), [9e5, -3e3]]),
        np.concatenate([17 * np.sin(_angle), [-9e5, 40.0]]),
        np.arange(92) % 4,
    ),
    "in the hole": FeaturePoints(4 * np.cos(_angle), 4 * np.sin(_angle), np.arange(90) % 4),
    "many": random_points(RING, 400, 5),
}

DRAWINGS: dict[str, list[Shape]] = {
    "nothing": [],
    "three pieces": [RingPiece(k + 1, (13, 22), (120 * k, 120 * k + 80)) for k in range(3)],
    "a whole ring": [RingPiece(1, (13, 22), (0, 360))],
    "over everything": [RingPiece(2, (0, 40), (0, 360))],
    "to the surface": [RingPiece(1, (10, 22), (0, 80)), RingPiece(2, (13, 25), (120, 200))],
    "side by side": [RingPiece(k + 1, (13, 22), (100 * k, 100 * k + 100)) for k in range(3)],
    "one supply side by side": [RingPiece(1, (13, 22), (100 * k, 100 * k + 100)) for k in range(3)],
    "circles that overlap": [Circle(k % 3 + 1, (17 - k, 3.0 * k), 4.0) for k in range(5)],
    "circles that touch": [Circle(1, (17, 0), 3.0), Circle(1, (17, 6), 3.0)],
    "circles that nearly touch": [Circle(1, (17, 0), 3.0), Circle(1, (17, 6.05), 3.0)],
    "a circle in a circle": [Circle(1, (17, 0), 5.0), Circle(2, (17, 0), 2.0)],
    "rounded to a circle": [RingPiece(1, (13, 22), (0, 80), 4.5)],
    "corners that only just fit": [
        Circle(2, (10.0, -21.0), 20.0),
        Circle(1, (-7.0, 21.0), 20.0),
        RingPiece(2, (2.2, 14.6), (-180.0, 0.0), 6.199999999999999),
    ],
    "a row of circles that touch": [Circle(k % 3 + 1, (17.0 - 4 * k, 0.0), 2.0) for k in range(8)],
    "from the axis": [RingPiece(1, (0, 22), (0, 270), 3.0)],
    "outside": [Circle(3, (60, 0), 10.0)],
    "enormous": [Circle(3, (1e6, 0), 1e6 - 15)],
    "crowd": [
        Circle(int(kind), (float(r * np.cos(phi)), float(r * np.sin(phi))), float(size))
        for kind, r, phi, size in zip(
            _rng.integers(1, 4, 30),
            _rng.uniform(11, 24, 30),
            _angle,
            _rng.uniform(0.5, 4, 30),
            strict=False,
        )
    ],
}
