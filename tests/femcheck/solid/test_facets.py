"""Wall facets: shape functions, and volumes of closed surfaces."""

import numpy as np
import pytest

from femcheck.assembly.walls import add_wall_forces, wall_volumes
from femcheck.solid.facets import FacetShape, facet_shape

KINDS = [(3, 1), (3, 2), (4, 1), (4, 2)]
TETRAHEDRON = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
TRIANGLES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]
BOX = np.array([[i, j, k] for k in (0.0, 1) for i, j in ((0.0, 0.0), (1, 0), (1, 1), (0, 1))])
SIDES = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]


def closed(shape: FacetShape, corners: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and facets, outward, of a tetrahedron or a box."""
    points, facets = (TETRAHEDRON, TRIANGLES) if corners == 3 else (BOX, SIDES)
    at = np.concatenate([shape.places @ points[list(facet)] for facet in facets])
    nodes, index = np.unique(np.round(at, 12), axis=0, return_inverse=True)
    return nodes, index.reshape(len(facets), -1)


def enclosed(x: np.ndarray, facets: np.ndarray, shape: FacetShape) -> float:
    volumes = np.zeros(3)
    arrays = (shape.values, shape.along, shape.across, shape.weights)
    wall_volumes(x, facets, np.ones(len(facets), dtype=np.int64), *arrays, volumes)
    return -volumes[0]  # facets of a chamber's wall point inwards


@pytest.mark.parametrize(("corners", "degree"), KINDS)
def test_shape_functions(corners: int, degree: int) -> None:
    shape = facet_shape(corners, degree)
    np.testing.assert_allclose(shape.values.sum(axis=1), 1, atol=1e-13)
    np.testing.assert_allclose(shape.along.sum(axis=1), 0, atol=1e-12)
    np.testing.assert_allclose(shape.across.sum(axis=1), 0, atol=1e-12)
    assert shape.weights.sum() == pytest.approx(0.5 if corners == 3 else 1.0)
    # s and t themselves are among what the functions span: their derivatives are known
    corner_s = np.array([0.0, 1, 0] if corners == 3 else [0.0, 1, 1, 0])
    corner_t = np.array([0.0, 0, 1] if corners == 3 else [0.0, 0, 1, 1])
    s, t = shape.places @ corner_s, shape.places @ corner_t
    for f, by_s, by_t in ((s, 1, 0), (t, 0, 1)):
        np.testing.assert_allclose(shape.along @ f, by_s, atol=1e-12)
        np.testing.assert_allclose(shape.across @ f, by_t, atol=1e-12)
    if degree == 2:
        at_s = shape.values @ s
        np.testing.assert_allclose(shape.along @ s**2, 2 * at_s, atol=1e-12)


@pytest.mark.parametrize(("corners", "degree"), KINDS)
def test_volumes_of_closed_surfaces_are_exact(corners: int, degree: int) -> None:
    shape = facet_shape(corners, degree)
    nodes, facets = closed(shape, corners)
    whole = 1 / 6 if corners == 3 else 1.0
    assert enclosed(nodes, facets, shape) == pytest.approx(whole, rel=1e-13)
    A = np.array([[1.3, 0.2, -0.1], [0.4, 0.8, 0.3], [-0.2, 0.1, 1.7]])
    moved = nodes @ A.T + [5.0, -3.0, 8.0]
    assert enclosed(moved, facets, shape) == pytest.approx(np.linalg.det(A) * whole, rel=1e-12)


@pytest.mark.parametrize("corners", [3, 4])
def test_curved_surfaces_need_no_more_points(corners: int) -> None:
    """Random quadratic facets: x → −⅓∮ is a cubic polynomial, exact as its differences are."""
    shape = facet_shape(corners, 2)
    nodes, facets = closed(shape, corners)
    nodes = nodes + np.random.default_rng(8).uniform(-0.1, 0.1, nodes.shape)
    start = enclosed(nodes, facets, shape)
    elsewhere = nodes + np.array([3.0, -7.0, 11.0])
    assert enclosed(elsewhere, facets, shape) == pytest.approx(start, rel=1e-12)
    c, s = np.cos(0.7), np.sin(0.7)
    turned = nodes @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    assert enclosed(turned, facets, shape) == pytest.approx(start, rel=1e-12)
    # by tetrahedra over a fine subdivision of every facet, from the origin, without quadrature
    n = 200
    fine = np.linspace(0, 1, n + 1)
    total = 0.0
    for facet in facets:
        y = _surface(shape, corners, nodes[facet], fine)
        a, b, c_, d = y[:-1, :-1], y[1:, :-1], y[1:, 1:], y[:-1, 1:]
        halves = (
            np.einsum("...i,...i", a, np.cross(b, c_)),
            np.einsum("...i,...i", a, np.cross(c_, d)),
        )
        total += float(sum(half.sum() for half in halves)) / 6
    assert start == pytest.approx(total, rel=1e-4)


def _surface(shape: FacetShape, corners: int, nodes: np.ndarray, fine: np.ndarray) -> np.ndarray:
    """The facet at a grid of parameters; a triangle as a square with one side shrunk to a point."""
    corner_s = np.array([0.0, 1, 0] if corners == 3 else [0.0, 1, 1, 0])
    corner_t = np.array([0.0, 0, 1] if corners == 3 else [0.0, 0, 1, 1])
    s, t = shape.places @ corner_s, shape.places @ corner_t
    powers = [(a, b) for a in range(3) for b in range(3) if corners == 4 or a + b <= 2]
    monomials = np.stack([s**a * t**b for a, b in powers], axis=1)
    factors = np.linalg.solve(monomials, nodes)
    u, v = np.meshgrid(fine, fine, indexing="ij")
    if corners == 3:
        u, v = u * (1 - v), v
    return np.einsum("kij,kc->ijc", np.stack([u**a * v**b for a, b in powers]), factors)


@pytest.mark.parametrize(("corners", "degree"), KINDS)
def test_force_is_the_gradient_of_the_volume(corners: int, degree: int) -> None:
    shape = facet_shape(corners, degree)
    nodes, facets = closed(shape, corners)
    nodes = nodes + np.random.default_rng(9).uniform(-0.1, 0.1, nodes.shape)
    arrays = (shape.values, shape.along, shape.across, shape.weights)
    forces = np.zeros_like(nodes)
    add_wall_forces(nodes, facets, np.full(len(facets), -1.0), *arrays, forces)
    h = 1e-5
    for node in range(len(nodes)):
        for axis in range(3):
            step = np.zeros_like(nodes)
            step[node, axis] = h
            change = enclosed(nodes + step, facets, shape) - enclosed(nodes - step, facets, shape)
            assert forces[node, axis] == pytest.approx(change / (2 * h), abs=1e-9)
    np.testing.assert_allclose(forces.sum(axis=0), 0, atol=1e-14)
    np.testing.assert_allclose(np.cross(nodes, forces).sum(axis=0), 0, atol=1e-14)
