"""The memetic operator: individuals are refined a little while they evolve."""

from __future__ import annotations

from dataclasses import dataclass

from beamopt.base.random_streams import Purpose, stream
from beamopt.judge.judge import Judge
from beamopt.refine.refine import improved
from beamopt.scene.scene import Scene
from beamopt.scene.search_keys import Refining
from beamopt.section.feature_points import FeaturePoints

__all__ = ["Improvement"]

LITTLE = Refining(flips=4_000, walks=2, hot=30.0, cold=3.0, steps=10, rounds=1)


@dataclass(frozen=True)
class Improvement:
    """One short round of refining; what it judges counts as evaluations of the search."""

    judge: Judge
    scene: Scene

    @property
    def most_evaluations(self) -> int:
        """Sections that one improvement may judge."""
        return 1 + LITTLE.walks + LITTLE.steps

    def __call__(
        self, points: FeaturePoints, generation: int, index: int
    ) -> tuple[FeaturePoints, int]:
        """A genotype made of `points`, and how many sections that took; its own random numbers."""
        drawn = stream(self.scene.search.seed, Purpose.IMPROVEMENT, generation, index)
        seed = int(drawn.integers(2**62))
        symmetry = self.scene.making.repair(self.scene.grid.build())
        return improved(self.judge, points, LITTLE, seed=seed, symmetry=symmetry)
