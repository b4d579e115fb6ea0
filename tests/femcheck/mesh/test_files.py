"""Mesh files, read back by meshio."""

from pathlib import Path

import meshio
import numpy as np
import pytest

from femcheck.mesh.extrusion import Extrusion, extrude, stations
from femcheck.mesh.files import TAGS, write_deformed, write_mesh
from tests.femcheck.lattice import LENGTH, lattice_section

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


@pytest.mark.parametrize(("name", "tag"), [("mesh.msh", "gmsh:physical"), ("mesh.vtu", "tag")])
def test_cells_and_their_tags(folder: Path, body: Extrusion, name: str, tag: str) -> None:
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
    read = meshio.read(tmp_path / "state.vtu")
    np.testing.assert_allclose(read.points, at)
    np.testing.assert_allclose(read.point_data["displacement"], at - body.points)
    np.testing.assert_allclose(read.cell_data["stretch"][0], 1.25)
    assert [item.name for item in tmp_path.iterdir()] == ["state.vtu"]
