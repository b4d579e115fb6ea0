"""What chambers in a ring can have, and the least loss that they can bring."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beamopt.base.arrays import FloatArray
from beamopt.bound.polytope import Cuts, least_squares_within, nearest_point
from beamopt.bound.response import response_bound
from beamopt.bound.ring import NUMBERS, RingMoments, ring_response
from beamopt.bound.ring_bound import RingBound, is_stiff, ring_bound
from beamopt.bound.wanted import Wanted
from beamopt.rod.response import linear_response
from beamopt.section.cross_section import CrossSection
from beamopt.section.grid import PolarGrid
from tests.beamopt.bound.cases import GRID, YOUNG, bowl, random_response, random_section, wanted

RING = RingMoments.of(GRID)


def bounded(asked: Wanted, ring: RingMoments = RING) -> tuple[float, RingBound]:
    least = response_bound(asked).loss
    return least, ring_bound(asked, ring, YOUNG, least)


@given(st.integers(0, 10_000))
def test_no_section_is_beyond_the_support_function(seed: int) -> None:
    section = random_section(seed, 0.2 + 0.1 * (seed % 7))
    point = RING.point_of(section.moments)
    np.testing.assert_allclose(point, RING.point(section.labels.ravel()), atol=1e-13)
    directions = np.random.default_rng(seed).standard_normal((30, NUMBERS)) / RING.reach
    heights = np.array([RING.farthest(one)[0] for one in directions])
    assert (directions @ point <= heights + 1e-12).all()


@given(st.integers(0, 10_000))
def test_the_farthest_partition_attains_the_support_function(seed: int) -> None:
    direction = np.random.default_rng(seed).standard_normal(NUMBERS) / RING.reach
    height, point = RING.farthest(direction)
    labels = RING.best_types(direction).reshape(GRID.shape).astype(np.uint8)
    moments = CrossSection(GRID, labels).moments
    np.testing.assert_allclose(RING.point_of(moments), point, atol=1e-12)
    assert direction @ point == pytest.approx(height, abs=1e-12)
    changed = labels.copy()  # no single element could have a better type
    changed.ravel()[seed % labels.size] = (labels.ravel()[seed % labels.size] + 1 + seed % 3) % 4
    assert direction @ RING.point_of(CrossSection(GRID, changed).moments) <= height + 1e-12


@pytest.mark.parametrize("seed", range(5))
def test_the_response_of_a_point_is_the_sections(seed: int) -> None:
    moments = random_section(seed).moments
    matrix, slopes = ring_response(RING, RING.point_of(moments), YOUNG)
    expected = linear_response(moments, YOUNG).matrix
    np.testing.assert_allclose(matrix, expected, rtol=1e-9, atol=1e-18)
    steps = 1e-6 * np.eye(NUMBERS)
    point = RING.point_of(moments)
    for slope, step in zip(slopes, steps, strict=True):
        ahead, behind = (ring_response(RING, point + s * step, YOUNG)[0] for s in (1, -1))
        unit = np.abs(expected).max(axis=1, keepdims=True)
        np.testing.assert_allclose(slope / unit, (ahead - behind) / 2e-6 / unit, atol=1e-5)


def test_skins_take_away_and_a_sector_has_less() -> None:
    sealed = RingMoments.of(GRID, skin=2.0)
    half = RingMoments.of(PolarGrid(radial=32, angular=90, stop=180.0))
    np.testing.assert_allclose(sealed.whole, RING.whole)
    np.testing.assert_allclose(half.whole[0], RING.whole[0] / 2)
    for direction in np.random.default_rng(0).standard_normal((20, NUMBERS)) / RING.reach:
        assert sealed.farthest(direction)[0] <= RING.farthest(direction)[0] + 1e-12
        assert half.farthest(direction)[0] <= RING.farthest(direction)[0] + 1e-12
    inside = sealed.elements[:, 0].sum() / RING.elements[:, 0].sum()
    exact = (23.0**2 - 12.0**2) / (25.0**2 - 10.0**2)
    assert exact <= inside < exact + 2 / 32  # whole rows of the grid


def test_fewer_elements_cost_little() -> None:
    fine, coarse = RingMoments.of(PolarGrid()), RingMoments.of(PolarGrid(), radial=64, angular=180)
    full = RingMoments.of(PolarGrid(), radial=128, angular=360)
    assert len(fine.elements) == len(coarse.elements) == 64 * 180
    for direction in np.random.default_rng(0).standard_normal((10, NUMBERS)) / RING.reach:
        whole = full.farthest(direction)[0]
        assert 0 <= whole - coarse.farthest(direction)[0] < 1e-3


@pytest.mark.parametrize("seed", range(3))
def test_what_a_section_has_the_ring_has(seed: int) -> None:
    least, found = bounded(wanted(random_response(seed)))
    assert least < 1e-12
    assert found.realisable
    assert found.outer == least
    assert found.inner < 1e-3


def test_a_shallow_bowl_asks_for_nothing_that_a_ring_has_not() -> None:
    least, found = bounded(bowl(8.0))
    assert least > 10.0
    assert found.realisable
    assert found.inner == pytest.approx(least, rel=1e-3)


@pytest.mark.parametrize(
    "scale", [(1.0, 4.0, 4.0), (-0.3, 1.0, 1.0)], ids=["bent too far", "shortened"]
)
@pytest.mark.parametrize("ring", [RING, RingMoments.of(GRID, skin=2.0)], ids=["whole", "skins"])
def test_what_no_ring_has_is_bounded_above_the_response(
    scale: tuple[float, float, float], ring: RingMoments
) -> None:
    asked = wanted(np.array(scale)[:, None] * random_response(2))
    least, found = bounded(asked, ring)
    assert least < 1e-9
    assert not found.realisable
    assert found.agrees
    assert 100.0 < found.outer <= found.inner <= 1.001 * found.outer
    assert asked.loss_of(found.matrix) == pytest.approx(found.inner, rel=1e-9)
    _is_in_the_ring(ring, found.numbers)
    for seed in range(40):  # sections of this ring are never below it
        assert asked.loss_of(random_response(seed)) > found.outer


def test_a_much_larger_ring_can_not_bend_as_far() -> None:
    """Curvatures are areas times arms over second moments: they fall with the ring's size."""
    asked = wanted(random_response(4))
    least, found = bounded(asked, RingMoments.of(PolarGrid(100.0, 250.0, 32, 90)))
    assert least < 1e-12
    assert not found.realisable
    assert found.agrees
    assert found.outer > 10.0


def _is_in_the_ring(ring: RingMoments, numbers: FloatArray) -> None:
    assert is_stiff(ring, numbers)
    for direction in np.random.default_rng(0).standard_normal((200, NUMBERS)) / ring.reach:
        assert direction @ numbers <= ring.farthest(direction)[0] + 1e-8


def test_all_chamber_and_no_material_is_not_stiff() -> None:
    everything = RING.point(np.ones(len(RING.elements), dtype=np.int64))
    assert not is_stiff(RING, everything)
    assert is_stiff(RING, np.zeros(NUMBERS))


def _ball(direction: FloatArray) -> tuple[float, FloatArray]:
    point = direction / np.linalg.norm(direction)
    return float(direction @ point), point


def test_the_nearest_point_of_a_ball() -> None:
    rng = np.random.default_rng(0)
    for _ in range(5):
        outside = 2.5 * _ball(rng.standard_normal(4))[1]
        found = nearest_point(_ball, outside, np.eye(4))
        assert 1.5 - 1e-12 <= found.distance <= 1.5 / 0.9
        assert found.cuts.excess(outside) > 0.9 * found.distance
        assert np.linalg.norm(found.point) <= 1 + 1e-9
        inside = 0.7 * _ball(rng.standard_normal(4))[1]
        found = nearest_point(_ball, inside, np.eye(4))
        assert found.distance < 1e-8


def test_least_squares_within_cuts_are_the_nearest_point() -> None:
    rng = np.random.default_rng(5)
    for _ in range(10):
        normals = rng.standard_normal((20, 3))
        cuts = Cuts(normals, np.abs(rng.standard_normal(20)))
        wanted_point = 3 * rng.standard_normal(3)

        def residuals(
            at: FloatArray, goal: FloatArray = wanted_point
        ) -> tuple[FloatArray, FloatArray]:
            return at - goal, np.eye(3)

        point, value = least_squares_within(residuals, cuts, np.zeros(3))
        nearest = cuts.nearest(wanted_point)
        assert nearest is not None
        np.testing.assert_allclose(point, nearest, atol=1e-6)
        assert value == pytest.approx(((nearest - wanted_point) ** 2).sum(), rel=1e-6, abs=1e-12)
        assert cuts.excess(point) < 1e-9
        tried = rng.standard_normal((2000, 3))
        within = tried[(tried @ normals.T <= cuts.limits).all(axis=1)]
        assert (((within - wanted_point) ** 2).sum(axis=1) >= value - 1e-9).all()
    nowhere = Cuts(np.array([[1.0, 0, 0], [-1.0, 0, 0]]), np.array([-1.0, -1.0]))
    assert nowhere.nearest(np.zeros(3)) is None
