"""Rays: every combination lies on one, and nothing is followed twice."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from beamopt.base.arrays import FloatArray
from beamopt.target.workspace import pressure_grid
from femcheck.prediction.rays import Ray, rays_of

PRINCIPAL = {(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 1.0, 1.0)}

levels = st.lists(st.floats(0, 2000), min_size=3, max_size=3, unique=True).map(sorted)
"""As a design allows them: ascending, none below zero."""


def grid(of: list[float]) -> FloatArray:
    a, b, c = of
    return pressure_grid((a, b, c))


@given(levels)
@example([0.0, 20.0, 40.0])
@example([10.0, 20.0, 40.0])
@example([0.0, 1e-300, 2000.0])
@example([0.0, 1.0, 1.0000002])
@example([33.3, 66.6, 99.9])
@example([7.0, 7.0000000001, 7.0000000002])
def test_every_combination_lies_on_its_ray(of: list[float]) -> None:
    """To the nine digits to which directions are told apart."""
    pressures = grid(of)
    rays, places = rays_of(pressures)
    assert len(places) == len(pressures)
    for combination, place in zip(pressures, places, strict=True):
        assert (place is None) == (not combination.any())
        if place is not None:
            number, load = place
            assert load == combination.max()
            assert load in rays[number].stops
            along = load * np.array(rays[number].direction)
            np.testing.assert_allclose(along, combination, atol=1e-9 * load)


@given(levels)
@example([0.0, 20.0, 40.0])
@example([10.0, 20.0, 40.0])
@example([0.0, 1.0, 1.0000002])
@example([0.0, 1e-6, 1000.0])
def test_rays_are_unique_and_so_are_their_files(of: list[float]) -> None:
    """Names may fold case or be on any file system: digits, points, signs, an exponent."""
    rays, _ = rays_of(grid(of))
    assert len({ray.direction for ray in rays}) == len(rays)
    names = [ray.name for ray in rays]
    assert len(set(names)) == len(rays)
    assert all(set(name) <= set("0123456789._-e") for name in names)
    for ray in rays:
        assert max(ray.direction) == 1
        assert list(ray.stops) == sorted(set(ray.stops))
        assert ray.stops[0] > 0


@given(levels)
@example([10.0, 20.0, 40.0])
def test_principal_rays_are_always_there_and_go_all_the_way(of: list[float]) -> None:
    rays, _ = rays_of(grid(of))
    principal = {ray.direction: ray for ray in rays if ray.is_principal}
    assert set(principal) == PRINCIPAL
    assert all(ray.stops[-1] == max(of) for ray in principal.values())
    # nothing but the combinations is asked for, except the ends of those four
    loads = {float(combination.max()) for combination in grid(of)}
    assert {load for ray in rays for load in ray.stops} <= loads


def test_26_combinations_of_three_levels_from_zero_lie_on_19_rays() -> None:
    rays, places = rays_of(grid([0.0, 50.0, 100.0]))
    assert len(rays) == 19
    assert places[0] is None
    assert sum(len(ray.stops) for ray in rays) == 26
    assert sum(place is not None for place in places) == 26


def test_a_lowest_level_above_zero_loads_every_combination() -> None:
    """Each supply alone is no combination then: its ray is followed for its end alone."""
    rays, places = rays_of(grid([10.0, 20.0, 40.0]))
    assert None not in places
    alone = [number for number, ray in enumerate(rays) if len(ray.supplies) == 1]
    assert len(alone) == 3
    assert not {place[0] for place in places if place is not None} & set(alone)
    assert [rays[number].stops for number in alone] == [(40.0,)] * 3
    alike = next(ray for ray in rays if ray.direction == (1.0, 1.0, 1.0))
    assert alike.stops == (10.0, 20.0, 40.0)


def test_without_pressure_there_is_no_ray() -> None:
    assert rays_of(np.zeros((27, 3))) == ([], [None] * 27)


def test_suction_is_a_direction_of_its_own() -> None:
    rays, places = rays_of(np.array([[-20.0, 0.0, 10.0]]))
    assert places == [(4, 20.0)]
    assert rays[4].direction == (-1.0, 0.0, 0.5)
    assert not rays[4].is_principal
    assert [ray.stops for ray in rays] == [(20.0,)] * 5


@pytest.mark.parametrize(
    ("direction", "name", "text"),
    [
        ((1.0, 0.0, 0.0), "100_0_0", "supply 1 alone"),
        ((0.0, 0.0, 1.0), "0_0_100", "supply 3 alone"),
        ((1.0, 0.0, 1.0), "100_0_100", "supplies 1 and 3"),
        ((1.0, 1.0, 1.0), "100_100_100", "all supplies alike"),
        ((1.0, 0.5, 0.0), "100_50_0", "pressures as 1 : 0.5 : 0"),
        ((1 / 3, 1.0, 2 / 3), "33.33333333_100_66.66666667", "pressures as 0.333 : 1 : 0.667"),
    ],
)
def test_how_a_ray_is_called(direction: tuple[float, float, float], name: str, text: str) -> None:
    ray = Ray(direction, (10.0,))
    assert ray.name == name
    assert ray.text == text
