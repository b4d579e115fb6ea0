"""The six sealed designs of an earlier search: the sections that they had when they were written.

Numbers were recorded before feature points in one place were made one; two files were edited so
that they hold (tests/data/sealed_designs/README.md).
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from beamopt.scene.design import load_design

FOLDER = Path(__file__).parents[2] / "data" / "sealed_designs"

AREA = 0.05
"""mm² of 200…900; polygons of the ring and of arcs may be made finer, a twin's wall is 1 mm²."""


@dataclass(frozen=True)
class Section:
    """Smooth outline: areas [mm²] and centroids [mm] of material and supplies, material's ∫ x², y²,
    xy [mm⁴]; areas of the raster [mm²]; chambers of each supply.
    """

    areas: tuple[float, float, float, float]
    centroids: tuple[tuple[float, float], ...]
    second: tuple[float, float, float]
    raster: tuple[float, float, float, float]
    chambers: tuple[int, int, int]


SECTIONS = {
    "search_1.json": Section(
        (871.9948, 295.2875, 210.8979, 271.156),
        ((-0.36686, 0.50899), (13.18361, -0.28009), (-3.02608, 10.16508), (-10.82353, -9.23795)),
        (175434.7, 146040.5, -14284.1),
        (870.5188, 295.6134, 210.6411, 272.5628),
        (3, 3, 4),
    ),
    "search_2.json": Section(
        (844.182, 244.2185, 244.9043, 316.0314),
        ((-0.03536, 0.59824), (12.36764, 0.56169), (-1.14481, 10.04861), (-8.5757, -9.81911)),
        (127755.9, 174098.5, 17644.0),
        (843.5309, 244.5012, 245.2528, 316.0512),
        (2, 6, 3),
    ),
    "search_4.json": Section(
        (916.5204, 289.6431, 158.6748, 284.4978),
        ((-0.34324, 0.63972), (13.63692, -0.70592), (-4.62629, 15.94244), (-10.19756, -10.23388)),
        (164119.1, 184394.3, -19907.6),
        (915.5104, 290.1371, 159.171, 284.5176),
        (2, 1, 3),
    ),
    "search_5.json": Section(
        (891.5633, 295.6747, 147.8302, 314.268),
        ((-0.26208, 0.4704), (11.61856, -0.9206), (-4.33688, 16.81101), (-8.14761, -8.37619)),
        (138144.7, 172482.0, -14096.4),
        (892.3882, 294.7544, 148.2899, 313.9036),
        (3, 3, 4),
    ),
    "search_6.json": Section(
        (848.8751, 299.6995, 194.114, 306.6476),
        ((-0.23451, 0.57518), (10.72195, 0.15115), (-0.07414, 11.90292), (-9.78288, -9.27473)),
        (143262.9, 183620.0, 3980.6),
        (848.6493, 300.0875, 193.8543, 306.745),
        (3, 4, 2),
    ),
    "thin_bore_skin.json": Section(
        (890.4831, 296.2291, 154.9777, 307.6463),
        ((-0.47767, 0.45104), (13.6201, -1.24227), (-1.50898, 17.73647), (-10.97186, -9.04418)),
        (170604.3, 168854.2, -6363.6),
        (890.0975, 296.1503, 155.0906, 307.9978),
        (1, 1, 3),
    ),
}


@pytest.mark.parametrize("name", list(SECTIONS))
def test_sections_are_as_they_were_written(name: str) -> None:
    design, held = load_design(FOLDER / name), SECTIONS[name]
    smooth = design.outline.smooth_moments.raw
    np.testing.assert_allclose(smooth[:, 0], held.areas, atol=AREA)
    np.testing.assert_allclose(smooth[:, 1:3] / smooth[:, :1], held.centroids, atol=2e-3)
    np.testing.assert_allclose(smooth[0, 3:], held.second, atol=25 * 25 * AREA)
    np.testing.assert_allclose(design.section.moments.raw[:, 0], held.raster, atol=1e-4)
    counts = tuple(len(design.outline.chambers_of(supply)) for supply in (1, 2, 3))
    assert counts == held.chambers
    assert not design.outline.faults


def test_every_file_is_held() -> None:
    assert {path.name for path in FOLDER.glob("*.json")} == set(SECTIONS)
