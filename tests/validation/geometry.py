"""One section, many ways to derive it: areas, centroids and second moments of all of them.

A sealed design is its outline. Other programs read every file that is written of it (VTK, gmsh's
mesh reader and its STEP kernel, ezdxf, an XML parser), and what they find is compared with the
outline by quadrature on triangles, which shares no code with the outline's own integrals.

All differences are those of ∫ {1, x, y, x², y², xy} over material and chambers of each supply,
over the ring's area times the power of its outer radius that the integral's unit asks for: so one
number holds areas, centroids and second moments.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from beamopt.export.export_design import export_design
from beamopt.scene.bundled import bundled_scenes
from beamopt.scene.design import Design, load_design
from beamopt.section.cross_section import CrossSection
from beamopt.section.feature_points import FeaturePoints
from femcheck.mesh.extrusion import extrude, stations
from femcheck.mesh.files import write_mesh
from femcheck.mesh.geo import SectionSizes
from femcheck.mesh.gmsh_section import Mesher
from femcheck.mesh.section_mesh import SectionMesh
from tests.readers.exports import read_dxf, read_step, read_stl, read_svg
from tests.readers.meshes import read_msh, read_vtu
from tests.readers.quadrature import over_circle, over_loop
from tests.validation.check import Check, Row

SEALED = bundled_scenes()["sealed-section"].with_name("sealed_section.json")
FOUND = Path(__file__).parents[1] / "data" / "sealed_designs"

TOLERANCES = {
    "outline, its own integrals": (1e-12, "rounding of sums over some hundred edges"),
    "mesh.vtu as VTK reads it": (1e-12, "the outline's own vertices, rounding"),
    "mesh.msh as gmsh reads it": (1e-12, "the outline's own vertices, rounding"),
    "DXF as ezdxf reads it": (1e-9, "the outline's vertices, merged where nearer than 1e-4 mm"),
    "SVG at 1:1": (1e-7, "coordinates are written to 1e-6 mm"),
    "STEP as gmsh's kernel reads it": (1e-7, "a kernel's tolerance of 1e-7 mm"),
    "STL, body": (1e-6, "single precision: 1e-6 mm at 25 mm"),
    "STL, all cores": (1e-6, "single precision: 1e-6 mm at 25 mm"),
    "true circles for the ring's polygons": (
        1e-6,
        "polygons of the circles' area; second moments differ with the fourth power of the edges",
    ),
}
"""By way: largest difference, and its reason. All but the last two kinds are exact polygons."""

RASTERS = ((32, 90), (64, 180), (128, 360), (256, 720))
RASTER, RULES = 2.2e-3, 4e-3
"""Differences to the smooth section: in the median on 128 × 360 elements; and what is left of the
largest where elements are fine, since narrow places are closed by circles there and here by
polygons. See `raster_rows`."""


def checks(full: bool) -> list[Check]:
    """The full suite has 60 designs, the reduced one 7."""
    return [
        Check("every way has the outline's moments", lambda: way_rows(sample(full))),
        Check("rasters converge", lambda: raster_rows(sample(full))),
    ]


@lru_cache
def sample(full: bool) -> list[tuple[str, Design]]:
    """Bundled and found designs, and random sealed ones of points and of drawings."""
    found, random, drawn = (6, 26, 27) if full else (2, 2, 2)
    files = (SEALED, *sorted(FOUND.glob("*.json"))[-found:])
    return [
        *((file.stem, load_design(file)) for file in files),
        *((f"random {seed}", random_design(seed)) for seed in range(random)),
        *((f"drawn {seed}", drawn_design(seed)) for seed in range(drawn)),
    ]


def random_design(seed: int) -> Design:
    """The first buildable sealed section of a stream of random points."""
    rng = np.random.default_rng([seed, 0])
    plain = load_design(SEALED)
    grid, count = plain.grid, int(rng.integers(8, 90))
    while True:
        points = FeaturePoints.random(grid.build(), count, rng)
        made = Design.of_points(
            points,
            grid=grid,
            wall_elements=0,
            actuator=plain.actuator,
            levels=plain.pressures,
            seal=plain.seal,
        )
        if made.outline.buildable and made.outline.chambers:
            return made


def drawn_design(seed: int) -> Design:
    """Ring pieces and circles at random places within the ring, over one another as they fall."""
    rng = np.random.default_rng([seed, 1])
    data = load_design(SEALED).model_dump(by_alias=True, exclude_none=True)
    data.pop("feature_points", None)
    while True:
        drawing: list[dict[str, object]] = []
        for k in range(int(rng.integers(2, 7))):
            angle = float(rng.uniform(0, 360))
            low, high = sorted(rng.uniform(11.5, 23.5, 2).tolist())
            if rng.random() < 0.5:
                radius = float(rng.uniform(1.5, 5.5))
                a, r = np.radians(angle), 17.5 + float(rng.uniform(-0.3, 0.3))
                at = [r * float(np.cos(a)), r * float(np.sin(a))]
                drawing.append({"supply": k % 3 + 1, "center": at, "radius": radius})
            elif high - low > 3:
                phi = [angle, angle + float(rng.uniform(20, 120))]
                drawing.append({"supply": k % 3 + 1, "r": [low, high], "phi": phi, "corner": 1.0})
        made = Design.model_validate(data | {"drawing": drawing})
        if drawing and made.outline.buildable and made.outline.chambers:
            return made


def difference(found: np.ndarray, expected: np.ndarray, design: Design) -> float:
    """Largest difference of integrals, over the ring's area and powers of its radius."""
    grid = design.grid.build()
    scale = grid.area * grid.outer_radius ** np.array([0, 1, 1, 2, 2, 2])
    return float(np.abs((found - expected) / scale).max())


def quadrature(design: Design) -> np.ndarray:
    """(4, 6) over the outline's polygons by fans of triangles."""
    rows = np.zeros((4, 6))
    for piece in design.outline.pieces:
        rows[0] += sum(over_loop(loop.points) for loop in piece.loops)
    for chamber in design.outline.chambers:
        loops = (chamber.exterior, *chamber.holes)
        rows[chamber.supply] += sum(over_loop(loop) for loop in loops)
    return rows


def with_true_circles(design: Design, integrals: np.ndarray) -> np.ndarray:
    """The same with the ring's surfaces as circles, as STEP and drawings have them."""
    grid, rows = design.grid.build(), integrals.copy()
    for piece in design.outline.pieces:
        for loop in piece.loops:
            size = over_loop(loop.points)
            radius = grid.outer_radius if size[0] > 0 else grid.inner_radius
            if loop.supply == 0:
                rows[0] += np.sign(size[0]) * over_circle(0, 0, radius) - size
    return rows


def ways(design: Design) -> Iterator[tuple[str, float]]:
    """Every way to derive a design's section, and its difference to what it should be."""
    polygons = quadrature(design)
    circles = with_true_circles(design, polygons)
    yield "outline, its own integrals", difference(design.outline.moments.raw, polygons, design)
    yield "true circles for the ring's polygons", difference(circles, polygons, design)
    length = design.actuator.length
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        section = Mesher().mesh(design.outline, SectionSizes(factor=2.0))
        assert isinstance(section, SectionMesh), section
        write_mesh(place, extrude(section, stations(length, 2)))
        for name, mesh in (
            ("mesh.vtu as VTK reads it", read_vtu(place / "mesh.vtu")),
            ("mesh.msh as gmsh reads it", read_msh(place / "mesh.msh")),
        ):
            assert mesh.volumes.min() > 0
            off = mesh.volumes.sum() / length / polygons[0, 0] - 1
            yield name, max(difference(mesh.integrals, polygons, design), abs(float(off)))
        parts = place / "parts"
        export_design(design, "design", parts)
        yield "DXF as ezdxf reads it", difference(read_dxf(parts / "section.dxf"), circles, design)
        yield "SVG at 1:1", difference(read_svg(parts / "section.svg"), circles, design)
        step = read_step(parts, length)
        yield "STEP as gmsh's kernel reads it", difference(step, circles, design)
        body = read_stl(parts / "body.stl", length)
        yield "STL, body", difference(body[None], polygons[:1], design)
        cores = read_stl(parts / "cores.stl", length)
        expected = polygons[1:].sum(axis=0) + _hole(design)
        yield "STL, all cores", difference(cores[None], expected[None], design)


def _hole(design: Design) -> np.ndarray:
    """The ring's hole within the body's own polygon; nothing in a disc."""
    for piece in design.outline.pieces:
        for loop in piece.holes:
            if loop.supply == 0:
                return -over_loop(loop.points)
    return np.zeros(6)


def way_rows(designs: Sequence[tuple[str, Design]]) -> Iterator[Row]:
    worst: dict[str, tuple[float, str]] = {}
    for name, design in designs:
        for way, off in ways(design):
            worst[way] = max(worst.get(way, (0.0, "")), (off, name))
    for way, (tolerance, reason) in TOLERANCES.items():
        off, name = worst[way]
        yield Row(f"{way}: worst of {len(designs)}, {name}", reason, 0.0, off, tolerance)


def raster_rows(designs: Sequence[tuple[str, Design]]) -> Iterator[Row]:
    """Rasters against the smooth section; the median falls at least with the elements' size.

    Elements that a border crosses count as a whole on one side of it: each is off by up to half of
    its area, and their number grows with the border's length over their size. The largest
    difference does not vanish: of 60 designs three keep 0.2…0.35 % on 512 × 1440 elements.
    """
    off = np.array(
        [
            [difference(_raster(design, *size), design.outline.smooth_moments.raw, design)
             for size in RASTERS]
            for _, design in designs
        ]
    )  # fmt: skip
    for size, errors in zip(RASTERS, off.T, strict=True):
        allowed = RASTER * RASTERS[2][0] / size[0]
        check, source = f"raster {size[0]} × {size[1]}", "its elements' size"
        yield Row(
            f"{check}: median of {len(designs)}", source, 0.0, float(np.median(errors)), allowed
        )
        worst = int(np.argmax(errors))
        check, source = f"{check}: worst, {designs[worst][0]}", "and what rules close"
        yield Row(check, source, 0.0, float(errors[worst]), 3 * allowed + RULES)
    rate = float(np.log2(np.median(off[:, 0]) / np.median(off[:, -1])) / 3)
    yield Row("rate of the median, or 1 if higher", "border elements", 1.0, min(rate, 1.0), 0.2)


def _raster(design: Design, radial: int, angular: int) -> np.ndarray:
    grid = replace(design.grid.build(), radial=radial, angular=angular)
    make: Callable[..., CrossSection] = (
        CrossSection.from_points
        if isinstance(design.source, FeaturePoints)
        else CrossSection.from_drawing
    )
    return make(grid, design.source, 0, design.seal.rules).moments.raw
