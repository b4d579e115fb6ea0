"""The polar grid against quadrature over single elements."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss

from beamopt.base.arrays import FloatArray
from beamopt.section.grid import PolarGrid

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


@pytest.mark.parametrize(
    "grid", [PolarGrid(), PolarGrid(radial=9, angular=17, start=200, stop=320)]
)
def test_every_centroid_is_in_its_own_element(grid: PolarGrid) -> None:
    x, y = grid.centroids
    row, column, inside = grid.elements_at(x, y)
    assert inside.all()
    np.testing.assert_array_equal(row, np.indices(grid.shape)[0])
    np.testing.assert_array_equal(column, np.indices(grid.shape)[1])


@pytest.mark.parametrize(
    ("keys", "named"),
    [
        ({"inner_radius": -1.0}, "inner_radius = -1.0"),
        ({"inner_radius": 30.0}, "outer_radius = 25.0"),
        ({"inner_radius": 25.0}, "inner_radius = 25.0"),
        ({"inner_radius": float("nan")}, "inner_radius = nan"),
        ({"radial": 0}, "0, 360"),
        ({"angular": -3}, "128, -3"),
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


@pytest.mark.parametrize(("start", "stop"), [(152.3, 512.3), (152.2, 512.2), (-0.1, 359.9)])
def test_a_ring_is_one_wherever_it_starts(start: float, stop: float) -> None:
    """The difference of two decimal angles is seldom exactly 360."""
    grid = PolarGrid(start=start, stop=stop)
    assert grid.is_full_ring
    np.testing.assert_allclose(grid.area, np.pi * (25**2 - 10**2), rtol=1e-14)


def test_integrals_of_thin_rows_keep_their_digits() -> None:
    """∫ r³ dr of a row 1e-7 mm thick at 1000 mm: exact within rounding, not within 1e-6."""
    grid = PolarGrid(inner_radius=999.9, outer_radius=1000.0, radial=1024)
    a, b = (grid.edges[k : k + grid.radial].astype(np.longdouble) for k in (0, 1))
    squares = (np.longdouble(1000.0) ** 2 - np.longdouble(999.9) ** 2) / 1024  # 64 bits
    np.testing.assert_allclose(grid.radial_integrals[2], squares * (a * a + b * b) / 4, rtol=1e-13)
