"""Body and mould as STEP and STL: what is in the files is the outline, extruded."""

import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from beamopt.base.errors import InputError
from beamopt.export.bodies import ExtrudedFace, body_solids, mould_solids
from beamopt.export.faces import Contour, _clean, section_faces
from beamopt.export.step import step_text
from beamopt.export.stl import enclosed_volume, is_watertight, solid_triangles, stl_bytes
from beamopt.outline.build import build_outline
from beamopt.scene.design import Design, load_design
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.seal import SealRules
from tests.beamopt.export.samples import SAGITTA, SAMPLES, SEALED, drawn, faces_of, random_section
from tests.beamopt.outline.hostile import DRAWINGS, POINTS, RING

LENGTH = 80.0
READ = """
import json, sys, gmsh
gmsh.initialize([], False, False, False)
gmsh.option.setNumber("General.Terminal", 0)
occ = gmsh.model.occ
parts = occ.importShapes(sys.argv[1])
gmsh.model.occ.synchronize()
kinds = [gmsh.model.getType(2, tag) for _, tag in gmsh.model.getEntities(2)]
print(json.dumps({
    "dimensions": [dimension for dimension, _ in parts],
    "names": [gmsh.model.getEntityName(3, tag).rpartition("/")[2] for _, tag in parts],
    "volumes": [occ.getMass(3, tag) for _, tag in parts],
    "boxes": [occ.getBoundingBox(3, tag) for _, tag in parts],
    "cylinders": kinds.count("Cylinder"),
}))
"""


def read_step(text: str, folder: Path) -> dict[str, list[float]]:
    """What another session of the kernel finds in a STEP file."""
    import json

    file = folder / "read.step"
    file.write_text(text)
    done = subprocess.run(
        [sys.executable, "-c", READ, str(file)], capture_output=True, text=True, check=True
    )
    found: dict[str, list[float]] = json.loads(done.stdout.strip().splitlines()[-1])
    return found


def solids_of(
    design: Design, cap: float = 0.0
) -> tuple[tuple[ExtrudedFace, ...], tuple[ExtrudedFace, ...]]:
    faces = faces_of(design)
    mould = mould_solids(faces, design.grid.build(), LENGTH, SAGITTA)
    return body_solids(faces, LENGTH, cap), mould


def read_stl(content: bytes) -> np.ndarray:
    """(n, 3, 3) corners; read here by the format's own description."""
    count = int.from_bytes(content[80:84], "little")
    assert len(content) == 84 + 50 * count
    assert not content.startswith(b"solid")
    records = np.frombuffer(content[84:], dtype=np.uint8).reshape(count, 50)
    numbers = np.frombuffer(records[:, :48].tobytes(), dtype="<f4").reshape(count, 12)
    return numbers[:, 3:].reshape(count, 3, 3).astype(float)


def check_strictly_closed(triangles: np.ndarray) -> None:
    """Every edge belongs to two triangles, which run through it in opposite directions."""
    names = [tuple(point) for point in triangles.reshape(-1, 3).tolist()]
    edges: dict[tuple[tuple[float, ...], ...], int] = {}
    for k in range(0, len(names), 3):
        for a, b in ((0, 1), (1, 2), (2, 0)):
            edge = (names[k + a], names[k + b])
            edges[edge] = edges.get(edge, 0) + 1
    assert set(edges.values()) == {1}
    assert all((b, a) in edges for a, b in edges)


@pytest.mark.parametrize("name", SAMPLES)
def test_step_holds_the_outline_extruded(name: str, tmp_path: Path) -> None:
    design = SAMPLES[name]()
    outline = design.outline
    for solids in solids_of(design):
        text = step_text(solids, "a title")
        assert "SI_UNIT(.MILLI.,.METRE.)" in text
        found = read_step(text, tmp_path)
        assert set(found["dimensions"]) == {3}
        if len(solids) > 1:
            assert found["names"] == [solid.name for solid in solids]
        assert found["volumes"] == pytest.approx([solid.volume for solid in solids], rel=1e-6)
    cores = [volume for solid, volume in zip(solids, found["volumes"], strict=True)
             if solid.name.startswith("core-") and solid.name != "core-hole"]  # fmt: skip
    areas = [chamber.area for chamber in outline.chambers]
    assert cores == pytest.approx([area * LENGTH for area in areas], rel=1e-6)


def test_the_body_is_the_ring_less_its_chambers(tmp_path: Path) -> None:
    """The surfaces are true circles, so that the ring's area is π (R² − r²) and no polygon's."""
    design = load_design(SEALED)
    body, mould = solids_of(design)
    found = read_step(step_text(body, "body"), tmp_path)
    expected = np.pi * (25.0**2 - 10.0**2) - design.outline.moments.chamber_areas.sum()
    assert found["volumes"] == pytest.approx([expected * LENGTH], rel=1e-9)
    assert found["cylinders"] == 2
    assert found["boxes"][0] == pytest.approx([-25, -25, 0, 25, 25, LENGTH], abs=1e-3)
    # straight edges leave out what lies beyond their chords
    edges = design.outline.moments.area * LENGTH
    assert sum(one.polygon_volume for one in body) == pytest.approx(edges, rel=1e-12)
    assert 0 < found["volumes"][0] / edges - 1 < 0.01
    whole = {solid.name: solid for solid in mould}
    assert whole["core-hole"].volume == pytest.approx(np.pi * 100 * LENGTH)
    assert whole["base-plate"].volume == pytest.approx(np.pi * 30.0**2 * 5)


def test_caps_close_the_chambers(tmp_path: Path) -> None:
    design = load_design(SEALED)
    body, _ = solids_of(design, cap=3.0)
    ring, chambers = np.pi * (25.0**2 - 10.0**2), design.outline.moments.chamber_areas.sum()
    expected = ring * (LENGTH + 6.0) - chambers * LENGTH
    text = step_text(body, "body")
    assert "BREP_WITH_VOIDS('body'" in text
    found = read_step(text, tmp_path)
    assert found["volumes"] == pytest.approx([expected], rel=1e-9)
    assert [found["boxes"][0][2], found["boxes"][0][5]] == pytest.approx([-3, 83], abs=1e-3)
    check_strictly_closed(solid_triangles(body[0]))


def test_caps_join_what_an_annular_chamber_parts() -> None:
    design = drawn([{"supply": 2, "r": [13.0, 20.0], "phi": [0.0, 360.0]}])
    apart, _ = solids_of(design)
    (joined,), _ = solids_of(design, cap=2.0)
    assert [solid.name for solid in apart] == ["body", "body-2"]
    ring = np.pi * (25.0**2 - 10.0**2)
    caps = 2 * 2.0 * ring
    assert joined.volume == pytest.approx(sum(solid.volume for solid in apart) + caps, rel=1e-9)
    surface = solid_triangles(joined)
    check_strictly_closed(surface)
    assert enclosed_volume(surface) == pytest.approx(joined.polygon_volume, rel=1e-6)


def test_caps_do_not_close_what_is_open() -> None:
    with pytest.raises(InputError, match=r"^--cap: '2': must be 0: chambers are open"):
        solids_of(SAMPLES["open"](), cap=2.0)


@pytest.mark.parametrize("name", SAMPLES)
def test_stl_is_closed_and_holds_the_volume(name: str) -> None:
    for solids in solids_of(SAMPLES[name]()):
        content = stl_bytes(solids)
        triangles = read_stl(content)
        # touching cores of an open section share edges between them, each alone is closed
        for solid in solids:
            check_strictly_closed(solid_triangles(solid))
        expected = sum(solid.polygon_volume for solid in solids)
        assert enclosed_volume(triangles) == pytest.approx(expected, rel=1e-6)
        box = [triangles[..., k].max() - triangles[..., k].min() for k in range(3)]
        assert box[2] == pytest.approx(solids[0].high - min(one.low for one in solids))


@settings(max_examples=6)
@given(seed=st.integers(0, 10_000), count=st.integers(3, 60), cap=st.sampled_from([0.0, 1.5]))
def test_any_sealed_section_is_closed(seed: int, count: int, cap: float) -> None:
    design = random_section(seed, count)
    if not design.outline.buildable:
        return
    body, mould = solids_of(design, cap)
    for solid in (*body, *mould):
        triangles = solid_triangles(solid)
        check_strictly_closed(triangles)
        assert enclosed_volume(triangles) == pytest.approx(solid.polygon_volume, rel=1e-6)


def test_normals_point_outwards() -> None:
    body, _ = solids_of(load_design(SEALED))
    content = stl_bytes(body)
    count = int.from_bytes(content[80:84], "little")
    records = np.frombuffer(content[84:], dtype=np.uint8).reshape(count, 50)
    normals = np.frombuffer(records[:, :12].tobytes(), dtype="<f4").reshape(count, 3)
    middles = read_stl(content).mean(axis=1)
    assert np.linalg.norm(normals, axis=1) == pytest.approx(1.0, abs=1e-5)
    assert (normals[middles[:, 2] > LENGTH - 1e-3] == [0, 0, 1]).all()
    outer = np.hypot(*middles[:, :2].T) > 24.9
    radial = (normals[:, :2] * middles[:, :2]).sum(axis=1)
    assert (radial[outer & (abs(normals[:, 2]) < 0.5)] > 0).all()


def test_an_open_surface_is_told() -> None:
    triangles = solid_triangles(solids_of(load_design(SEALED))[0][0])
    assert is_watertight(triangles)
    assert not is_watertight(triangles[1:])
    turned = triangles.copy()
    turned[0] = turned[0, ::-1]
    assert not is_watertight(turned)


def test_a_chord_of_the_circle_is_no_circle() -> None:
    """A chamber that cuts a segment off the disc straight leaves corners on the circle alone."""
    points = FeaturePoints([0.0, 48.0], [0.0, 0.0], [0, 1])
    disc = PolarGrid(0.0, 25.0)
    faces = section_faces(build_outline(disc, points, SealRules()), disc, SAGITTA)
    assert faces.is_open
    (piece,) = faces.pieces
    assert [contour.radius for contour in piece.contours] == [None]
    assert np.hypot(*piece.contours[0].points.T) == pytest.approx(25.0, abs=1e-3)


def test_points_on_a_line_leave_nothing_but_solids() -> None:
    """Slivers between cells leave the kernel with lines that belong to no solid."""
    outline = build_outline(RING, POINTS["on a line"], SealRules())
    body = body_solids(section_faces(outline, RING, SAGITTA), LENGTH)
    text = step_text(body, "lines")
    assert "GEOMETRIC_CURVE_SET" not in text
    assert text.count("MANIFOLD_SOLID_BREP(") == len(body) == text.count("PRODUCT('") - 1


def test_chambers_side_by_side_leave_no_slit() -> None:
    """Unsealed, their common sides are a line of no width in the material's hole."""
    outline = build_outline(RING, DRAWINGS["side by side"], SealRules())
    body = body_solids(section_faces(outline, RING, SAGITTA), LENGTH)
    area = np.pi * (25.0**2 - 10.0**2) - outline.moments.chamber_areas.sum()
    assert sum(solid.volume for solid in body) == pytest.approx(area * LENGTH, rel=1e-6)
    assert "MANIFOLD_SOLID_BREP('body'" in step_text(body, "side by side")
    for solid in body:
        check_strictly_closed(solid_triangles(solid))


def test_collinear_vertices_and_spikes_of_no_width() -> None:
    """What clipping leaves: a triangle of no area has no sign of its own."""
    for solid in solids_of(random_section(14, 100, skin=0.0))[0]:
        check_strictly_closed(solid_triangles(solid))
    flat = np.array([[0.0, 0.0], [0.1, 0.1], [0.3, 0.3], [1.0, 1.0], [0.0, 2.0], [0.0, 0.7]])
    spiked = np.insert(flat, 4, [[3.0, 1.0], [1.0, 1.0 + 1e-12]], axis=0)
    assert _clean(spiked).tolist() == flat.tolist()
    assert _clean(flat) is flat


def test_a_kernel_that_fails_is_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    body, _ = solids_of(load_design(SEALED))
    with pytest.raises(InputError, match=r"did not end within 0\.01 s"):
        step_text(body, "body", seconds=0.01)
    monkeypatch.setattr("beamopt.export.step.KERNEL", Path("no such file.py"))
    with pytest.raises(InputError, match=r"step: gmsh: .*leave step out"):
        step_text(body, "body")


def test_a_volume_that_is_not_the_contours_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    body, _ = solids_of(load_design(SEALED))
    monkeypatch.setattr("beamopt.export.step._run", lambda *_: [1.0])
    with pytest.raises(InputError, match="gmsh made 1 mm³"):
        step_text(body, "body")


def test_names_are_written_as_step_has_them() -> None:
    contour = Contour(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]))
    text = step_text([ExtrudedFace("Düse's \\ part", (contour,), 0.0, 1.0)], "größer")
    assert r"MANIFOLD_SOLID_BREP('D\X2\00FC\X0\se''s \\ part'" in text
    assert r"PRODUCT('gr\X2\00F6\X0\\X2\00DF\X0\er'" in text
    assert text.isascii()


def names(solids: Sequence[ExtrudedFace]) -> list[str]:
    return [solid.name for solid in solids]


def test_what_there_is() -> None:
    body, mould = solids_of(SAMPLES["island"]())
    assert names(body) == ["body", "body-2"]
    assert names(mould) == ["core-1-1", "base-plate"]  # a disc has no hole
    assert len(mould[0].contours) == 2  # around the island
    _, mould = solids_of(SAMPLES["sector"]())
    assert names(mould) == ["core-1-1", "core-2-1", "core-3-1", "base-plate"]
    _, mould = solids_of(load_design(SEALED))
    assert names(mould)[-2:] == ["core-hole", "base-plate"]
