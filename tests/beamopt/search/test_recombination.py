from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beamopt.search.recombination import fixed, ranged
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid

RING = PolarGrid()
SECTOR = PolarGrid(start=30, stop=150)


def parents(seed: int, grid: PolarGrid = RING, counts: tuple[int, int] = (40, 60)) -> list:
    rng = np.random.default_rng([seed])
    return [FeaturePoints.random(grid, count, rng) for count in counts]


def scattered(rng: np.random.Generator, grid: PolarGrid) -> FeaturePoints:
    """Points off the element centroids: no two of them at the same angle."""
    angle = np.radians(rng.uniform(grid.start, grid.start + grid.span, 100))
    return FeaturePoints(17 * np.cos(angle), 17 * np.sin(angle), rng.integers(0, 4, 100))


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
    kept = 100 - round(share * 100)
    own = FeaturePoints(c.x[:kept], c.y[:kept], c.type[:kept])
    others = FeaturePoints(c.x[kept:], c.y[kept:], c.type[kept:])
    assert as_set(own) <= as_set(a)
    assert as_set(others) <= as_set(b)


@pytest.mark.parametrize("grid", [RING, SECTOR])
def test_fixed_swaps_those_nearest_to_one_angle(grid: PolarGrid) -> None:
    """Nearest round the ring, also across where its angles start; not across a sector's gap."""
    span = np.radians(grid.span)
    for seed in range(12):
        rng = np.random.default_rng([seed, 7])
        a, b = (scattered(rng, grid) for _ in range(2))
        c, _ = fixed(a, b, grid, 0.5, np.random.default_rng(seed))
        angle = np.radians(grid.start) + np.random.default_rng(seed).uniform(0, span)
        kept = as_set(c)
        taken = [k for k in range(100) if (a.x[k], a.y[k], a.type[k]) not in kept]
        away = 1 - np.cos(a.angles - angle)  # grows with the angle between, round the ring
        assert set(taken) == set(np.argsort(away, kind="stable")[:50])


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
