"""The benchmark's reference computes the same thing, so that its time means something."""

import numpy as np

from beamopt.section.cross_section import CrossSection
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.phenotype import phenotypes
from beamopt.target.workspace import pressure_grid
from tests.bench.evaluation import judge_for
from tests.bench.reference import Reference


def test_reference_agrees_with_the_kernels() -> None:
    grid = PolarGrid()
    reference = Reference(grid)
    judge = judge_for(grid)
    for seed in range(5):
        rng = np.random.default_rng([seed])
        # off the element centroids: the k-d tree breaks ties at will; in the ring: all have a cell
        r, phi = rng.uniform(10, 25, 100), rng.uniform(0, 2 * np.pi, 100)
        points = FeaturePoints(r * np.cos(phi), r * np.sin(phi), rng.integers(0, 4, 100))
        labels = CrossSection.from_points(grid, points).labels
        np.testing.assert_array_equal(reference.labels(points), labels)
        raw = reference.raw_moments(labels)
        measured = phenotypes(grid, [points], 4)
        np.testing.assert_allclose(raw, measured.moments.raw[0], rtol=1e-12, atol=1e-8)
        assert reference.ratio(points) == measured.neighbour_ratio[0]
        tips = reference.tips(raw, pressure_grid((0.0, 50.0, 100.0)))
        np.testing.assert_allclose(tips, judge.tips([points])[0], rtol=1e-9, atol=1e-7)
