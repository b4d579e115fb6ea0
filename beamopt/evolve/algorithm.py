"""The genetic algorithm itself: ask for candidates, tell their verdicts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

from beamopt.evolve.mutation import MUTATIONS, mutate
from beamopt.evolve.recombination import RECOMBINATIONS
from beamopt.judge import Verdict
from beamopt.scene import Scene
from beamopt.section.feature_points import FeaturePoints
from beamopt.streams import Purpose, stream

__all__ = ["Generation", "GeneticAlgorithm", "Individual", "Stage"]


class Stage(Enum):
    """What the candidates asked for are; the value stands in the journal."""

    INITIAL = "initial"
    OFFSPRING = "offspring"
    MUTANTS = "mutants"


@dataclass(frozen=True, slots=True)
class Individual:
    """A genotype and what became of it."""

    points: FeaturePoints
    verdict: Verdict


@dataclass(frozen=True, slots=True)
class Generation:
    """The state after a generation.

    index : 0 for the initial population.
    evaluations : sections judged so far.
    population : the individuals, after mutation.
    best : the one with the lowest L in this population, the paper's metric.
    best_ever : the one with the lowest L of all that were judged so far.
    """

    index: int
    evaluations: int
    population: tuple[Individual, ...]
    best: Individual
    best_ever: Individual


class GeneticAlgorithm:
    """Recombination, selection on T, mutation; N_p individuals (paper, Genetic Algorithm).

    Deterministic: candidates follow from the scene's search settings and the verdicts told.

        while ...:
            record = search.tell(judge(search.ask()))
    """

    def __init__(self, scene: Scene) -> None:
        self._settings = scene.search
        self._grid = scene.grid.build()
        seed = scene.search.seed
        self._pending: list[FeaturePoints] = [
            scene.random_points(stream(seed, Purpose.INITIAL, 0, index))
            for index in range(scene.search.population)
        ]
        self._mutated: list[int] = []
        self._population: list[Individual] = []
        self._best_ever: Individual | None = None
        self.stage = Stage.INITIAL
        self.generation = 0
        self.evaluations = 0

    @property
    def pairs(self) -> int:
        """Pairs of parents in a generation: N_o / 2 = p_c N_p / 2."""
        return round(self._settings.crossover_probability * self._settings.population / 2)

    @property
    def mutants(self) -> int:
        """Individuals mutated in a generation: p_m N_p."""
        return round(self._settings.mutation_probability * self._settings.population)

    @property
    def next_evaluations(self) -> int:
        """Sections that the next generation will have judged."""
        return 2 * self.pairs + self.mutants

    def ask(self) -> tuple[FeaturePoints, ...]:
        """The candidates to be judged now; asking again gives the same ones."""
        return tuple(self._pending)

    def tell(self, verdicts: Sequence[Verdict]) -> Generation | None:
        """Take the verdicts of what was asked for, in that order.

        Returns
        -------
        Generation | None : the record of a generation that is now complete.

        Raises
        ------
        ValueError : not as many verdicts as candidates.
        """
        if len(verdicts) != len(self._pending):
            raise ValueError(f"{len(verdicts)} verdicts for {len(self._pending)} candidates")
        judged = [Individual(p, v) for p, v in zip(self._pending, verdicts, strict=True)]
        self.evaluations += len(judged)
        for individual in judged:
            if self._best_ever is None or individual.verdict.L < self._best_ever.verdict.L:
                self._best_ever = individual
        if self.stage is Stage.INITIAL:
            self._population = judged
        elif self.stage is Stage.OFFSPRING:
            self._select(judged)
            if self._choose_mutants():
                return None
        else:
            for place, mutant in zip(self._mutated, judged, strict=True):
                self._population[place] = mutant
        return self._complete()

    def _select(self, offspring: list[Individual]) -> None:
        """Keep the N_p individuals of the lowest T; among equals parents, then earlier ones."""
        everyone = sorted(self._population + offspring, key=lambda one: one.verdict.T)
        self._population = everyone[: self._settings.population]

    def _choose_mutants(self) -> bool:
        """Ask for mutants of random individuals; False where there are none to make."""
        settings = self._settings
        rng = stream(settings.seed, Purpose.CHOICE_OF_MUTANTS, self.generation)
        chosen = rng.choice(settings.population, self.mutants, replace=False)
        self._mutated = [int(place) for place in chosen]
        self._pending = [
            mutate(
                self._population[place].points,
                MUTATIONS[settings.mutation],
                settings.mutated_share,
                stream(settings.seed, Purpose.MUTATION, self.generation, index),
            )
            for index, place in enumerate(self._mutated)
        ]
        self.stage = Stage.MUTANTS
        return bool(self._pending)

    def _complete(self) -> Generation:
        best = min(self._population, key=lambda one: one.verdict.L)
        ever = self._best_ever or best
        record = Generation(self.generation, self.evaluations, tuple(self._population), best, ever)
        self.generation += 1
        self.stage = Stage.OFFSPRING
        self._pending = self._recombined()
        return record

    def _recombined(self) -> list[FeaturePoints]:
        settings = self._settings
        cross = RECOMBINATIONS[settings.recombination]
        offspring: list[FeaturePoints] = []
        for pair in range(self.pairs):
            rng = stream(settings.seed, Purpose.RECOMBINATION, self.generation, pair)
            a, b = (
                self._population[int(k)].points
                for k in rng.choice(settings.population, 2, replace=False)
            )
            offspring += cross(a, b, self._grid, settings.swapped_share, rng)
        return offspring
