"""A section as a whole: rasterised, walled, measured."""

from __future__ import annotations

import numpy as np
import pytest

from beamopt.section.cross_section import CrossSection
from beamopt.section.drawing import Circle, RingPiece, rasterise
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.moments import moments_of
from beamopt.section.pieces import count_pieces
from beamopt.section.raster import raster
from beamopt.section.walls import add_walls

RING = PolarGrid(radial=20, angular=45)
SECTOR = PolarGrid(radial=20, angular=45, stop=200.0)
SHAPES = [RingPiece(1, (12.0, 22.0), (-60.0, 90.0), 1.0), Circle(2, (0.0, 17.0), 5.0)]


@pytest.mark.parametrize("grid", [RING, SECTOR], ids=["ring", "sector"])
@pytest.mark.parametrize("wall_elements", [0, 2, 4, 6])
def test_walls_take_half_their_elements_from_each_side(grid: PolarGrid, wall_elements: int) -> None:
    points = FeaturePoints.random(grid, 12, np.random.default_rng(1), 0.2)
    for section, labels in (
        (CrossSection.from_points(grid, points, wall_elements), raster(grid, points)),
        (CrossSection.from_drawing(grid, SHAPES, wall_elements), rasterise(grid, SHAPES)),
    ):
        add_walls(labels, wall_elements // 2, grid.is_full_ring)
        np.testing.assert_array_equal(section.labels, labels)


def test_walls_are_four_elements_unless_told() -> None:
    points = FeaturePoints.random(RING, 12, np.random.default_rng(2))
    found = CrossSection.from_points(RING, points).labels
    np.testing.assert_array_equal(found, CrossSection.from_points(RING, points, 4).labels)
    found = CrossSection.from_drawing(RING, SHAPES).labels
    np.testing.assert_array_equal(found, CrossSection.from_drawing(RING, SHAPES, 4).labels)


def test_moments_and_pieces_are_those_of_the_labels() -> None:
    section = CrossSection.from_drawing(SECTOR, SHAPES)
    np.testing.assert_array_equal(section.moments.raw, moments_of(SECTOR, section.labels).raw)
    assert section.pieces == count_pieces(SECTOR, section.labels)


@pytest.mark.parametrize("wall_elements", [-2, 1, 3])
def test_walls_need_an_even_count(wall_elements: int) -> None:
    points = FeaturePoints([15], [0], [1])
    with pytest.raises(ValueError, match=f"wall_elements = {wall_elements}"):
        CrossSection.from_points(RING, points, wall_elements)
    with pytest.raises(ValueError, match=f"wall_elements = {wall_elements}"):
        CrossSection.from_drawing(RING, SHAPES, wall_elements)


def test_labels_fit_the_grid() -> None:
    with pytest.raises(ValueError, match=r"\(45, 20\), the grid \(20, 45\)"):
        CrossSection(RING, np.zeros((45, 20), dtype=np.uint8))


def test_labels_do_not_change() -> None:
    section = CrossSection.from_drawing(RING, SHAPES)
    with pytest.raises(ValueError, match="read-only"):
        section.labels[0, 0] = 1


def test_labels_are_checked_and_copied() -> None:
    grid = PolarGrid(radial=2, angular=4)
    with pytest.raises(ValueError, match="labels: 0"):
        CrossSection(grid, np.full(grid.shape, 7, dtype=np.uint8))
    labels = np.zeros(grid.shape, dtype=np.uint8)
    section = CrossSection(grid, labels)
    labels[0, 0] = 1
    assert section.labels[0, 0] == 0
