"""Where a search's candidates come from: at random, from two others, from one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from beamopt.base.arrays import IndexArray, LabelArray
from beamopt.scene.scene import Scene
from beamopt.search.recombination import RECOMBINATIONS, Offspring
from beamopt.section.feature_points import SUPPLIES, FeaturePoints
from beamopt.section.neighbours import neighbour_edges
from beamopt.section.symmetry import Symmetry

__all__ = ["Variation", "direct", "mutate", "weighted"]


@dataclass(frozen=True)
class Variation:
    """A scene's operators; where its rules ask for symmetric sections, all that they make is that.

    Every draw is the caller's: one generator of random numbers a call.
    """

    scene: Scene

    @cached_property
    def symmetry(self) -> Symmetry | None:
        """What every candidate is made equal to; None where nothing is asked for."""
        return self.scene.making.repair(self.scene.grid.build())

    def warm_up(self) -> None:
        """Make a mutant of offspring and drop it: every kernel is compiled then."""
        rng = np.random.default_rng(0)
        one, _ = self.offspring(self.initial(rng), self.initial(rng), rng)
        self.mutant(one, rng)

    def initial(self, rng: np.random.Generator) -> FeaturePoints:
        """A random genotype; a symmetric one has its share of them in each part."""
        symmetry, rules = self.symmetry, self.scene.section
        if symmetry is None:
            return self.scene.random_points(rng)
        count = max(round(rules.feature_points / len(symmetry.images)), 1)
        grid = self.scene.grid.build()
        drawn = FeaturePoints.random(grid, count, rng, rules.material_probability)
        return symmetry.symmetrised(symmetry.folded(drawn))

    def offspring(self, a: FeaturePoints, b: FeaturePoints, rng: np.random.Generator) -> Offspring:
        """Two from two; of symmetric parents what the parts are made from is recombined."""
        settings, symmetry = self.scene.search, self.symmetry
        cross = RECOMBINATIONS[settings.recombination]
        about = self.scene.grid.build(), settings.swapped_share, rng
        if symmetry is None:
            return cross(a, b, *about)
        one, other = cross(symmetry.generators(a), symmetry.generators(b), *about)
        return symmetry.expanded(one), symmetry.expanded(other)

    def mutant(self, points: FeaturePoints, rng: np.random.Generator) -> FeaturePoints:
        """One from one; in a symmetric one the changes in the first part go for all."""
        settings = self.scene.search
        changed = mutate(points, MUTATIONS[settings.mutation], settings.mutated_share, rng)
        return changed if self.symmetry is None else self.symmetry.symmetrised(changed)


NewType = Callable[[int, int, LabelArray, IndexArray, np.random.Generator], int]


def mutate(
    points: FeaturePoints, new_type: NewType, share: float, rng: np.random.Generator
) -> FeaturePoints:
    """Change the type of one end of `share`·n random edges that join different types.

    Every change looks at the types before the mutation, so that each one is a change; where two
    edges pick the same feature point, the later one stays. Fewer such edges than asked for: all.
    """
    edges = neighbour_edges(points)
    boundary = edges[points.type[edges[:, 0]] != points.type[edges[:, 1]]]
    count = min(round(share * len(points)), len(boundary))
    types = points.type.copy()
    for edge in rng.choice(len(boundary), count, replace=False) if count else ():
        side = int(rng.integers(2))
        selected, other = int(boundary[edge, side]), int(boundary[edge, 1 - side])
        types[selected] = new_type(selected, other, points.type, edges, rng)
    return points.with_types(types)


def direct(
    selected: int, other: int, types: LabelArray, edges: IndexArray, rng: np.random.Generator
) -> int:
    """The type of the feature point at the other end of the edge."""
    return int(types[other])


def weighted(
    selected: int, other: int, types: LabelArray, edges: IndexArray, rng: np.random.Generator
) -> int:
    """A type drawn by how many neighbours have it; the selected point's own is not counted."""
    around = np.concatenate([edges[edges[:, 0] == selected, 1], edges[edges[:, 1] == selected, 0]])
    counts = np.bincount(types[around], minlength=len(SUPPLIES) + 1)
    counts[types[selected]] = 0
    return int(rng.choice(counts.size, p=counts / counts.sum()))


MUTATIONS: dict[str, NewType] = {"direct": direct, "weighted": weighted}
