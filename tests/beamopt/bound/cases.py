"""Targets to bound: of random sections, and some that no section has."""

from __future__ import annotations

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.bound.wanted import Wanted
from beamopt.rod.response import linear_response
from beamopt.section.cross_section import CrossSection
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.target.workspace import pressure_grid

GRID = PolarGrid(radial=32, angular=90)
LENGTH, YOUNG = 100.0, 300.0
PRESSURES = pressure_grid((0.0, 50.0, 100.0))


def random_section(seed: int, material: float = 0.6) -> CrossSection:
    rng = np.random.default_rng([seed, 7])
    return CrossSection.from_points(GRID, FeaturePoints.random(GRID, 40, rng, material))


def random_response(seed: int) -> FloatArray:
    return linear_response(random_section(seed).moments, YOUNG).matrix


def wanted(
    response: FloatArray,
    noise: float = 0.0,
    seed: int = 0,
    *,
    pressures: FloatArray = PRESSURES,
    weights: FloatArray | None = None,
    rest: tuple[float, float] = (0.0, 0.0),
) -> Wanted:
    """The tips of a response, each moved by a random distance of about `noise` [mm]."""
    weights = np.ones(len(pressures)) if weights is None else weights
    empty = np.zeros((len(pressures), 3))
    exact = Wanted(pressures, empty, weights, LENGTH, np.array(rest)).tips_of(response)
    moved = exact + noise * np.random.default_rng(seed).standard_normal(exact.shape)
    return Wanted(pressures, moved, weights, LENGTH, np.array(rest))


def bowl(depth: float = 30.0, width: float = 25.0) -> Wanted:
    """Tips on a bowl: three directions 120° apart, z falling with the square of the distance."""
    turns = np.radians([90.0, 210.0, 330.0])
    across = PRESSURES @ np.stack([np.cos(turns), np.sin(turns)], axis=1) * width / 100
    fallen = depth * (across**2).sum(axis=1) / width**2
    tips = np.column_stack([across, LENGTH - fallen + 0.1 * PRESSURES.sum(axis=1)])
    return Wanted(PRESSURES, tips, np.ones(27), LENGTH, np.zeros(2))
