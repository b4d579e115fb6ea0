"""The wedge of 18 nodes: its functions, its quadrature, and continuity over a distorted mesh."""

from math import factorial

import numpy as np
import pytest
from skfem import Basis, MeshWedge1

from femcheck.solid.wedge18 import ElementWedge18, wedge_quadrature
from tests.femcheck.lattice import lattice_extrusion

ELEMENT = ElementWedge18()
NODES = ELEMENT.doflocs[:18]


def functions(X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(18, n) values and (18, 3, n) gradients."""
    both = [ELEMENT.lbasis(X, k) for k in range(18)]
    return np.stack([value for value, _ in both]), np.stack([slope for _, slope in both])


def places(count: int) -> np.ndarray:
    """Random points of the reference wedge."""
    x, y, z = np.random.default_rng(3).uniform(size=(3, count))
    flip = x + y > 1
    x[flip], y[flip] = 1 - x[flip], 1 - y[flip]
    return np.stack([x, y, z])


def test_one_at_its_node_and_zero_at_the_others() -> None:
    np.testing.assert_allclose(functions(NODES.T)[0], np.eye(18), atol=1e-14)


def test_partition_of_unity() -> None:
    values, slopes = functions(places(50))
    np.testing.assert_allclose(values.sum(axis=0), 1.0, atol=1e-14)
    np.testing.assert_allclose(slopes.sum(axis=0), 0.0, atol=1e-13)


def test_gradients_against_finite_differences() -> None:
    X, h = places(20), 1e-6
    slopes = functions(X)[1]
    for axis in range(3):
        step = h * np.eye(3)[:, [axis]]
        measured = (functions(X + step)[0] - functions(X - step)[0]) / (2 * h)
        np.testing.assert_allclose(slopes[:, axis], measured, atol=1e-8)


@pytest.mark.parametrize("power", [(a, b) for a in range(3) for b in range(3 - a)])
@pytest.mark.parametrize("along", range(3))
def test_reproduces_quadratic_times_quadratic(power: tuple[int, int], along: int) -> None:
    def f(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
        return x ** power[0] * y ** power[1] * z**along

    X = places(20)
    np.testing.assert_allclose(f(*NODES.T) @ functions(X)[0], f(*X), atol=1e-13)


def test_functions_of_triangles_are_zero() -> None:
    for k in (18, 19):
        for part in ELEMENT.lbasis(places(5), k):
            assert not part.any()


def test_quadrature_is_exact_to_its_degree() -> None:
    """∫ x^a y^b z^c over the wedge = a! b! / (a + b + 2)! / (c + 1).

    Degree 2 in the triangle and 3 along the axis is what forces of uniform stress need on wedges
    with straight edges.
    """
    (x, y, z), weights = wedge_quadrature()
    assert (weights > 0).all()
    for a in range(3):
        for b in range(3 - a):
            for c in range(6):
                exact = factorial(a) * factorial(b) / factorial(a + b + 2) / (c + 1)
                assert weights @ (x**a * y**b * z**c) == pytest.approx(exact, abs=1e-14)


def test_continuous_across_facets_of_distorted_wedges() -> None:
    """A random function seen from both sides of every inner facet, edges included."""
    body = lattice_extrusion()
    mesh = MeshWedge1(body.points.T.copy(), body.wedges.T.astype(np.int32).copy())
    basis = Basis(mesh, ELEMENT, quadrature=wedge_quadrature())
    names = basis.element_dofs
    value = np.random.default_rng(2).uniform(size=basis.N)
    # corners of the facets of the reference wedge: two triangles, three quadrangles
    facets = [(0, 1, 2), (3, 4, 5), (0, 1, 3, 4), (1, 2, 4, 5), (0, 2, 3, 5)]
    corners = mesh.p[:, mesh.t]
    seen: dict[tuple[int, ...], list[tuple[np.ndarray, np.ndarray]]] = {}
    on_triangle = np.array([[0.2, 0.3, 0.5], [0.6, 0.3, 0.1], [0.5, 0.5, 0.0]])
    s, t = np.array([[0.2, 0.9, 0.4], [0.7, 0.1, 0.0]])
    on_quadrangle = np.stack([(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t], axis=1)
    for facet in facets:
        for e in range(mesh.t.shape[1]):
            # the same places for both neighbours: from the corner of the lowest index
            order = sorted(facet, key=lambda k: mesh.t[k, e])
            if len(facet) == 4:
                first = order[0]
                other = next(k for k in order if k != first and k // 3 == first // 3)
                order = [first, other, (first + 3) % 6, (other + 3) % 6]
            weights = on_triangle if len(facet) == 3 else on_quadrangle
            place = weights @ corners[:, order, e].T
            here = value[names[:18, e]] @ functions((weights @ NODES[order]).T)[0]
            key = tuple(sorted(mesh.t[list(facet), e]))
            seen.setdefault(key, []).append((place, here))
    shared = [pair for pair in seen.values() if len(pair) == 2]
    triangles, quadrangles = 44, 2 * (3 * 44 - 32) // 2  # between two layers; in both of them
    assert len(shared) == triangles + quadrangles
    for (place, one), (there, two) in shared:
        np.testing.assert_allclose(place, there, atol=1e-12)
        np.testing.assert_allclose(one, two, atol=1e-12)
