"""Torsion and shear of outlines: closed forms, and finite elements of another library."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from beamopt import load_design
from beamopt.base.arrays import FloatArray
from beamopt.outline.build import build_outline
from beamopt.outline.outline import Loop, Outline, Piece
from beamopt.outline.saint_venant import outline_saint_venant
from beamopt.outline.triangulation import Triangulation, quadratic, triangulate
from beamopt.scene.bundled import bundled_scenes
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.moments import Moments
from beamopt.section.saint_venant import SaintVenant, saint_venant
from beamopt.section.seal import SealRules
from femcheck.mesh.geo import SectionSizes
from femcheck.mesh.gmsh_section import Mesher
from femcheck.mesh.section_mesh import SectionMesh

TURN = np.array([[0.0, -1.0], [1.0, 0.0]])
SEALED = {
    file.stem: file
    for file in (
        bundled_scenes()["sealed-section"].with_name("sealed_section.json"),
        *sorted((Path(__file__).parents[2] / "data" / "sealed_designs").glob("*.json")),
    )
}


def outline_of(*loops: list[tuple[float, float]] | FloatArray) -> Outline:
    """One piece: around it, then around its holes, material to the left."""
    first, *holes = (Loop(np.array(points, dtype=float), 0) for points in loops)
    radius = float(np.hypot(*first.points.T).max())
    return Outline((Piece(first, tuple(holes)),), (), (), Moments(np.zeros((4, 6))), radius)


def polygon(radius: float, corners: int) -> FloatArray:
    angles = 2 * np.pi * np.arange(corners) / corners
    return radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def test_square() -> None:
    """I_T = 0.1405770 a⁴ (Timoshenko and Goodier, 109), κ = 5/6 at ν = 0."""
    found = outline_saint_venant(outline_of([(0, 0), (3, 0), (3, 3), (0, 3)]), 0.0)
    assert found.torsion_constant == pytest.approx(0.1405770 * 3**4, rel=2e-3)
    np.testing.assert_allclose(found.shear_centre, 0, atol=2e-3)
    np.testing.assert_allclose(found.shear_area, 5 / 6 * 9 * np.eye(2), rtol=2e-3, atol=5e-3)


def test_equilateral_triangle() -> None:
    """I_T = h⁴ / (15 √3), a cubic stress function; the shear centre is the centroid."""
    h = 3.0
    found = outline_saint_venant(outline_of(polygon(2 * h / 3, 3)), 0.3)
    assert found.torsion_constant == pytest.approx(h**4 / (15 * np.sqrt(3)), rel=2e-3)
    np.testing.assert_allclose(found.shear_centre, 0, atol=2e-3)


def test_ring() -> None:
    """I_T = π (b⁴ − a⁴) / 2; polygons of 240 sides have 5e-4 less."""
    found = outline_saint_venant(outline_of(polygon(25, 240), polygon(10, 240)[::-1]))
    assert found.torsion_constant == pytest.approx(np.pi / 2 * (25**4 - 10**4), rel=1e-3)
    np.testing.assert_allclose(found.shear_centre, 0, atol=1e-3)


def test_two_squares_side_by_side_twist_like_two() -> None:
    """Pieces slide along one another freely."""
    square = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    one = outline_of(square)
    other = outline_of(square + 5.0)
    both = replace(other, pieces=(*one.pieces, *other.pieces))
    alone, found = outline_saint_venant(one), outline_saint_venant(both)
    assert found.torsion_constant == pytest.approx(2 * alone.torsion_constant, rel=1e-4)
    np.testing.assert_allclose(found.shear_centre, 0, atol=1e-2)


def test_an_open_thin_tube_has_its_shear_centre_outside() -> None:
    """A half ring: e = 4 R / π from its middle (Timoshenko); the next term is (t/R)²."""
    angles = np.radians(np.linspace(-90, 90, 61))
    arc = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    found = outline_saint_venant(outline_of(np.concatenate([10.1 * arc, 9.9 * arc[::-1]])), 0.3)
    centroid = 2 * 10 / np.pi
    expected = [4 * 10 / np.pi - centroid, 0.0]
    np.testing.assert_allclose(found.shear_centre, expected, atol=0.03)


@cache
def meshed(name: str) -> SectionMesh:
    """The section as gmsh triangulates it, every triangle cut into sixteen."""
    import skfem

    mesh = Mesher().mesh(load_design(SEALED[name]).outline, SectionSizes(factor=0.4))
    assert isinstance(mesh, SectionMesh)
    fine = skfem.MeshTri(mesh.points.T.copy(), mesh.triangles.T.copy()).refined(2)
    return SectionMesh(fine.p.T, fine.t.T.astype(np.int64), mesh.edges, mesh.supply)


def reference(name: str) -> tuple[float, FloatArray]:
    """I_T and the shear centre by scikit-fem: ∫∇v·∇ω = ∫∇v·(y, −x), I_T = ∫(x² + y²) − ω·load."""
    import skfem
    from skfem.helpers import dot, grad

    section = meshed(name)
    c = load_design(SEALED[name]).outline.moments.centroid
    mesh = skfem.MeshTri(section.points.T.copy(), section.triangles.T.copy())
    basis = skfem.Basis(mesh, skfem.ElementTriP2(), intorder=4)
    stiffness = skfem.BilinearForm(lambda u, v, w: dot(grad(u), grad(v))).assemble(basis)
    load = skfem.LinearForm(
        lambda v, w: (w.x[1] - c[1]) * grad(v)[0] - (w.x[0] - c[0]) * grad(v)[1]
    ).assemble(basis)
    first = [
        skfem.LinearForm(lambda v, w, i=i: v * (w.x[i] - c[i])).assemble(basis) for i in (0, 1)
    ]
    second = np.empty((2, 2))
    for i in (0, 1):
        for j in (0, 1):
            product = skfem.Functional(lambda w, i=i, j=j: (w.x[i] - c[i]) * (w.x[j] - c[j]))
            second[i, j] = product.assemble(basis)
    warping = skfem.solve(*skfem.condense(stiffness, load, D=np.array([0])))
    constant = float(np.trace(second) - warping @ load)
    return constant, TURN @ np.linalg.solve(second, [warping @ one for one in first])


@pytest.mark.parametrize("name", SEALED)
def test_sealed_sections_against_another_librarys_elements(name: str) -> None:
    """Triangles of gmsh, cut in sixteen, solved by scikit-fem; κA by ours on the same mesh.

    Measured: 0.014…0.07 % in I_T, 0.006 mm, 0.02…0.1 % in κA; asked for are 0.5 % and 0.1 mm.
    """
    constant, centre = reference(name)
    found = outline_saint_venant(load_design(SEALED[name]).outline, 0.5)
    assert found.torsion_constant == pytest.approx(constant, rel=1.5e-3)
    np.testing.assert_allclose(found.shear_centre, centre, atol=0.02)
    section = meshed(name)
    fine = saint_venant(*quadratic(Triangulation(section.points, section.triangles)), 0.5)
    ratio = np.linalg.solve(fine.shear_area, found.shear_area)
    np.testing.assert_allclose(ratio, np.eye(2), atol=2e-3)


@pytest.mark.parametrize("name", SEALED)
def test_its_triangles_are_few(name: str) -> None:
    """Its time grows with them: 8,000 nodes take less than 0.1 s."""
    outline = load_design(SEALED[name]).outline
    edges = sum(len(loop.points) for piece in outline.pieces for loop in piece.loops)
    mesh = triangulate(outline)
    assert len(mesh.triangles) < 10 * edges
    assert len(quadratic(mesh)[0]) < 10_000


def turned(found: SaintVenant, turn: FloatArray, size: float) -> SaintVenant:
    return SaintVenant(
        size**4 * found.torsion_constant,
        size * turn @ found.shear_centre,
        size**2 * turn @ found.shear_area @ turn.T,
    )


@settings(max_examples=5)
@given(angle=st.floats(0, 6.3), size=st.sampled_from([0.02, 0.5, 30.0]))
def test_a_turned_and_scaled_outline(angle: float, size: float) -> None:
    """Another triangulation: equal to within its error."""
    outline = load_design(SEALED["search_2"]).outline
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    loops = [size * loop.points @ turn.T + 3.0 for loop in outline.pieces[0].loops]
    found = outline_saint_venant(outline_of(*loops))
    expected = turned(outline_saint_venant(outline), turn, size)
    assert found.torsion_constant == pytest.approx(expected.torsion_constant, rel=1e-3)
    np.testing.assert_allclose(found.shear_centre, expected.shear_centre, atol=0.02 * size)
    scale = np.linalg.norm(expected.shear_area, 2)
    np.testing.assert_allclose(found.shear_area, expected.shear_area, atol=2e-3 * scale)


@settings(max_examples=8)
@given(
    seed=st.integers(0, 10_000),
    count=st.integers(3, 60),
    rounding=st.sampled_from([0.0, 0.5]),
    span=st.sampled_from([360.0, 150.0]),
)
def test_triangles_fill_the_material_between_its_own_edges(
    seed: int, count: int, rounding: float, span: float
) -> None:
    grid = PolarGrid(10.0, 25.0, 64, 180, 0.0, span)
    points = FeaturePoints.random(grid, count, np.random.default_rng(seed))
    outline = build_outline(grid, points, SealRules(1.0, 0.9, rounding, 1.0))
    mesh = triangulate(outline)
    a, b, c = (mesh.points[mesh.triangles[:, k]] for k in range(3))
    u, v = b - a, c - a
    areas = (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / 2
    assert areas.min() > 0
    assert areas.sum() == pytest.approx(outline.moments.area, rel=1e-12)
    sides = np.sort(np.stack([mesh.triangles, np.roll(mesh.triangles, -1, 1)], 2).reshape(-1, 2))
    sides, used = np.unique(sides, axis=0, return_counts=True)
    assert used.max() <= 2
    p, q = mesh.points[sides[used == 1].T]
    length = sum(
        np.hypot(*(np.roll(loop.points, -1, 0) - loop.points).T).sum()
        for piece in outline.pieces
        for loop in piece.loops
    )
    assert np.hypot(*(q - p).T).sum() == pytest.approx(length, rel=1e-9)
