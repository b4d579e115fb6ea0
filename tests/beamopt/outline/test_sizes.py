"""One shape at every size: tips scale with it, and round chambers are what closed forms say."""

from typing import Any

import numpy as np
import pytest

from beamopt.base.arrays import FloatArray
from beamopt.export.faces import section_faces
from beamopt.outline.ring import usual_sagitta
from beamopt.rod.arc import arc_tips
from beamopt.rod.response import linear_response
from beamopt.scene.design import Design
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.moments import Moments
from femcheck.mesh.geo import SectionSizes
from femcheck.mesh.gmsh_section import Mesher
from femcheck.mesh.section_mesh import SectionMesh

R = 25.0
SIZES = np.geomspace(0.5, 500, 10) / R
PRESSURES = np.array([[50.0, 0, 0], [0, 25, 50], [50, 50, 0], [10, 20, 30]])
SEAL = {"skin": 1.0, "wall": 0.9, "rounding": 0.5, "smallest_chamber": 3.0}
ROUND = [(15.8, 6.1, 4.5), (-13.9, 10.7, 4.2), (-1.3, -17.4, 3.0)]
"""x, y, radius [mm] of the chambers of supplies 1, 2, 3."""


def design(size: float, seal: bool, inner: float = 10.0, **source: Any) -> Design:
    """All its lengths times `size`; radial and angular elements as usual."""
    rules = {key: value * size ** (2 if "small" in key else 1) for key, value in SEAL.items()}
    return Design.model_validate(
        {
            "schema": "beamopt-design/1",
            "grid": {"inner_radius": inner * size, "outer_radius": R * size},
            "wall_elements": 0,
            "seal": rules if seal else {},
            "actuator": {"length": 100.0 * size, "youngs_modulus": 300.0, "shear_modulus": 100.0},
            "pressures": [0.0, 25.0, 50.0],
            **source,
        }
    )


def round_chambers(size: float) -> dict[str, Any]:
    return {
        "drawing": [
            {"supply": k, "center": [x * size, y * size], "radius": r * size}
            for k, (x, y, r) in enumerate(ROUND, 1)
        ]
    }


def rounded_pieces(size: float) -> dict[str, Any]:
    return {
        "drawing": [
            {"supply": k + 1, "r": [12.3 * size, 22 * size], "phi": [120.0 * k, 120.0 * k + 95],
             "corner": 1.7 * size}
            for k in range(3)
        ]
    }  # fmt: skip


def feature_points(size: float) -> dict[str, Any]:
    points = FeaturePoints.random(PolarGrid(), 60, np.random.default_rng(2))
    x, y = (size * points.x).tolist(), (size * points.y).tolist()
    return {"feature_points": {"x": x, "y": y, "type": points.type.tolist()}}


def closed_form(inner: float) -> Moments:
    """Moments of round chambers in a ring or disc of 25 mm."""
    raw = np.zeros((4, 6))
    for sign, radius in ((1, R), (-1, inner)):
        second = np.pi / 4 * radius**4
        raw[0] += sign * np.array([np.pi * radius**2, 0, 0, second, second, 0])
    for supply, (x, y, r) in enumerate(ROUND, 1):
        area, own = np.pi * r**2, np.pi / 4 * r**4
        xx, yy, xy = own + area * x * x, own + area * y * y, area * x * y
        raw[supply] = area, area * x, area * y, xx, yy, xy
    raw[0] -= raw[1:].sum(axis=0)
    return Moments(raw)


def closed_tips(inner: float, length: float = 100.0) -> FloatArray:
    return arc_tips(linear_response(closed_form(inner), 300.0).strains(PRESSURES), length)


def moved(tips: FloatArray, wanted: FloatArray) -> float:
    """Largest difference over the largest displacement."""
    rest = np.array([0.0, 0.0, 100.0])
    return float(np.abs(tips - wanted).max() / np.abs(wanted - rest).max())


@pytest.mark.parametrize("sealed", [True, False])
@pytest.mark.parametrize("source", [round_chambers, rounded_pieces, feature_points])
def test_tips_scale_with_the_size(source: Any, sealed: bool) -> None:
    """Raster and outline: the same labels, as many edges, tips in proportion."""
    first, *others = (design(size, sealed, **source(size)) for size in SIZES)
    wanted = first.tips(PRESSURES) / SIZES[0]
    outline = first.outline
    for size, other in zip(SIZES[1:], others, strict=True):
        np.testing.assert_allclose(other.tips(PRESSURES) / size, wanted, rtol=0, atol=1e-10)
        np.testing.assert_array_equal(other.section.labels, first.section.labels)
        assert other.outline.edges == outline.edges
        assert [f.status for f in other.outline.faults] == [f.status for f in outline.faults]
        for one, same in zip(other.outline.faults, outline.faults, strict=True):
            assert one.value == pytest.approx(same.scaled(size / SIZES[0]).value)


@pytest.mark.parametrize("inner", [0.0, 10.0])
@pytest.mark.parametrize("size", SIZES)
def test_round_chambers_in_closed_form(size: float, inner: float) -> None:
    """A sealed design's tips are the outline's: 4e-6 of the displacement off."""
    whole = design(size, True, inner, **round_chambers(size))
    assert moved(whole.tips(PRESSURES) / size, closed_tips(inner)) < 2e-5
    powers = size ** np.array([2, 3, 3, 4, 4, 4])
    raw, wanted = whole.outline.moments.raw / powers, closed_form(inner).raw
    np.testing.assert_allclose(raw[:, 0], wanted[:, 0], rtol=1e-5)  # rounding corners costs it
    np.testing.assert_allclose(raw[0, 3:5], wanted[0, 3:5], rtol=1e-5)
    np.testing.assert_allclose(raw[1:, 3:5], wanted[1:, 3:5], rtol=1e-4)


def test_the_raster_of_round_chambers() -> None:
    """A drawing that is not sealed is its raster: 0.4 % of the displacement off."""
    wanted, off = closed_tips(10.0), []
    for radial, angular in ((64, 180), (128, 360), (512, 1440)):
        grid = {"inner_radius": 10.0, "outer_radius": R, "radial": radial, "angular": angular}
        open_one = design(1.0, False, **(round_chambers(1.0) | {"grid": grid}))
        off.append(moved(open_one.tips(PRESSURES), wanted))
    assert off[1] < 5e-3
    assert off[2] < 1e-3 < off[0]


@pytest.mark.parametrize("size", [0.02, 1.0, 20.0])
def test_mesh_and_export_have_the_same_section(size: float) -> None:
    whole = design(size, True, **round_chambers(size))
    section = Mesher().mesh(whole.outline, SectionSizes())
    assert isinstance(section, SectionMesh)
    raw = whole.outline.moments.raw
    np.testing.assert_allclose(section.moments.raw, raw, rtol=1e-9, atol=1e-9 * abs(raw).max())
    grid = whole.grid.build()
    faces = section_faces(whole.outline, grid, usual_sagitta(grid))
    material = sum(face.area for face in faces.pieces)  # of the ring's true circles
    assert material == pytest.approx(raw[0, 0], rel=1e-9)
    assert sum(face.polygon_area for face in faces.pieces) == pytest.approx(raw[0, 0], rel=1e-9)
    assert [contour.radius for contour in faces.ring] == pytest.approx([R * size, 10 * size])
    for supply in (1, 2, 3):
        assert faces.chamber_area(supply) == pytest.approx(raw[supply, 0], rel=1e-9)
    few = Mesher().mesh(design(1.0, True, **round_chambers(1.0)).outline, SectionSizes())
    assert isinstance(few, SectionMesh)
    assert len(section.triangles) == pytest.approx(len(few.triangles), rel=0.05)
