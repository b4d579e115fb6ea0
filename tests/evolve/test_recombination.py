from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beamopt.evolve.recombination import fixed, ranged
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid

RING = PolarGrid()
SECTOR = PolarGrid(start=30, stop=150)


def parents(seed: int, grid: PolarGrid = RING, counts: tuple[int, int] = (40, 60)) -> list:
    rng = np.random.default_rng([seed])
    return [FeaturePoints.random(grid, count, rng) for count in counts]


def as_set(*points: FeaturePoints) -> Counter:
    return Counter((x, y, t) for p in points for x, y, t in zip(p.x, p.y, p.type, strict=True))


@pytest.mark.parametrize("method", [fixed, ranged])
@pytest.mark.parametrize("grid", [RING, SECTOR])
@given(seed=st.integers(0, 10_000))
def test_no_feature_point_is_lost_or_made(method, grid: PolarGrid, seed: int) -> None:
    a, b = parents(seed, grid)
    c, d = method(a, b, grid, 0.5, np.random.default_rng([seed, 1]))
    assert as_set(a, b) == as_set(c, d)


@given(seed=st.integers(0, 10_000), share=st.sampled_from([0.0, 0.1, 0.5, 1.0]))
def test_fixed_keeps_the_counts_and_swaps_the_share(seed: int, share: float) -> None:
    a, b = parents(seed, counts=(100, 100))
    c, d = fixed(a, b, RING, share, np.random.default_rng([seed, 1]))
    assert (len(c), len(d)) == (100, 100)
    assert sum((as_set(c) & as_set(a)).values()) == 100 - round(share * 100)


def test_fixed_swaps_those_nearest_to_one_angle() -> None:
    a, b = parents(5, counts=(100, 100))
    c, _ = fixed(a, b, RING, 0.5, np.random.default_rng(1))
    angle = np.random.default_rng(1).uniform(0, 2 * np.pi)
    taken = [k for k in range(100) if (a.x[k], a.y[k], a.type[k]) not in as_set(c)]
    away = np.abs(np.mod(a.angles - angle + np.pi, 2 * np.pi) - np.pi)
    assert set(taken) == set(np.argsort(away)[:50])


def test_range_swaps_an_interval_of_angles() -> None:
    a, b = parents(6)
    c, d = ranged(a, b, RING, 0.5, np.random.default_rng(3))
    low, high = sorted(np.random.default_rng(3).uniform(0, 2 * np.pi, 2))
    for child, own, other in ((c, a, b), (d, b, a)):
        inside = as_set(
            *[
                child,
            ]
        )
        expected = Counter()
        for source, wanted in ((own, False), (other, True)):
            keep = ((source.angles >= low) & (source.angles <= high)) == wanted
            expected += as_set(FeaturePoints(source.x[keep], source.y[keep], source.type[keep]))
        assert inside == expected


def test_range_may_change_counts_down_to_none() -> None:
    a = FeaturePoints([15.0], [0.1], [1])
    b = FeaturePoints([-15.0], [0.1], [0])
    counts = set()
    for seed in range(60):
        counts |= {len(child) for child in ranged(a, b, RING, 0.5, np.random.default_rng(seed))}
    assert counts == {0, 1, 2}
