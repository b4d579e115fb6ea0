"""The triangulation against scipy's and against the definition, in exact integers."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations, pairwise, permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial import Delaunay

from beamopt.base.arrays import FloatArray
from beamopt.section.delaunay import _in_circle, delaunay_edges
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid

Edges = set[tuple[int, int]]
Place = tuple[int, int]


def edges_of(xy: FloatArray | NDArray[np.int64]) -> Edges:
    x, y = np.asarray(xy, dtype=np.float64).T.copy()
    found = [(int(a), int(b)) for a, b in delaunay_edges(x, y)]
    assert all(a < b for a, b in found)
    assert len(set(found)) == len(found)  # every edge once
    return set(found)


def edges_by_scipy(xy: FloatArray) -> Edges:
    triangles = Delaunay(xy).simplices
    return {tuple(sorted(map(int, pair))) for t in triangles for pair in combinations(t, 2)}


def turn(a: Place, b: Place, c: Place) -> int:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def points_on_hull(places: list[Place]) -> int:
    """How many of the places lie on the boundary of their convex hull."""
    on_hull = set()
    for a, b in permutations(places, 2):
        turns = [turn(a, b, c) for c in places]
        if min(turns) >= 0:  # nothing to the right: a piece of the boundary
            on_hull |= {c for c, t in zip(places, turns, strict=True) if t == 0}
    return len(on_hull)


def has_empty_circle(a: Place, b: Place, places: list[Place]) -> bool:
    """Whether a circle through a and b holds no other place inside.

    Its centre is m + t n with m the middle and n normal to ab; p is not inside where
    |p − m|² − 2 t (p − m)·n ≥ |a − m|².
    """
    low, high = [], []
    n = a[1] - b[1], b[0] - a[0]
    for p in places:
        if p in (a, b):
            continue
        # times 4 and 2, to stay with integers
        dx, dy = 2 * p[0] - a[0] - b[0], 2 * p[1] - a[1] - b[1]
        room = dx * dx + dy * dy - n[0] * n[0] - n[1] * n[1]
        side = 4 * (dx * n[0] + dy * n[1])
        if side == 0 and room < 0:
            return False
        if side > 0:
            high.append(Fraction(room, side))
        if side < 0:
            low.append(Fraction(room, side))
    return not low or not high or max(low) <= min(high)


def cross(edge: tuple[Place, Place], other: tuple[Place, Place]) -> bool:
    (a, b), (c, d) = edge, other
    return turn(a, b, c) * turn(a, b, d) < 0 and turn(c, d, a) * turn(c, d, b) < 0


def assert_delaunay(xy: NDArray[np.int64]) -> None:
    """As many edges as a triangulation of the n places has, each with an empty circle, uncrossed.

    3n − 3 − h edges, h places on the hull's boundary, for places that are not all on one line. An
    edge with a place on it has no empty circle, so these edges meet at places only.
    """
    points: list[Place] = [(int(x), int(y)) for x, y in xy]
    first = {}
    for k, place in enumerate(points):
        first.setdefault(place, k)
    places = list(first)
    edges = edges_of(xy)
    # a point at the place of an earlier one has no neighbours
    assert {k for edge in edges for k in edge} <= set(first.values())
    ends = [(points[a], points[b]) for a, b in edges]
    assert all(has_empty_circle(a, b, places) for a, b in ends)
    assert not any(cross(one, two) for one, two in combinations(ends, 2))
    assert len(edges) == 3 * len(places) - 3 - points_on_hull(places)


@pytest.mark.parametrize("count", [3, 4, 5, 10, 40, 100, 400])
def test_generic_points_agree_with_scipy(count: int) -> None:
    rng = np.random.default_rng(count)
    for _ in range(5):
        xy = rng.uniform(-25, 25, size=(count, 2))
        assert edges_of(xy) == edges_by_scipy(xy)


@given(st.integers(0, 2**32), st.integers(3, 60))
def test_points_in_a_ring_agree_with_scipy(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    r, phi = np.sqrt(rng.uniform(100, 625, count)), rng.uniform(0, 2 * np.pi, count)
    xy = np.stack([r * np.cos(phi), r * np.sin(phi)], axis=1)
    assert edges_of(xy) == edges_by_scipy(xy)


@given(st.integers(0, 2**32))
def test_edges_of_generic_points_do_not_depend_on_their_order(seed: int) -> None:
    rng = np.random.default_rng(seed)
    xy, order = rng.uniform(-25, 25, size=(30, 2)), rng.permutation(30)
    renamed = {tuple(sorted((int(order[a]), int(order[b])))) for a, b in edges_of(xy[order])}
    assert renamed == edges_of(xy)


@pytest.mark.parametrize(("rows", "columns"), [(2, 2), (2, 7), (4, 4), (3, 8)])
def test_lattices(rows: int, columns: int) -> None:
    """Every square of four neighbours lies on a circle; rows lie on lines."""
    xy = np.stack(np.mgrid[:rows, :columns], axis=-1).reshape(-1, 2)
    for order in (np.arange(len(xy)), np.random.default_rng(1).permutation(len(xy))):
        assert_delaunay(xy[order])


def triangular(xy: list[Place]) -> bool:
    return any(turn(a, b, c) for a, b, c in combinations(set(xy), 3))


@given(st.lists(st.tuples(st.integers(-3, 3), st.integers(-3, 3)), min_size=3, max_size=24))
def test_any_lattice_points(xy: list[Place]) -> None:
    """Coincident, collinear and cocircular points in any order."""
    if triangular(xy):
        assert_delaunay(np.array(xy))
    else:
        assert_on_a_line(xy)


@pytest.mark.parametrize("seed", range(5))
def test_points_on_circles_and_their_centre(seed: int) -> None:
    """Twelve integer points on each circle x² + y² = 25 m², many of them cocircular."""
    first = [(5, 0), (4, 3), (3, 4), (0, 5), (-3, 4), (-4, 3)]
    circle = [(s * x, s * y) for x, y in first for s in (1, -1)]
    places = np.array([(0, 0), *circle, *((3 * x, 3 * y) for x, y in circle)])
    assert_delaunay(np.random.default_rng(seed).permutation(places))


@pytest.mark.parametrize("radial", [1, 3, 8])
def test_element_centroids(radial: int) -> None:
    """The search's own points: on the lattice of 2⁻²⁵ of the extent they are nearly degenerate."""
    grid = PolarGrid(radial=radial, angular=12)
    rng = np.random.default_rng(radial)
    points = FeaturePoints.random(grid, 40, rng)
    xy = np.stack([points.x, points.y], axis=1)
    lattice = np.rint(xy * 2**19).astype(np.int64)  # extent 16…32 mm, of which 2²⁴ parts
    assert_delaunay(lattice)
    assert edges_of(xy) == edges_of(lattice)


def assert_on_a_line(xy: list[Place]) -> None:
    """Neighbours follow each other along the line; the first point of a place stands for it."""
    places = sorted(set(xy))
    first = [xy.index(place) for place in places]
    expected = {(min(pair), max(pair)) for pair in pairwise(first)}
    assert edges_of(np.array(xy, dtype=np.float64).reshape(-1, 2)) == expected


@pytest.mark.parametrize("step", [(1, 0), (0, -1), (2, 3)])
def test_collinear_points_in_any_order(step: tuple[int, int]) -> None:
    for order in permutations(range(5)):
        assert_on_a_line([(k * step[0] + 7, k * step[1] - 5) for k in order])


def test_coincident_collinear_points_in_any_order() -> None:
    for order in permutations([0, 0, 1, 2, 2]):
        assert_on_a_line([(3 * k, k) for k in order])


@given(st.lists(st.integers(-4, 4), max_size=12), st.integers(-3, 3), st.integers(1, 3))
def test_any_points_on_a_line(along: list[int], dx: int, dy: int) -> None:
    assert_on_a_line([(k * dx + 1, k * dy) for k in along])


def test_a_coincident_point_has_no_neighbours() -> None:
    """Whether it comes before or after the first triangle, on the hull or inside."""
    square = [(0, 0), (4, 0), (4, 4), (0, 4), (2, 1)]
    for k in range(5):
        for at in range(6):
            xy = [*square[:at], square[k], *square[at:]]
            assert_delaunay(np.array(xy))
    assert_delaunay(np.array(square * 3))


@pytest.mark.parametrize("count", [0, 1, 2, 5])
def test_points_all_in_one_place_have_no_edges(count: int) -> None:
    edges = delaunay_edges(np.full(count, 3.0), np.full(count, -1.0))
    assert edges.shape == (0, 2)
    assert delaunay_edges(np.zeros(count), np.zeros(count)).shape == (0, 2)


def test_two_points_and_three_points() -> None:
    assert edges_of(np.array([[3.0, 1.0], [0.0, 0.0]])) == {(0, 1)}
    for order in permutations([(0, 0), (5, 1), (2, 3)]):  # left and right turns
        assert edges_of(np.array(order)) == {(0, 1), (0, 2), (1, 2)}


@pytest.mark.parametrize("size", [1e-9, 1e-3, 1.0, 1e6, 1e100])
def test_size_does_not_matter(size: float) -> None:
    xy = np.random.default_rng(7).uniform(-1, 1, size=(50, 2))
    assert edges_of(size * xy) == edges_by_scipy(xy)
    lattice = np.stack(np.mgrid[:4, :5], axis=-1).reshape(-1, 2).astype(np.float64)
    n, h = 20, 14
    assert len(edges_of(size * lattice)) == 3 * n - 3 - h


@pytest.mark.parametrize("size", [3, 40, 2**10, 2**14, 2**20])
def test_a_cluster_far_from_other_points_is_exact(size: int) -> None:
    """The determinants of few and of many bits: every digit of their sum decides somewhere."""
    far = [(2**24, 2**24), (-(2**24), 2**23), (7, -(2**24))]
    rng = np.random.default_rng(size)
    for _ in range(5):
        assert_delaunay(np.concatenate([rng.integers(-size, size, size=(20, 2)), far]))


def points_on_a_circle() -> NDArray[np.int64]:
    """(128, 2) integer points on the circle of radius 5·13·17·29·37 around the origin.

    Each prime is |z|² of a Gaussian integer; products of z² or its conjugate, turned by 90° steps.
    """
    points = [(1, 0), (0, 1), (-1, 0), (0, -1)]
    for a, b in ((2, 1), (3, 2), (4, 1), (5, 2), (6, 1)):
        u, v = a * a - b * b, 2 * a * b
        points = [(u * x - s * v * y, u * y + s * v * x) for x, y in points for s in (1, -1)]
    return np.array(points)


@pytest.mark.parametrize(("scale", "shift"), [(13, 0), (1, 0), (1, 1234567)])
@pytest.mark.parametrize("off", [0, 1, -1])
def test_points_on_or_one_step_off_a_large_circle(scale: int, shift: int, off: int) -> None:
    circle = points_on_a_circle() * scale
    assert len({*map(tuple, circle.tolist())}) == 128
    assert (np.sum(circle**2, axis=1) == (1185665 * scale) ** 2).all()
    chosen = np.random.default_rng(9).choice(circle, 20, replace=False)
    chosen[7, 0] += off
    assert_delaunay(chosen + shift)


def in_circle_by_python(a: Place, b: Place, c: Place, p: Place) -> bool:
    """Sign of the determinant in integers of any size."""
    (ax, ay), (bx, by), (cx, cy) = ((q[0] - p[0], q[1] - p[1]) for q in (a, b, c))
    return (
        (ax * ax + ay * ay) * (bx * cy - by * cx)
        + (bx * bx + by * by) * (cx * ay - cy * ax)
        + (cx * cx + cy * cy) * (ax * by - ay * bx)
    ) > 0


@pytest.mark.parametrize("size", [2, 2**12, 2**16, 2**24])
def test_the_circle_predicate_is_exact(size: int) -> None:
    """Tested by itself, as a triangulation seldom asks for what doubles can not tell."""
    N = 13 * 1185665
    outside = [(N, 1), (-1, N), (-N, 1), (1, -N)]  # by 1/(2 N)
    rng = np.random.default_rng(size)
    anywhere = rng.integers(-size, size, size=(100, 2), endpoint=True)
    corners = [(s * size, t * size) for s in (1, -1) for t in (1, -1)]
    for places in (np.concatenate([13 * points_on_a_circle(), outside]), [*anywhere, *corners]):
        points = [(int(x), int(y)) for x, y in places]
        x, y = np.array(points).T.copy()
        for quadruple in rng.integers(len(points), size=(5000, 4)).tolist():
            a, b, c, p = (points[k] for k in quadruple)
            expected = in_circle_by_python(a, b, c, p)
            assert _in_circle(x, y, *quadruple) == expected


def test_points_that_differ_by_less_than_the_lattice_are_one() -> None:
    x, y = np.array([20.0, 20.0 + 1e-9, -20.0, 0.0]), np.array([0.0, 0.0, 1.0, 20.0])
    assert edges_of(np.stack([x, y], axis=1)) == {(0, 2), (0, 3), (2, 3)}
