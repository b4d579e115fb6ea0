"""The polar grid against quadrature over single elements."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss

from beamopt.section.grid import FloatArray, PolarGrid

GRIDS = [
    PolarGrid(),
    PolarGrid(radial=5, angular=9),
    PolarGrid(0.0, 3.0, 4, 7, -30.0, 200.0),
    PolarGrid(2.0, 2.5, 1, 1, 100.0, 101.0),
    PolarGrid(8.0, 9.0, 3, 2, 350.0, 710.0),
]

NODES, WEIGHTS = leggauss(20)


def quadrature(ends: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Gauss points and weights (n, 20) between neighbouring `ends` (n + 1,)."""
    half = np.diff(ends)[:, None] / 2
    return (ends[:-1] + ends[1:])[:, None] / 2 + half * NODES, half * WEIGHTS


@pytest.mark.parametrize("grid", GRIDS)
def test_elements_have_equal_areas_that_add_up(grid: PolarGrid) -> None:
    areas = np.diff(grid.edges**2)[:, None] / 2 * np.diff(grid.angles)
    # differences of squares of edges lose a few digits where rows are thin
    np.testing.assert_allclose(areas, grid.element_area, rtol=1e-11)
    assert areas.sum() == pytest.approx(grid.area, rel=1e-13)


@pytest.mark.parametrize("grid", GRIDS)
def test_grid_spans_its_radii_and_angles(grid: PolarGrid) -> None:
    ends = [grid.edges[0], grid.edges[-1], *np.degrees(grid.angles[[0, -1]])]
    expected = [grid.inner_radius, grid.outer_radius, grid.start, grid.stop]
    np.testing.assert_allclose(ends, expected, rtol=1e-14, atol=1e-14)
    assert grid.shape == (grid.radial, grid.angular)
    assert grid.edges.shape == (grid.radial + 1,)
    assert grid.angles.shape == (grid.angular + 1,)


def test_area_of_the_ring() -> None:
    assert PolarGrid(10.0, 25.0).area == pytest.approx(np.pi * 525)
    assert PolarGrid(10.0, 25.0, stop=90.0).area == pytest.approx(np.pi * 525 / 4)


@pytest.mark.parametrize("grid", GRIDS)
def test_centroids_agree_with_quadrature(grid: PolarGrid) -> None:
    r, wr = quadrature(grid.edges)
    a, wa = quadrature(grid.angles)
    by_radius = (wr * r * r).sum(axis=1)
    x, y = (by_radius[:, None] * (wa * f(a)).sum(axis=1) for f in (np.cos, np.sin))
    # rounding of the radial integrals: differences of fourth powers at most 1e-11 apart here
    expected = np.stack([x, y]) / grid.element_area
    np.testing.assert_allclose(grid.centroids, expected, rtol=1e-10, atol=1e-10 * grid.outer_radius)


@pytest.mark.parametrize("grid", GRIDS)
def test_radial_integrals_agree_with_quadrature(grid: PolarGrid) -> None:
    r, w = quadrature(grid.edges)
    expected = np.stack([(w * r ** (n + 1)).sum(axis=1) for n in range(3)])
    np.testing.assert_allclose(grid.radial_integrals, expected, rtol=1e-10)


@pytest.mark.parametrize("grid", GRIDS)
def test_angular_integrals_run_from_the_start(grid: PolarGrid) -> None:
    a, w = quadrature(grid.angles)
    c, s = np.cos(a), np.sin(a)
    columns = [(w * f).sum(axis=1) for f in (np.ones_like(a), c, s, c * c, s * s, s * c)]
    expected = np.vstack([np.zeros(6), np.cumsum(np.stack(columns, axis=1), axis=0)])
    np.testing.assert_allclose(grid.angular_integrals, expected, rtol=0, atol=1e-12)


def test_only_360_degrees_close_the_ring() -> None:
    assert PolarGrid().is_full_ring
    assert PolarGrid(start=-90.0, stop=270.0).is_full_ring
    assert not PolarGrid(stop=359.0).is_full_ring


def test_columns_of_a_ring_go_round() -> None:
    grid = PolarGrid(angular=36, start=5.0, stop=365.0)
    found = grid.columns(np.array([5.0, 20.0, 364.0, 370.0, -5.0]))
    np.testing.assert_allclose(found, [0.0, 1.5, 35.9, 0.5, 35.0], atol=1e-12)


def test_columns_of_a_sector_do_not_go_round() -> None:
    grid = PolarGrid(angular=10, start=-10.0, stop=90.0)
    np.testing.assert_allclose(grid.columns(np.array([-20.0, 0.0, 95.0])), [-1.0, 1.0, 10.5])


@pytest.mark.parametrize(
    ("keys", "named"),
    [
        ({"inner_radius": -1.0}, "inner_radius = -1.0"),
        ({"inner_radius": 30.0}, "outer_radius = 25.0"),
        ({"inner_radius": 25.0}, "inner_radius = 25.0"),
        ({"inner_radius": float("nan")}, "inner_radius = nan"),
        ({"radial": 0}, "0 × 360"),
        ({"angular": -3}, "128 × -3"),
        ({"stop": 0.0}, "stop = 0.0"),
        ({"stop": 361.0}, "stop = 361.0"),
        ({"start": 90.0, "stop": 45.0}, "stop = 45.0"),
    ],
)
def test_misuse_names_the_value(keys: dict[str, float], named: str) -> None:
    with pytest.raises(ValueError, match=named):
        PolarGrid(**keys)


@pytest.mark.parametrize(
    "bad", [{"outer_radius": np.inf}, {"radial": 2.5}, {"outer_radius": np.nan}]
)
def test_values_that_are_no_grid(bad: dict) -> None:
    with pytest.raises(ValueError, match="="):
        PolarGrid(**bad)
