"""Mesh files, read back by VTK, gmsh and meshio."""

from collections.abc import Callable
from pathlib import Path

import meshio
import numpy as np
import pytest
import pyvista

from beamopt.scene.bundled import bundled_scenes
from beamopt.scene.design import load_design
from femcheck.mesh.extrusion import Extrusion, extrude, stations
from femcheck.mesh.files import TAGS, write_deformed, write_mesh
from femcheck.mesh.geo import SectionSizes
from femcheck.mesh.gmsh_section import Mesher
from femcheck.mesh.section_mesh import SectionMesh
from femcheck.regression.kept_mesh import read_kept
from tests.femcheck.lattice import LENGTH, lattice_section
from tests.readers.meshes import VolumeMesh, read_msh, read_section_msh, read_vtu

LAYERS = 3


@pytest.fixture(scope="module")
def body() -> Extrusion:
    return extrude(lattice_section(), stations(LENGTH, LAYERS, 1.5))


@pytest.fixture(scope="module")
def folder(body: Extrusion, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("mesh")
    write_mesh(folder, body)
    return folder


def test_both_files_and_nothing_else(folder: Path) -> None:
    assert sorted(item.name for item in folder.iterdir()) == ["mesh.msh", "mesh.vtu"]


def sealed_extrusion() -> Extrusion:
    """The bundled sealed section as gmsh meshes it, with graded layers."""
    design = load_design(bundled_scenes()["sealed-section"].with_name("sealed_section.json"))
    section = Mesher().mesh(design.outline, SectionSizes(factor=3.0))
    assert isinstance(section, SectionMesh)
    return extrude(section, stations(100.0, 3, 2.0))


BODIES = {
    "lattice": lambda: extrude(lattice_section(), stations(LENGTH, LAYERS, 1.5)),
    "sealed": sealed_extrusion,
}


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize(("file", "read"), [("mesh.vtu", read_vtu), ("mesh.msh", read_msh)])
def test_other_programs_find_the_solid(
    name: str, file: str, read: Callable[[Path], VolumeMesh], tmp_path: Path
) -> None:
    """Positive volumes, the area of every tagged surface, moments of material and chambers."""
    body = BODIES[name]()
    write_mesh(tmp_path, body)
    found, section = read(tmp_path / file), body.section
    assert found.volumes.min() > 0
    assert found.volumes.sum() == pytest.approx(section.moments.area * body.length, rel=1e-12)
    a, b = section.points[section.edges.T]
    lengths = np.hypot(*(b - a).T)
    for supply, group in enumerate(("surface", "supply-1", "supply-2", "supply-3")):
        walls = lengths[section.supply == supply].sum() * body.length
        assert found.areas[group] == pytest.approx(walls, rel=1e-12)
    assert found.areas["fixed"] == pytest.approx(section.moments.area, rel=1e-12)
    assert found.areas["tip"] == pytest.approx(section.moments.area, rel=1e-12)
    size = np.abs(section.moments.raw).max(axis=0)
    np.testing.assert_allclose(found.integrals / size, section.moments.raw / size, atol=1e-12)


@pytest.mark.parametrize("name", BODIES)
def test_warping_the_deformed_mesh_once_is_the_deformed_shape(name: str, tmp_path: Path) -> None:
    """As VTK reads it: undeformed points of positive volume, and the way from there."""
    body = BODIES[name]()
    at = body.points @ np.array([[0.9, 0.1, 0.0], [0.0, 1.1, 0.2], [0.1, 0.0, 1.25]]) + 2.0
    write_deformed(tmp_path / "state.vtu", body, at)
    grid = pyvista.read(tmp_path / "state.vtu")
    np.testing.assert_allclose(grid.points, body.points, atol=1e-12)
    assert set(grid.point_data) == {"displacement_mm"}
    warped = grid.warp_by_vector("displacement_mm")
    np.testing.assert_allclose(warped.points, at, atol=1e-12)
    rest, now = (np.asarray(one.compute_cell_sizes()["Volume"]) for one in (grid, warped))
    assert min(rest.min(), now.min()) > 0
    assert rest.sum() == pytest.approx(body.section.moments.area * body.length, rel=1e-12)
    det = 0.9 * 1.1 * 1.25 + 0.1 * 0.2 * 0.1
    np.testing.assert_allclose(now / rest, det, rtol=1e-9)


def test_cells_and_their_tags(folder: Path, body: Extrusion) -> None:
    name, tag = "mesh.msh", "gmsh:physical"
    read = meshio.read(folder / name)
    np.testing.assert_allclose(read.points, body.points, atol=1e-12)
    np.testing.assert_array_equal(read.get_cells_type("wedge"), body.wedges)
    assert set(read.get_cell_data(tag, "wedge")) == {TAGS["material"][0]}
    np.testing.assert_array_equal(read.get_cells_type("quad"), body.walls)
    np.testing.assert_array_equal(read.get_cell_data(tag, "quad"), body.supply + 1)
    triangles, tags = read.get_cells_type("triangle"), read.get_cell_data(tag, "triangle")
    for group, height, up in (("fixed", 0.0, -1), ("tip", LENGTH, 1)):
        chosen = triangles[tags == TAGS[group][0]]
        assert len(chosen) == len(body.section.triangles)
        at = read.points[chosen]
        assert (at[..., 2] == height).all()
        normals = np.cross(at[:, 1] - at[:, 0], at[:, 2] - at[:, 0])
        assert (normals[:, 2] * up > 0).all()


def test_all_groups_are_in_the_gmsh_file(folder: Path) -> None:
    read = meshio.read(folder / "mesh.msh")
    found = {name: tuple(data) for name, data in read.field_data.items()}
    assert found == TAGS
    used = {int(tag) for tags in read.cell_data["gmsh:physical"] for tag in tags}
    assert used == {number for number, _ in TAGS.values()}


def test_walls_enclose_the_chambers(folder: Path, body: Extrusion) -> None:
    """A supply's facets alone, from the file: their normals out of the material, areas by hand."""
    read = meshio.read(folder / "mesh.msh")
    quads, tags = read.get_cells_type("quad"), read.get_cell_data("gmsh:physical", "quad")
    for supply in (1, 2, 3):
        at = read.points[quads[tags == TAGS[f"supply-{supply}"][0]]]
        normal = np.cross(at[:, 1] - at[:, 0], at[:, 2] - at[:, 1])
        # ∮ x·n over upright walls is twice the volume; into the chamber it is negative
        flat = at.mean(axis=1)[:, :2]
        volume = -np.einsum("fc,fc->", flat, normal[:, :2]) / 2
        expected = body.section.moments.chamber_areas[supply - 1] * LENGTH
        assert volume == pytest.approx(expected, rel=1e-9)


def test_deformed(tmp_path: Path, body: Extrusion) -> None:
    at = body.points * [1.0, 1.0, 1.25] + [0.0, 2.0, 0.0]
    write_deformed(tmp_path / "state.vtu", body, at)
    grid = pyvista.read(tmp_path / "state.vtu")
    np.testing.assert_allclose(grid.cell_data["stretch"], 1.25)
    assert [item.name for item in tmp_path.iterdir()] == ["state.vtu"]


@pytest.mark.parametrize("file", sorted(Path("meshes").glob("*.msh")), ids=lambda file: file.stem)
def test_gmsh_reads_the_stored_section_meshes(file: Path) -> None:
    """Triangles counter-clockwise; every supply's edges enclose its chambers."""
    section, found = read_kept(file), read_section_msh(file)
    size = np.abs(section.moments.raw).max(axis=0)
    np.testing.assert_allclose(found / size, section.moments.raw / size, atol=1e-12)
