"""The shape derivative against differences of the exact polygons' moments."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from beamopt.base.arrays import FloatArray
from beamopt.refine.edges import moment_slopes
from beamopt.section.delaunay import delaunay_edges
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.neighbours import neighbours_of
from tests.beamopt.refine.cases import domain_polygon, exact_moments, points_of, scattered

RING = PolarGrid(radial=32, angular=90)
GRIDS = {
    "ring": (RING, 0.0),
    "disc": (PolarGrid(0.0, 25.0, 32, 90), 0.0),
    "narrow sector": (PolarGrid(10.0, 25.0, 32, 90, 20.0, 115.0), 0.0),
    "wide sector": (PolarGrid(10.0, 25.0, 32, 90, -40.0, 230.0), 0.0),
    "half": (PolarGrid(10.0, 25.0, 32, 90, 10.0, 190.0), 0.0),
    "piece of a disc": (PolarGrid(0.0, 25.0, 32, 90, -170.0, 100.0), 0.0),
    "skin": (RING, 1.3),
    "skin of a disc": (PolarGrid(0.0, 25.0, 32, 90), 2.0),
}
POLYGONS = {name: domain_polygon(grid, skin) for name, (grid, skin) in GRIDS.items()}


def moved(points: FeaturePoints, by: FloatArray) -> FeaturePoints:
    return FeaturePoints(points.x + by[:, 0], points.y + by[:, 1], points.type)


def by_differences(
    points: FeaturePoints, direction: FloatArray, domain: shapely.Polygon, step: float
) -> FloatArray:
    """(4, 6) central difference of the exact moments along a direction (n, 2)."""
    ahead, behind = (exact_moments(moved(points, s * direction), domain) for s in (step, -step))
    return (ahead - behind) / (2 * step)


def assert_slopes(name: str, points: FeaturePoints, seed: int, step: float = 1e-4) -> None:
    grid, skin = GRIDS[name]
    direction = np.random.default_rng(seed).normal(size=(len(points), 2))
    slopes = np.einsum("nxtm,nx->tm", moment_slopes(grid, points, skin), direction)
    expected = by_differences(points, direction, POLYGONS[name], step)
    # to 10⁻⁶ of each integral's largest slope; where nothing moves, of a millimetre of the ring
    units = np.maximum(
        np.abs(expected).max(axis=0), grid.outer_radius ** np.array([1, 2, 2, 3, 3, 3])
    )
    np.testing.assert_allclose(slopes / units, expected / units, atol=1e-6)


@settings(max_examples=3)
@pytest.mark.parametrize("name", list(GRIDS))
@given(seed=st.integers(0, 10_000))
def test_slopes_are_those_of_the_exact_polygons(name: str, seed: int) -> None:
    """In a random direction, points outside of the ring included."""
    assert_slopes(name, scattered(GRIDS[name][0], 10, seed), seed)


@pytest.mark.parametrize("seed", range(2))
def test_points_on_a_lattice(seed: int) -> None:
    """Four cells meet in one place: edges that appear have no length yet."""
    x, y = (part.ravel() for part in np.meshgrid(np.linspace(-24, 24, 5), np.linspace(-24, 24, 5)))
    types = np.random.default_rng(seed).integers(0, 4, x.size)
    assert_slopes("ring", FeaturePoints(x, y, types), seed, 1e-6)


@pytest.mark.parametrize(
    "points",
    [
        points_of((15, 3, 1), (-12, -9, 2)),
        points_of((15, 3, 1), (-12, -9, 2), (-5, 18, 0)),
        points_of((20, 1, 1), (0, 1, 2), (-17, 1, 0), (8, 1, 3)),
        points_of((40, 9, 1), (-90, 4, 2), (3, 400, 3), (17, 2, 0)),
        points_of((90, 0, 1), (-110, 3, 2)),
    ],
    ids=["two", "three", "on a line", "outside", "two outside"],
)
@pytest.mark.parametrize("name", ["ring", "disc", "wide sector", "skin"])
def test_few_points(name: str, points: FeaturePoints) -> None:
    assert_slopes(name, points, 0)


@pytest.mark.parametrize("count", [0, 1])
def test_without_edges_nothing_changes(count: int) -> None:
    slopes = moment_slopes(RING, scattered(RING, count, 0))
    assert slopes.shape == (count, 2, 4, 6)
    assert not slopes.any()


@pytest.mark.parametrize("count", [0, 1, 2, 30])
def test_neighbours_are_the_edges_from_both_ends(count: int) -> None:
    points = scattered(RING, count, 8)
    edges = delaunay_edges(points.x, points.y)
    begin, neighbours = neighbours_of(edges, count)
    assert begin.shape == (count + 1,)
    listed = {(k, int(n)) for k in range(count) for n in neighbours[begin[k] : begin[k + 1]]}
    assert listed == {(int(a), int(b)) for edge in edges for a, b in (edge, edge[::-1])}
    assert len(neighbours) == len(listed)


def test_a_twin_has_no_slopes() -> None:
    points = scattered(RING, 12, 5)
    twin = FeaturePoints(
        np.append(points.x, points.x[3]),
        np.append(points.y, points.y[3]),
        np.append(points.type, (points.type[3] + 1) % 4),
    )
    slopes = moment_slopes(RING, twin)
    assert not slopes[-1].any()
    np.testing.assert_array_equal(slopes[:-1], moment_slopes(RING, points))


@given(st.integers(0, 10_000), st.sampled_from(list(GRIDS)))
def test_what_one_type_gains_the_others_lose(seed: int, name: str) -> None:
    grid, skin = GRIDS[name]
    slopes = moment_slopes(grid, scattered(grid, 2 + seed % 40, seed), skin)
    np.testing.assert_allclose(slopes.sum(axis=2), 0, atol=1e-12 * np.abs(slopes).max())


@given(st.integers(0, 10_000))
def test_points_of_one_type_change_nothing(seed: int) -> None:
    points = scattered(RING, 20, seed)
    types = np.full(20, seed % 4, dtype=np.uint8)
    assert not moment_slopes(RING, points.with_types(types)).any()


@given(st.integers(0, 10_000), st.floats(-4.0, 4.0))
def test_a_turned_section_has_turned_slopes(seed: int, angle: float) -> None:
    """A place's slopes turn like a vector, and the integrals like those of a turned region."""
    points = scattered(RING, 20, seed)
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, -s], [s, c]])
    x, y = turn @ np.stack([points.x, points.y])
    there = moment_slopes(RING, FeaturePoints(x, y, points.type))
    integrals = np.zeros((6, 6))
    integrals[0, 0], integrals[1:3, 1:3] = 1, turn
    integrals[3] = [0, 0, 0, c * c, s * s, -2 * c * s]
    integrals[4] = [0, 0, 0, s * s, c * c, 2 * c * s]
    integrals[5] = [0, 0, 0, c * s, -c * s, c * c - s * s]
    here = moment_slopes(RING, points)
    expected = np.einsum("xy,nytm,km->nxtk", turn, here, integrals)
    units = np.abs(here).max(axis=(0, 1, 2)) + 1e-9
    units[1:3], units[3:] = units[1:3].max(), units[3:].max()
    np.testing.assert_allclose(there / units, expected / units, atol=1e-7)


def test_turning_all_points_turns_the_moments() -> None:
    """S_x' = −S_y, S_y' = S_x, S_xx' = −2 S_xy, S_yy' = 2 S_xy, S_xy' = S_xx − S_yy."""
    points = scattered(RING, 15, 1)
    raw = exact_moments(points, POLYGONS["ring"]).T
    direction = np.stack([-points.y, points.x], axis=1)
    slopes = np.einsum("nxtm,nx->tm", moment_slopes(RING, points), direction)
    expected = np.stack(
        [0 * raw[0], -raw[2], raw[1], -2 * raw[5], 2 * raw[5], raw[3] - raw[4]], axis=1
    )
    np.testing.assert_allclose(slopes, expected, atol=1e-6 * np.abs(expected).max())


def test_a_chamber_within_the_material_is_carried_along() -> None:
    """S_x' = A for a step along x, S_xx' = 2 S_x, S_xy' = S_y: the section moves as one."""
    angle = np.arange(9) * 2 * np.pi / 9 + 0.1
    x, y = np.append(8 * np.cos(angle) + 3, 3.5), np.append(8 * np.sin(angle) - 2, -2.2)
    points = FeaturePoints(x, y, [0] * 9 + [1])
    grid = GRIDS["disc"][0]
    raw = exact_moments(points, POLYGONS["disc"])[1]
    along_x, along_y = moment_slopes(grid, points).sum(axis=0)[:, 1]
    a, sx, sy = raw[:3]
    np.testing.assert_allclose(along_x, [0, a, 0, 2 * sx, 0, sy], atol=1e-9 * abs(raw).max())
    np.testing.assert_allclose(along_y, [0, 0, a, 0, 2 * sy, sx], atol=1e-9 * abs(raw).max())
