"""Feature points that move together."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beamopt.refine.edges import moment_slopes
from beamopt.refine.orbits import STAYS, orbits_of, with_cells
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.symmetry import Symmetry, mirror_symmetry, threefold_symmetry
from tests.beamopt.refine.cases import domain_polygon, exact_moments, points_of, scattered

GRID = PolarGrid(radial=32, angular=90)
SYMMETRIES = {"none": None, "mirror": mirror_symmetry(), "threefold": threefold_symmetry(GRID)}


def made(which: str, seed: int, count: int = 20) -> tuple[FeaturePoints, Symmetry | None]:
    symmetry, points = SYMMETRIES[which], scattered(GRID, count, seed)
    return (points if symmetry is None else symmetry.symmetrised(points)), symmetry


@pytest.mark.parametrize("which", list(SYMMETRIES))
def test_everyone_is_in_one_orbit(which: str) -> None:
    points, symmetry = made(which, 1)
    orbits = orbits_of(len(points), symmetry)
    images = 1 if symmetry is None else len(symmetry.images)
    assert orbits.members.shape == (len(points) // images, images)
    np.testing.assert_array_equal(np.sort(orbits.members, axis=None), np.arange(len(points)))
    for k in range(len(points)):
        assert orbits.members[orbits.generator[k], orbits.image[k]] == k
        first = orbits.members[orbits.generator[k], 0]
        assert orbits.types[orbits.image[k], points.type[first]] == points.type[k]
        place = orbits.matrices[orbits.image[k]] @ [points.x[first], points.y[first]]
        np.testing.assert_allclose(place, [points.x[k], points.y[k]], atol=1e-12)


@given(st.sampled_from(list(SYMMETRIES)), st.integers(0, 10_000))
def test_moved_sections_are_exactly_symmetric(which: str, seed: int) -> None:
    """Bit for bit what the symmetry makes of the moved generators, after many steps too."""
    points, symmetry = made(which, seed)
    orbits = orbits_of(len(points), symmetry)
    generators = len(orbits.members)
    rng, total = np.random.default_rng(seed), np.zeros((generators, 2))
    here = points
    for _ in range(20):
        step = rng.normal(0, 0.1, (generators, 2))
        here, total = orbits.moved(here, step), total + step
    expected_x = points.x[:generators] + total[:, 0]
    np.testing.assert_allclose(here.x[:generators], expected_x, atol=1e-12)
    np.testing.assert_array_equal(here.type, points.type)
    if symmetry is not None:
        first = FeaturePoints(here.x[:generators], here.y[:generators], here.type[:generators])
        assert symmetry.expanded(first).digest == here.digest


@pytest.mark.parametrize("which", list(SYMMETRIES))
def test_no_step_changes_no_bit(which: str) -> None:
    points, symmetry = made(which, 2)
    orbits = orbits_of(len(points), symmetry)
    assert orbits.moved(points, np.zeros((len(orbits.members), 2))).digest == points.digest


def test_points_far_away_stay() -> None:
    """A design file takes places up to 10⁶ mm; a step beyond could not be written."""
    points = points_of((1e6, 0, 1), (0, -1e6, 2), (15, 0, 3), (STAYS / 2, 0, 0))
    moved = orbits_of(4, None).moved(points, np.full((4, 2), 0.5))
    np.testing.assert_array_equal(moved.x - points.x, [0, 0, 0.5, 0.5])
    np.testing.assert_array_equal(moved.y - points.y, [0, 0, 0.5, 0.5])


@given(st.sampled_from(list(SYMMETRIES)), st.integers(0, 10_000))
def test_gathered_slopes_are_those_by_the_generators(which: str, seed: int) -> None:
    """Of Σ a·place over all places, which is linear in them."""
    points, symmetry = made(which, seed)
    orbits, rng = orbits_of(len(points), symmetry), np.random.default_rng(seed)
    slopes = rng.normal(size=(len(points), 2, 3))
    step = rng.normal(size=(len(orbits.members), 2))
    moved = orbits.moved(points, step)
    by = np.stack([moved.x - points.x, moved.y - points.y], axis=1)
    gathered = orbits.gathered(slopes)
    assert gathered.shape == (len(orbits.members), 2, 3)
    np.testing.assert_allclose(
        np.einsum("gx...,gx->...", gathered, step),
        np.einsum("nx...,nx->...", slopes, by),
        atol=1e-10,
    )


@pytest.mark.parametrize("which", ["mirror", "threefold"])
def test_gathered_moment_slopes_against_differences(which: str) -> None:
    points, symmetry = made(which, 3)
    orbits, domain = orbits_of(len(points), symmetry), domain_polygon(GRID)
    step = np.random.default_rng(3).normal(size=(len(orbits.members), 2))
    ahead, behind = (exact_moments(orbits.moved(points, s * step), domain) for s in (1e-4, -1e-4))
    slopes = orbits.gathered(moment_slopes(GRID, points))
    expected = (ahead - behind) / 2e-4
    units = np.abs(expected).max(axis=0)
    found = np.einsum("gxtm,gx->tm", slopes, step)
    np.testing.assert_allclose(found / units, expected / units, atol=1e-6)


def test_twins_have_no_cell() -> None:
    points = points_of((15, 0, 1), (-15, 2, 3), (15, 0, 2), (0, 17, 2), (-15, 2, 1))
    kept = with_cells(points, None)
    assert kept.digest == points_of((15, 0, 1), (-15, 2, 3), (0, 17, 2)).digest
    assert with_cells(kept, None).digest == kept.digest


@pytest.mark.parametrize("count", [1, 2, 5])
def test_all_in_one_place(count: int) -> None:
    """The first one's cell is everything."""
    points = points_of(*[(15.0, 3.0, k % 4) for k in range(count)])
    assert with_cells(points, None).digest == points_of((15, 3, 0)).digest


@pytest.mark.parametrize("which", list(SYMMETRIES))
def test_without_points(which: str) -> None:
    nothing, symmetry = FeaturePoints([], [], []), SYMMETRIES[which]
    assert len(with_cells(nothing, symmetry)) == 0
    orbits = orbits_of(0, symmetry)
    assert orbits.members.shape[0] == 0
    assert len(orbits.moved(nothing, np.zeros((0, 2)))) == 0
    assert orbits.gathered(np.zeros((0, 2, 24))).shape == (0, 2, 24)


@pytest.mark.parametrize("which", ["mirror", "threefold"])
def test_symmetric_sets_stay_whole(which: str) -> None:
    """A twin goes with all of its images; what is left is exactly symmetric."""
    points, symmetry = made(which, 4)
    assert symmetry is not None
    assert with_cells(points, symmetry).digest == points.digest
    generators = symmetry.generators(points)
    twin = FeaturePoints(
        np.append(generators.x, generators.x[1]),
        np.append(generators.y, generators.y[1]),
        np.append(generators.type, (generators.type[1] + 1) % 4),
    )
    assert with_cells(symmetry.expanded(twin), symmetry).digest == points.digest


def test_points_on_a_mirror_line_go() -> None:
    symmetry = mirror_symmetry()
    points = points_of((15, 3, 2), (15, -3, 3), (-12, 0, 1))
    assert with_cells(points, symmetry).digest == points_of((15, 3, 2), (15, -3, 3)).digest
