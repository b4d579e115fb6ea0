"""Section meshes by gmsh against the outlines that they are of."""

from collections.abc import Callable

import numpy as np
import pytest

from beamopt.outline.outline import Outline
from femcheck.mesh.extrusion import extrude, stations
from femcheck.mesh.geo import SectionSizes, geo_script
from femcheck.mesh.gmsh_section import Mesher, MeshFailure, MeshProblem
from femcheck.mesh.section_mesh import SectionMesh
from femcheck.mesh.wall_thickness import thickness_behind
from tests.femcheck import sections

SOURCES: dict[str, Callable[[], Outline]] = {
    "three chambers": sections.three_chambers,
    "voronoi": lambda: sections.voronoi(3),
    "wall of 0.5 mm": lambda: sections.thin_wall(0.5),
    "wall of 0.4 mm": lambda: sections.thin_wall(0.4),
    "island": sections.island,
}


def meshed(outline: Outline, sizes: SectionSizes | None = None) -> SectionMesh:
    mesh = Mesher().mesh(outline, sizes or SectionSizes())
    assert isinstance(mesh, SectionMesh), str(mesh)
    return mesh


@pytest.fixture(params=list(SOURCES), scope="module")
def both(request: pytest.FixtureRequest) -> tuple[Outline, SectionMesh]:
    outline = SOURCES[request.param]()
    return outline, meshed(outline)


def loops_of(outline: Outline) -> list[tuple[np.ndarray, int]]:
    return [(loop.points, loop.supply) for piece in outline.pieces for loop in piece.loops]


def test_the_sections_are_what_they_are_called() -> None:
    assert len(sections.island().islands) == 1
    assert len(sections.island().pieces) == 2
    assert not sections.three_chambers().faults
    for wall in (0.4, 0.5):
        # drawn along radii: thinner than in the middle where they begin
        assert thinnest_behind_chambers(sections.thin_wall(wall)) == pytest.approx(
            wall * 14 / 17.5, rel=0.1
        )


def thinnest_behind_chambers(outline: Outline) -> float:
    loops = loops_of(outline)
    a = np.concatenate([points for points, _ in loops])
    b = np.concatenate([np.roll(points, -1, axis=0) for points, _ in loops])
    supply = np.concatenate([np.full(len(points), supply) for points, supply in loops])
    return float(thickness_behind(a, b)[supply > 0].min())


def test_moments_are_the_outline_s(both: tuple[Outline, SectionMesh]) -> None:
    outline, mesh = both
    raw, wanted = mesh.moments.raw, outline.moments.raw
    # first and second moments are measured against those of the whole ring
    scale = wanted[0, 0] * np.array([1, 25, 25, 625, 625, 625])
    assert (np.abs(raw - wanted) < 1e-9 * scale).all()
    # by the triangles, not by the edges
    a, b, c = (mesh.points[mesh.triangles[:, k]] for k in range(3))
    assert mesh.areas.sum() == pytest.approx(wanted[0, 0], rel=1e-9)
    first = (mesh.areas[:, None] * (a + b + c) / 3).sum(axis=0)
    np.testing.assert_allclose(first, wanted[0, 1:3], atol=1e-9 * scale[1])


def test_triangles_are_counter_clockwise_and_whole(both: tuple[Outline, SectionMesh]) -> None:
    _, mesh = both
    assert (mesh.areas > 1e-6).all()
    assert mesh.triangles.min() == 0
    assert np.unique(mesh.triangles).size == mesh.triangles.max() + 1 == len(mesh.points)
    sides = np.concatenate([mesh.triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    assert len(np.unique(sides, axis=0)) == len(sides)
    # sides without a neighbour, in the triangle's direction, are the edges: material on the left
    there = {tuple(side) for side in sides.tolist()}
    boundary = {side for side in there if side[::-1] not in there}
    assert boundary == {tuple(edge) for edge in mesh.edges.tolist()}
    assert len(mesh.edges) == len(boundary)


def test_edges_lie_on_loops_of_their_supply(both: tuple[Outline, SectionMesh]) -> None:
    outline, mesh = both
    middles = mesh.points[mesh.edges].mean(axis=1)
    nearest = np.full(len(middles), np.inf)
    found = np.full(len(middles), -1)
    for points, supply in loops_of(outline):
        away = _distance(middles, points, np.roll(points, -1, axis=0))
        found = np.where(away < nearest, supply, found)
        nearest = np.minimum(nearest, away)
    assert nearest.max() < 1e-9
    np.testing.assert_array_equal(found, mesh.supply)


def _distance(at: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    along = b - a
    t = np.einsum("kec,ec->ke", at[:, None] - a, along) / (along**2).sum(axis=1)
    foot = a + np.clip(t, 0, 1)[..., None] * along
    return np.linalg.norm(at[:, None] - foot, axis=2).min(axis=1)


def test_every_vertex_of_the_outline_is_kept(both: tuple[Outline, SectionMesh]) -> None:
    outline, mesh = both
    kept = {tuple(np.round(point, 9)) for point in mesh.points.tolist()}
    for points, _ in loops_of(outline):
        assert {tuple(np.round(point, 9)) for point in points.tolist()} <= kept


def test_all_jacobians_of_the_wedges_are_positive(both: tuple[Outline, SectionMesh]) -> None:
    """At the corners of straight wedges, where they are least."""
    body = extrude(both[1], stations(100.0, 3, 1.5))
    corners = body.points[body.wedges]
    for k in range(3):
        for low in (0, 3):
            here = corners[:, low + k]
            one = corners[:, low + (k + 1) % 3] - here
            two = corners[:, low + (k + 2) % 3] - here
            up = corners[:, 3 + k] - corners[:, k]
            assert (np.einsum("ec,ec->e", np.cross(one, two), up) > 0).all()


def test_walls_face_out_of_the_material(both: tuple[Outline, SectionMesh]) -> None:
    """A step along a quadrangle's normal leaves all triangles, one against it is in one."""
    mesh = both[1]
    body = extrude(mesh, stations(100.0, 2))
    a, b, above, _ = (body.points[body.walls[:, k]] for k in range(4))
    normal = np.cross(b - a, above - b)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    assert np.abs(normal[:, 2]).max() < 1e-12
    middle = (a + b) / 2
    assert not inside(mesh, (middle + 1e-3 * normal)[:, :2]).any()
    assert inside(mesh, (middle - 1e-3 * normal)[:, :2]).all()


def inside(mesh: SectionMesh, at: np.ndarray) -> np.ndarray:
    corners = [mesh.points[mesh.triangles[:, k]] for k in range(3)]
    within = np.ones((len(at), len(mesh.triangles)), dtype=bool)
    for one, two in zip(corners, corners[1:] + corners[:1], strict=True):
        along, to = two - one, at[:, None] - one
        within &= along[:, 0] * to[..., 1] - along[:, 1] * to[..., 0] > 0
    return within.any(axis=1)


def test_size_follows_the_wall() -> None:
    """Behind a wall of 0.5 mm edges are as short as it asks for; elsewhere they are not."""
    mesh = meshed(sections.thin_wall(0.5))
    ends = mesh.points[mesh.edges]
    long = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    angle = np.degrees(np.arctan2(*ends.mean(axis=1).T[::-1]))
    radius = np.linalg.norm(ends.mean(axis=1), axis=1)
    at_wall = (mesh.supply > 0) & (np.abs(angle - 60) < 1.5) & (radius > 14) & (radius < 21)
    assert at_wall.sum() >= 2 * 7 / (2.5 * 0.5)
    wall = 0.5 * (radius + long / 2) / 17.5  # between radial sides, where an edge in two was cut
    assert (long[at_wall] / wall[at_wall]).max() < 2.5 * 1.05
    assert long[mesh.supply == 0].max() > 2.5


def test_factor_makes_it_coarser() -> None:
    outline = sections.three_chambers(0.5)
    counts = [
        len(meshed(outline, SectionSizes(factor=factor)).triangles) for factor in (0.5, 1.0, 3.0)
    ]
    assert counts[0] > 2 * counts[1]
    assert counts[1] > counts[2]


def test_the_same_mesh_again() -> None:
    one, two = (meshed(sections.three_chambers(0.5)) for _ in range(2))
    np.testing.assert_array_equal(one.points, two.points)
    np.testing.assert_array_equal(one.triangles, two.triangles)


def test_thickness_by_hand() -> None:
    """A square ring: walls 2 and 3 wide, seen from both sides."""
    outer = np.array([[0.0, 0], [10, 0], [10, 10], [0, 10]])
    inner = np.array([[2.0, 3], [2, 8], [7, 8], [7, 3]])
    a = np.concatenate([outer, inner])
    b = np.concatenate([np.roll(outer, -1, axis=0), np.roll(inner, -1, axis=0)])
    np.testing.assert_allclose(thickness_behind(a, b), [3, 3, 2, 2, 2, 2, 3, 3])


def test_script() -> None:
    outline = sections.three_chambers(0.5)
    lines = geo_script(outline, SectionSizes()).splitlines()
    edges = sum(len(points) for points, _ in loops_of(outline))
    assert sum(line.startswith("Point(") for line in lines) == edges
    assert sum(line.startswith("Line(") for line in lines) == edges
    groups = [line for line in lines if line.startswith("Physical")]
    names = [line.partition(" = ")[0] for line in groups]
    assert names == [
        *(f"Physical Curve({k})" for k in (1, 2, 3, 4)),
        "Physical Surface(10)",
    ]
    numbers = [int(n) for line in groups[:4] for n in line.split("{")[1].split("}")[0].split(",")]
    assert sorted(numbers) == list(range(1, edges + 1))


@pytest.mark.parametrize("make", [sections.two_pieces, sections.unsealed])
def test_what_is_fatal_is_not_meshed(make: Callable[[], Outline]) -> None:
    outline = make()
    failure = Mesher("no such program").mesh(outline, SectionSizes())
    assert isinstance(failure, MeshFailure)
    assert failure.problem is MeshProblem.FATAL
    assert str(outline.faults[0]) in str(failure)


def test_stations() -> None:
    np.testing.assert_allclose(stations(100, 4), [0, 25, 50, 75, 100])
    graded = np.diff(stations(100, 6, 1.5))
    np.testing.assert_allclose(graded, graded[::-1])
    assert graded.sum() == pytest.approx(100)
    assert graded[2] / graded[0] == pytest.approx(1.5)
    assert np.diff(stations(7.0, 1, 3.0)).tolist() == [7.0]
    for layers, grading in ((0, 1.0), (3, 0.0), (3, float("nan"))):
        with pytest.raises(ValueError, match="at least 1 and above 0"):
            stations(100, layers, grading)
