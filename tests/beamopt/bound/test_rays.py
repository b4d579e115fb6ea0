"""The proven bound: never above what is attained, and as high as it says."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from beamopt.base.arrays import FloatArray
from beamopt.bound.cells import Box, RaySum, ray_minimum
from beamopt.bound.prices import FREE_GAP, GAP, ray_bound
from beamopt.bound.rays import RayParts, rays_of
from beamopt.bound.response import response_bound
from beamopt.bound.wanted import Wanted
from beamopt.rod.arc import arc_tip_jacobian, arc_tips
from tests.beamopt.bound.cases import PRESSURES, bowl, random_response, wanted

SMALL = Box((-0.3, 1.0), np.pi)


def a_ray(seed: int, rest: tuple[float, float] = (0.0, 0.0), noise: float = 0.05) -> RaySum:
    rng = np.random.default_rng(seed)
    shares = np.array([1.0, 0.5, -0.4])
    strain = np.array([rng.uniform(0, 0.5), *rng.uniform(-1.5, 1.5, 2)])
    strains = shares[:, None] * strain + [0, *rest]
    tips = arc_tips(strains, 1.0) + noise * rng.standard_normal((3, 3))
    return RaySum(shares, tips, rng.uniform(0.5, 2.0, 3), np.array(rest))


def scan(ray: RaySum, box: Box, price: FloatArray, points: int = 61) -> float:
    """The lowest priced sum on a lattice over the box."""
    axis = np.linspace(-box.turn, box.turn, points)
    stretch = np.linspace(*box.stretch, points)
    strains = np.stack(np.meshgrid(stretch, axis, axis, indexing="ij"), -1).reshape(-1, 3)
    strains = strains[np.hypot(strains[:, 1], strains[:, 2]) <= box.turn]
    return float((ray.at(strains) + strains @ price).min())


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("rest", [(0.0, 0.0), (0.7, -0.4)])
@pytest.mark.parametrize("price", [(0.0, 0.0, 0.0), (0.05, -0.1, 0.08)])
def test_a_rays_two_ends_enclose_what_a_fine_lattice_finds(
    seed: int, rest: tuple[float, float], price: tuple[float, float, float]
) -> None:
    ray, prices = a_ray(seed, rest), np.array(price)
    found = ray_minimum(ray, SMALL, prices, np.array([0.1, 0.0, 0.0]), 1e-4)
    lowest = scan(ray, SMALL, prices)
    assert found.lower <= found.upper <= lowest + 1e-12
    assert found.upper - found.lower <= 1e-4
    assert lowest - found.upper < 0.02  # the lattice's own coarseness
    assert found.upper == pytest.approx(ray.at(found.strain[None])[0] + prices @ found.strain)
    assert found.cells > 1


@given(st.integers(0, 10_000), st.floats(0.001, 0.6), st.floats(-1.0, 1.0))
def test_no_strain_of_a_cell_is_below_its_bound(seed: int, size: float, price: float) -> None:
    """Both bounds of `ray_minimum`'s docstring, at random places of random cells."""
    rng = np.random.default_rng(seed)
    ray = a_ray(seed, (0.3, 0.2), rng.uniform(0, 0.3))
    prices = price * rng.standard_normal(3)
    centres = np.column_stack([rng.uniform(-0.3, 1, 20), rng.uniform(-4, 4, (20, 2))])
    halves = size * rng.uniform(0.2, 1.0, (20, 3))
    for enough in (-np.inf, np.inf):  # without and with the second bound
        sums, bounds = ray.cells(centres, halves, prices, enough)
        for _ in range(20):
            inside = centres + halves * rng.uniform(-1, 1, (20, 3))
            assert (ray.at(inside) + inside @ prices >= bounds - 1e-12).all()
        corners = centres + halves * rng.choice([-1.0, 1.0], (20, 3))
        assert (ray.at(corners) + corners @ prices >= bounds - 1e-12).all()
        assert (sums >= bounds - 1e-12).all()


def test_how_far_tips_move_and_leave_their_slopes() -> None:
    """Both are kept, and met nearly where the rod is straight: the bounds are not loose there."""
    rng = np.random.default_rng(0)
    ray = a_ray(0)
    bends = 10.0 ** rng.uniform(-3, 0.7, (4000, 1))
    centres = np.hstack([rng.uniform(-0.3, 1, (4000, 1)), bends * rng.standard_normal((4000, 2))])
    halves = 10.0 ** rng.uniform(-3, -1, (4000, 3))
    move, bend = ray.reach(centres, halves)
    step = halves * rng.choice([-1.0, 1.0], (4000, 3))
    at, to = (one[:, None, :] * ray.shares[:, None] for one in (centres, centres + step))
    moved = arc_tips(to, 1.0) - arc_tips(at, 1.0)
    linear = np.einsum("nkxi,nki->nkx", arc_tip_jacobian(at, 1.0), to - at)
    for most, way in ((move, moved), (bend, moved - linear)):
        used = np.linalg.norm(way, axis=-1) / most
        assert used.max() <= 1 + 1e-9
        assert used.max() > 0.9


def test_the_gradient_is_the_sums() -> None:
    ray, at = a_ray(3, (0.2, 0.1)), np.array([0.2, 0.7, -0.4])
    step = 1e-6 * np.eye(3)
    slopes = [(ray.at((at + e)[None]) - ray.at((at - e)[None]))[0] / 2e-6 for e in step]
    np.testing.assert_allclose(ray.gradient(at[None])[0], slopes, rtol=1e-7, atol=1e-9)


@settings(max_examples=4)
@given(st.integers(0, 10_000), st.floats(0.0, 6.0))
def test_the_proven_bound_is_never_above_a_response(seed: int, noise: float) -> None:
    asked = wanted(random_response(seed % 7), noise, seed)
    best = response_bound(asked)
    found = ray_bound(asked, response=best.matrix)
    assert found.loss <= best.loss * (1 + 1e-12) + 1e-12
    assert found.loss <= found.upper
    free = ray_bound(asked)
    assert free.loss <= found.loss + 1e-9
    assert free.upper - free.loss <= FREE_GAP * free.upper + 0.03


@pytest.mark.parametrize("asked", [bowl(), bowl(10, 40), wanted(random_response(2), 2.0)])
def test_prices_prove_the_response_bound(asked: Wanted) -> None:
    """For targets like these nothing is lost: the numerical bound is the global one, to 0.1 %."""
    best = response_bound(asked)
    found = ray_bound(asked, response=best.matrix)
    assert found.priced
    assert best.loss * (1 - 1.01 * GAP) <= found.loss <= best.loss * (1 + 1e-12)
    assert ray_bound(asked).loss < 0.9 * best.loss


def test_prices_of_a_poor_response_are_valid_too() -> None:
    """Any prices give a bound: those at a response that is no minimum as well."""
    asked = bowl()
    least = response_bound(asked).loss
    for size in (0.9, 0.97):
        found = ray_bound(asked, response=size * response_bound(asked).matrix)
        assert 0.5 * least < found.loss <= least


def test_rows_at_opposite_pressures_share_a_strain() -> None:
    directions = np.array([[60.0, 0, 0], [0, 60, 0], [0, 0, 60], [40, 40, 0], [0, 40, 40]])
    pressures = np.concatenate([directions, -0.4 * directions])
    asked = wanted(random_response(3), 2.0, 3, pressures=pressures)
    best = response_bound(asked)
    found = ray_bound(asked, response=best.matrix)
    assert len(found.rays) == 5
    assert 0.97 * best.loss < found.loss <= best.loss


def test_better_prices_are_sought_where_a_ray_has_a_lower_strain_elsewhere() -> None:
    """Noisy tips of a soft section: the first prices prove less than no prices at all.

    This takes some ten seconds; it is the only target here that needs rounds of prices.
    """
    rng = np.random.default_rng(5)
    far = rng.standard_normal((3, 3)) * [[0.002], [0.00015], [0.00015]]
    asked = wanted(far, 3.0, 5)
    best = response_bound(asked)
    found, free = ray_bound(asked, response=best.matrix), ray_bound(asked)
    assert found.priced
    assert free.loss < 0.5 * best.loss
    assert 0.8 * best.loss < found.loss <= best.loss


def test_weights_and_a_rest_shape() -> None:
    weights = np.random.default_rng(3).uniform(0.2, 3.0, 27)
    asked = wanted(random_response(4), 3.0, 3, weights=weights, rest=(0.006, 0.002))
    best = response_bound(asked)
    found = ray_bound(asked, response=best.matrix)
    assert 0.5 * best.loss < found.loss <= best.loss
    heavier = ray_bound(replace(asked, weights=3 * weights), response=best.matrix)
    assert heavier.loss == pytest.approx(3 * found.loss, rel=1e-9)


def test_rays_of_the_papers_pressures_and_of_vacuum() -> None:
    still, lines = rays_of(PRESSURES)
    assert still.tolist() == [0]
    assert sorted(len(rows) for _, rows in lines) == [1] * 12 + [2] * 7
    still, lines = rays_of(np.array([[10.0, 0, 5], [-20, 0, -10], [0, 0, 0], [10, 0, 5.001]]))
    assert still.tolist() == [2]
    assert [rows.tolist() for _, rows in lines] == [[0, 1], [3]]


def test_the_box_is_of_the_highest_pressure_on_each_ray() -> None:
    parts = RayParts.of(bowl(), np.zeros((3, 3)), Box())
    assert parts.highest.shape == (19, 3)
    np.testing.assert_allclose(parts.highest.max(axis=1), 100.0)
    assert all(np.abs(one.shares).max() == pytest.approx(1.0) for one in parts.sums)


def test_rows_without_pressure_add_what_they_are_away() -> None:
    asked = wanted(np.zeros((3, 3)), pressures=np.zeros((2, 3)))
    moved = replace(asked, tips=asked.tips + np.array([[3.0, 0, 4], [0, 0, 0]]))
    found = ray_bound(moved)
    assert found.loss == pytest.approx(25.0)
    assert found.rays == ()


def test_the_box_is_widened_and_said() -> None:
    response = np.array([[0.03, 0, 0], [0, 0, 0], [0.0008, 0.0, 0.0]])
    found = ray_bound(wanted(response), response=response)
    assert found.box.stretch == (-0.5, pytest.approx(3.0))
    assert found.box.turn == pytest.approx(8.0)
    assert "1.27 turns" in found.box.text
    assert "one turn" in Box().text
