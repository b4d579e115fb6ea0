"""How near a sealed raster's areas are to its outline's: the figures that README.md states."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.outline.build import build_outline
from beamopt.scene.design import load_design
from beamopt.scene.scene import load_scene
from beamopt.section.cross_section import CrossSection

FOUND = Path(__file__).parents[2] / "data" / "sealed_designs"


@cache
def random_areas() -> FloatArray:
    """(40, 2, 3) chamber areas of random sections in raster and outline [mm²]."""
    scene = load_scene("sealed-section")
    grid, rules = scene.grid.build(), scene.seal.rules
    areas = []
    for seed in range(40):
        points = scene.random_points(np.random.default_rng([15, seed]))
        raster = CrossSection.from_points(grid, points, 0, rules)
        outline = build_outline(grid, points, rules, inspected=False)
        areas.append([raster.moments.chamber_areas, outline.moments.chamber_areas])
    return np.array(areas)


def test_sums_over_random_sections() -> None:
    raster, outline = random_areas().sum(axis=(0, 2))
    assert abs(raster / outline - 1) < 0.001


def test_a_supply_of_one_random_section() -> None:
    """A chamber of about the smallest area may be filled in one view and not in the other."""
    raster, outline = random_areas().swapaxes(0, 1)
    off = np.abs(raster / outline - 1).reshape(-1)
    assert np.median(off) < 0.003
    assert np.quantile(off, 0.9) < 0.01
    assert off.max() < 0.12


def test_a_supply_of_one_section_that_a_search_found() -> None:
    for path in FOUND.glob("*.json"):
        design = load_design(path)
        raster, outline = (m.chamber_areas for m in (design.section.moments, design.moments))
        assert np.abs(raster / outline - 1).max() < 0.007
