"""Shapes: surfaces, stretch, and what a page gets back of them."""

import base64
import tracemalloc
import zlib
from pathlib import Path

import meshio
import numpy as np
import pytest
import pyvista

from beamopt.base.errors import InputError
from beamopt.storage.input_file import MOST_MESH
from femcheck.mesh.vtu_size import check_unpacked_size
from femcheck.report.packing import Scale, pack, stretch_range, unpack_positions
from femcheck.report.shapes import RunShapes, _mesh, read_shapes
from femcheck.report.solid_run import read_solid_run
from femcheck.report.surface import TIP, Surface, surface_of

STEP_ERROR = 1e-9  # mm, beside half a step


@pytest.fixture(scope="module")
def shapes(checked: Path) -> RunShapes:
    found = read_shapes(read_solid_run(checked))
    assert found is not None
    return found


def square_tube() -> Surface:
    """A square of 3 × 3 with a square hole, extruded by 2 layers: eight corners a plane."""
    outer = [(0, 0), (3, 0), (3, 3), (0, 3)]
    inner = [(1, 1), (2, 1), (2, 2), (1, 2)]
    triangles = []
    for k in range(4):
        after = (k + 1) % 4
        triangles += [(k, after, 4 + after), (k, 4 + after, 4 + k)]
    heights = [0.0, 2.0, 5.0]
    points = np.array([(x, y, z) for z in heights for x, y in (*outer, *inner)], dtype=float)
    wedges = np.array(
        [[*(c + 8 * k for c in t), *(c + 8 * k + 8 for c in t)] for k in (0, 1) for t in triangles]
    )
    sides = {tuple(sorted((k, (k + 1) % 4))): 0 for k in range(4)}
    holes = {tuple(sorted((4 + k, 4 + (k + 1) % 4))): 2 for k in range(4)}
    return surface_of(points, wedges, {(a, b): one for (a, b), one in (sides | holes).items()})


def areas(surface: Surface, at: np.ndarray) -> np.ndarray:
    a, b, c = (at[surface.triangles[:, k]] for k in range(3))
    return np.cross(b - a, c - a) / 2


def test_a_tube_has_its_walls_and_tip() -> None:
    """Outer walls 4·3·5, hole 4·1·5, tip 9 − 1; normals out of the material."""
    surface = square_tube()
    normals = areas(surface, surface.rest)
    size = np.linalg.norm(normals, axis=1)
    assert size[surface.part == 0].sum() == pytest.approx(60)
    assert size[surface.part == 2].sum() == pytest.approx(20)
    assert size[surface.part == TIP].sum() == pytest.approx(8)
    assert (np.diff(surface.part) >= 0).all()  # part by part
    middle = surface.rest[surface.triangles].mean(axis=1) - [1.5, 1.5, 0.0]
    outward = (normals * middle * [1, 1, 0]).sum(axis=1)
    assert (outward[surface.part == 0] > 0).all()
    assert (outward[surface.part == 2] < 0).all()
    assert (normals[surface.part == TIP, 2] > 0).all()


def test_a_uniform_extension_is_its_stretch() -> None:
    """x = (a X, b Y, c Z): walls in the planes of x and z are stretched by max(a, c), and so on."""
    surface = square_tube()
    a, b, c = 1.3, 0.8, 1.1
    stretch = surface.stretch(surface.rest * [a, b, c])
    tip = np.unique(surface.triangles[surface.part == TIP])
    np.testing.assert_allclose(stretch[tip], a, rtol=1e-12)
    walls = np.setdiff1d(np.arange(len(stretch)), tip)
    assert stretch[walls].min() >= c - 1e-12  # every vertex lies on walls of a and of b
    assert stretch[walls].max() <= a + 1e-12
    np.testing.assert_allclose(surface.stretch(surface.rest), 1, rtol=1e-12)


def test_a_simple_shear_has_the_stretch_of_the_book() -> None:
    """x = X + γ Z: λ = γ/2 + √(1 + γ²/4) in walls along x; a rotation after it changes nothing."""
    shear = 0.7
    wall = Surface(
        np.arange(3),
        np.array([[0.0, 0, 0], [2, 0, 0], [0, 0, 3]]),
        np.array([[0, 1, 2]]),
        np.array([0]),
    )
    at = wall.rest + shear * wall.rest[:, 2:] * [1, 0, 0]
    turned = at @ np.array([[0.6, 0.8, 0], [-0.8, 0.6, 0], [0, 0, 1]])
    expected = shear / 2 + np.sqrt(1 + shear**2 / 4)
    np.testing.assert_allclose(wall.stretch(at), expected, rtol=1e-12)
    np.testing.assert_allclose(wall.stretch(turned), expected, rtol=1e-12)


def test_an_edge_without_tag_is_refused() -> None:
    with pytest.raises(ValueError, match="has no tag"):
        surface_of(np.eye(3)[[0, 1, 2, 0, 1, 2]], np.array([[0, 1, 2, 3, 4, 5]]), {})


def test_the_page_gets_positions_to_half_a_step(shapes: RunShapes, checked: Path) -> None:
    """Against the files themselves; a step is a few thousandths of a millimetre at most."""
    packed = pack(shapes)
    scale = Scale(tuple(packed["offset"]), packed["step"])
    assert scale.step < 0.005
    for name, row in (("40-40-40", 26), ("0-20-40", 5)):
        grid = pyvista.read(checked / "deformed" / f"{name}.vtu")
        points = grid.points + grid.point_data["displacement_mm"]
        got = unpack_positions(packed["shapes"][packed["of"][row]]["at"], scale)
        wanted = points[shapes.surface.nodes]
        assert np.abs(got - wanted).max() <= scale.step / 2 + STEP_ERROR


def test_the_page_gets_stretch_to_half_a_level(shapes: RunShapes) -> None:
    packed = pack(shapes)
    low, high = stretch_range(shapes)
    for shape, kept in zip(shapes.shapes, packed["shapes"], strict=True):
        levels = np.frombuffer(base64.b64decode(kept["stretch"]), dtype=np.uint8)
        got = low + (high - low) * levels / 255
        assert np.abs(got - shape.stretch).max() <= (high - low) / 510 + 1e-12
    np.testing.assert_allclose(packed["stretch"], [low, high], atol=1e-4)


def test_triangles_come_back_part_by_part(shapes: RunShapes) -> None:
    packed = pack(shapes)
    got = np.frombuffer(base64.b64decode(packed["triangles"]), dtype="<u2").reshape(-1, 3)
    np.testing.assert_array_equal(got, shapes.surface.triangles)
    assert sum(packed["parts"]) == len(got)
    assert all(count > 0 for count in packed["parts"])  # three supplies, surface and tip


def test_the_line_is_the_beam(shapes: RunShapes, checked: Path) -> None:
    """Of the design in the folder: from the centroid of the base to the beam's tip."""
    run = read_solid_run(checked)
    centroid = np.append(run.subject.outline.moments.centroid, 0.0)
    for row, place in enumerate(shapes.of):
        line = shapes.shapes[place].line
        np.testing.assert_allclose(line[0], centroid, atol=1e-12)
        np.testing.assert_allclose(line[-1] - centroid, run.subject.beam_tips[row], atol=1e-9)


def test_a_prediction_shows_answers_and_last_stable_shapes(predicted: Path) -> None:
    """Where there is no answer: the ray's last stable shape, at no more than where it ends."""
    run = read_solid_run(predicted)
    found, shapes = run.combinations, read_shapes(run)
    assert found is not None
    assert shapes is not None
    assert shapes.of[0] == 0
    assert not shapes.is_last[0]
    for row in range(1, 27):
        shape = shapes.shapes[shapes.of[row]]
        assert shapes.is_last[row] == (not found.answered[row])
        if found.answered[row]:
            np.testing.assert_allclose(shape.pressures, found.pressures[row])
        else:
            share = shape.pressures.max() / found.pressures[row].max()
            assert shape.pressures.max() <= found.ends_at[row] + 1e-5
            np.testing.assert_allclose(shape.pressures, share * found.pressures[row], atol=1e-5)


def written(file: Path, **options: str) -> Path:
    """A thousand copies of one point, which pack to a thousandth."""
    points = np.ones((100_000, 3))
    meshio.vtu.write(file, meshio.Mesh(points, [("vertex", [[0]])]), **options)
    return file


@pytest.mark.parametrize("options", [{}, {"header_type": "UInt64"}, {"compression": None}])
def test_what_unpacks_within_the_limit(options: dict[str, str], tmp_path: Path) -> None:
    file = written(tmp_path / "a.vtu", **options)
    check_unpacked_size(file, 2_400_100)
    if options.get("compression", "zlib"):
        with pytest.raises(InputError, match="unpacks to more"):
            check_unpacked_size(file, 2_399_999)


def test_a_small_file_that_unpacks_to_gigabytes(tmp_path: Path) -> None:
    """One block of zeros behind a header that says another size; its memory is not taken."""
    packer = zlib.compressobj(9)
    zeros = bytes(2**20)
    block = b"".join(packer.compress(zeros) for _ in range(2**11)) + packer.flush()
    header = np.array([1, 32768, 8, len(block)], dtype=np.uint32).tobytes()
    bomb = base64.b64encode(header).decode() + base64.b64encode(block).decode()
    file = written(tmp_path / "a.vtu")
    text = file.read_text()
    start = text.index(">", text.index("<DataArray")) + 1
    file.write_text(text[:start] + bomb + text[text.index("<", start) :])
    tracemalloc.start()
    with pytest.raises(InputError, match="unpacks to more"):
        _mesh(file)
    assert tracemalloc.get_traced_memory()[1] < MOST_MESH / 4
    tracemalloc.stop()


def test_other_packing_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        _mesh(written(tmp_path / "a.vtu", compression="lzma"))
    assert caught.value.key == "compressor"


@pytest.mark.parametrize(
    ("was", "now"),
    [
        *(("compressor", "other"), ("UInt64", "UInt16"), ("LittleEndian", "Middle")),
        *(("AAAA", "AAA"), ("</DataArray", "<"), ("</", "\0</"), ("binary", "appended")),
    ],
)
def test_damaged_packing_is_one_line(was: str, now: str, tmp_path: Path) -> None:
    file = written(tmp_path / "a.vtu", header_type="UInt64")
    text = file.read_text()
    assert was in text
    file.write_text(text.replace(was, now, 1))
    with pytest.raises(InputError):
        _mesh(file)
