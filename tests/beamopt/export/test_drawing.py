"""The section as SVG and DXF, read again by other programs' rules."""

import io
import math
import re
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from beamopt.export.drawing import Drawing, section_drawing
from beamopt.export.dxf import LAYERS, dxf_bytes
from beamopt.export.faces import polygon_of
from beamopt.export.svg import svg_text
from beamopt.outline.green import loop_integrals
from beamopt.plot.style import TYPE_COLOURS
from beamopt.scene.design import Design, load_design
from tests.beamopt.export.samples import SAGITTA, SAMPLES, SEALED, drawn, faces_of, random_section

SVG = "{http://www.w3.org/2000/svg}"
NUMBER = r"-?[\d.]+"


def drawing_of(design: Design, name: str = "mine") -> Drawing:
    return section_drawing(design, faces_of(design), name, SAGITTA)


def path_area(data: str) -> float:
    """Area [mm²] of a path of closed loops; two half circles are a circle, signed by its sweep."""
    total = 0.0
    for loop in data.split("Z")[:-1]:
        arc = re.fullmatch(
            rf"\s*M({NUMBER}) 0A({NUMBER}) \2 0 0 ([01]) -\2 0A\2 \2 0 0 \3 \2 0", loop
        )
        if arc:
            assert arc[1] == arc[2]
            total += math.pi * float(arc[2]) ** 2 * (1 if arc[3] == "1" else -1)
        else:
            points = np.array(re.findall(NUMBER, loop), dtype=float).reshape(-1, 2)
            total += float(loop_integrals(points)[0])
    return total


def expected_areas(design: Design) -> dict[int, float]:
    """Material with true circles, chambers as the outline has them [mm²]."""
    faces = faces_of(design)
    areas = design.outline.moments.chamber_areas
    material = sum(piece.area for piece in faces.pieces)
    return {0: material} | {supply: float(areas[supply - 1]) for supply in (1, 2, 3)}


@pytest.mark.parametrize("name", SAMPLES)
def test_svg_is_in_mm_and_has_the_areas(name: str) -> None:
    design = SAMPLES[name]()
    drawing = drawing_of(design)
    root = ET.fromstring(svg_text(drawing))
    box = root.attrib["viewBox"].split()
    assert box[:2] == ["0", "0"]
    assert [root.attrib["width"], root.attrib["height"]] == [f"{size}mm" for size in box[2:]]
    width, height = map(float, box[2:])
    areas = dict.fromkeys(range(4), 0.0)
    for path in root.iter(f"{SVG}path"):
        kind = re.fullmatch(r"supply-(\d)", path.attrib.get("class", ""))
        if kind:
            areas[int(kind[1])] += path_area(path.attrib["d"])
            assert path.attrib["fill"] == TYPE_COLOURS[int(kind[1])]
    assert areas == pytest.approx(expected_areas(design), rel=1e-6, abs=1e-9)
    # everything drawn is on the sheet
    x0, y0, x1, y1 = drawing.bounds
    assert x1 - x0 < width
    assert y1 - y0 < height


def test_svg_lets_a_ruler_check_it() -> None:
    root = ET.fromstring(svg_text(drawing_of(load_design(SEALED))))
    bar = list(root.iter(f"{SVG}rect"))
    assert len(bar) == 10
    assert sum(float(part.attrib["width"]) for part in bar) == 10
    said = [text.text for text in root.iter(f"{SVG}text")]
    assert {"10 mm", "⌀ 50", "⌀ 20", "x", "y", "mine"} <= set(said)
    assert "outer diameter 50 mm, inner diameter 20 mm, length 100 mm" in said
    assert [text for text in said if text in {"1", "2", "3"}] == ["1", "2", "3"]
    # y of the sheet runs downwards, y of the section up
    flipped = [g for g in root.iter(f"{SVG}g") if "scale(1 -1)" in g.attrib.get("transform", "")]
    assert len(flipped) == 1


@pytest.mark.parametrize("name", SAMPLES)
def test_numbers_stand_in_their_chambers(name: str) -> None:
    import shapely

    drawing = drawing_of(SAMPLES[name]())
    assert len(drawing.labels) == len(drawing.faces.chambers)
    for label, face in zip(drawing.labels, drawing.faces.chambers, strict=True):
        chamber = polygon_of(face.contours)  # the island's reaches all round it
        assert chamber.contains(shapely.Point(label.x, label.y))
        assert label.supply == face.supply


def test_notes_are_written_and_do_no_harm() -> None:
    drawing = drawing_of(random_section(3), "<b>&'\" \n name " + "x" * 100)
    text = svg_text(drawing)
    ET.fromstring(text)
    assert "scene a &lt;scene&gt; &amp; more, seed 3, L = 12.5 mm²" in text
    assert len(drawing.title) == 60
    assert "\n" not in drawing.title
    dxf_bytes(drawing)


def test_least_skin_and_wall_are_those_asked_for() -> None:
    """Two 80° chambers from 13 to 22 mm: skins of 3 mm, and 10° at 13 mm between them."""
    chambers = [{"supply": k + 1, "r": [13.0, 22.0], "phi": [90.0 * k, 90.0 * k + 80]}
                for k in range(2)]  # fmt: skip
    drawing = drawing_of(drawn(chambers))
    assert drawing.least_skin == pytest.approx(3.0, abs=2 * SAGITTA)
    # corners are rounded by 0.5 mm, so that the chord of the inner ends is no nearer
    wall = 2 * 13.5 * math.sin(math.radians(5))
    assert drawing.least_wall == pytest.approx(wall, abs=0.1)
    assert drawing_of(drawn([])).least_skin is None
    opened = drawing_of(SAMPLES["open"]())
    assert (opened.least_skin, opened.least_wall) == (0.0, 0.0)
    assert any("open" in line for line in opened.lines)


@pytest.mark.parametrize("name", SAMPLES)
def test_dxf_is_in_mm_and_has_the_areas(name: str) -> None:
    ezdxf = pytest.importorskip("ezdxf")
    design = SAMPLES[name]()
    document = ezdxf.read(io.StringIO(dxf_bytes(drawing_of(design)).decode()))
    assert document.header["$INSUNITS"] == 4
    assert not document.audit().errors
    areas = dict.fromkeys(range(4), 0.0)
    radii = []
    for entity in document.modelspace():
        layer = entity.dxf.layer
        if layer == "TEXT":
            continue
        if entity.dxftype() == "CIRCLE":
            # the ring's: the outer one adds, the inner one takes away
            assert entity.dxf.center.isclose((0, 0, 0))
            radii.append(entity.dxf.radius)
            sign = 1 if entity.dxf.radius == design.grid.outer_radius else -1
            areas[LAYERS.index(layer)] += sign * math.pi * entity.dxf.radius**2
        else:
            assert entity.dxftype() == "LWPOLYLINE"
            assert entity.closed
            points = np.array(list(entity.vertices()))
            areas[LAYERS.index(layer)] += float(loop_integrals(points)[0])
    assert areas == pytest.approx(expected_areas(design), rel=1e-9, abs=1e-9)
    circles = {"sealed": [25, 10], "random": [25, 10], "island": [25], "sector": [], "open": []}
    assert radii == circles[name]


def test_dxf_leaves_the_callers_settings_alone() -> None:
    ezdxf = pytest.importorskip("ezdxf")
    before = ezdxf.options.write_fixed_meta_data_for_testing
    dxf_bytes(drawing_of(load_design(SEALED)))
    assert ezdxf.options.write_fixed_meta_data_for_testing is before
