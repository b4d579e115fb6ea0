"""The genetic algorithm itself: ask for candidates, tell their verdicts."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum

from beamopt.base.random_streams import Purpose, stream
from beamopt.judge.judge import JudgeStatus, Verdict
from beamopt.scene.scene import Scene
from beamopt.search.improvement import Improvement
from beamopt.search.variation import Variation
from beamopt.section.feature_points import FeaturePoints

__all__ = ["CandidateKind", "Generation", "GeneticAlgorithm", "Individual"]


class CandidateKind(Enum):
    """Kind of the candidates asked for; the value is the text shown to people."""

    INITIAL = "initial"
    OFFSPRING = "offspring"
    MUTANTS = "mutants"
    IMPROVED = "improved"

    @property
    def key(self) -> str:
        """As the journal has it."""
        return self.name.lower()


@dataclass(frozen=True, slots=True)
class Individual:
    """A genotype and what became of it.

    Examples
    --------
    >>> import beamopt
    >>> scene = beamopt.load_scene("random-section", ["search.generations=0"])
    >>> last = beamopt.run(scene, beamopt.Judge.of_scene(scene, scene.load_target())).last
    >>> individual: beamopt.Individual = last.best_ever
    >>> individual.verdict.status.name
    'JUDGED'
    """

    points: FeaturePoints
    verdict: Verdict

    def __repr__(self) -> str:
        return f"<Individual: {len(self.points)} feature points, {self.verdict}>"


@dataclass(frozen=True, slots=True)
class Generation:
    """The state after a generation.

    index : 0 for the initial population.
    evaluations : sections judged so far.
    population : the individuals, after mutation.
    best : the one with the lowest L + R in this population; without rules the paper's metric.
    best_ever : the one with the lowest L + R of all that were judged so far.
    rejected : how many so far could not be judged or may not be made, by reason.

    Examples
    --------
    >>> import beamopt
    >>> scene = beamopt.load_scene("random-section", ["search.generations=1"])
    >>> judge = beamopt.Judge.of_scene(scene, scene.load_target())
    >>> last: beamopt.Generation = beamopt.run(scene, judge).last
    >>> last.index, last.evaluations
    (1, 38)
    """

    index: int
    evaluations: int
    population: tuple[Individual, ...]
    best: Individual
    best_ever: Individual
    rejected: Mapping[JudgeStatus, int] = field(default_factory=dict)

    def __repr__(self) -> str:
        L, ever = self.best.verdict.L, self.best_ever.verdict.L
        return (
            f"<Generation {self.index}: L = {L:.4g} mm², lowest so far {ever:.4g} mm², "
            f"{self.evaluations} sections judged>"
        )


class GeneticAlgorithm:
    """Recombination, selection on T, mutation; N_p individuals (paper, Genetic Algorithm).

    With an improvement it is a memetic one: in every generation the share of individuals with the
    lowest T that the scene asks for is refined a little, and keeps its place unless T fell.

    Deterministic: candidates follow from the scene's search settings and the verdicts told.

        while ...:
            record = search.tell(judge(search.ask()))

    Examples
    --------
    >>> import beamopt
    >>> scene = beamopt.load_scene("random-section")
    >>> judge = beamopt.Judge.of_scene(scene, scene.load_target())
    >>> search = beamopt.GeneticAlgorithm(scene)
    >>> generation = search.tell(judge(search.ask()))
    >>> search.evaluations
    20
    """

    def __init__(self, scene: Scene, improvement: Improvement | None = None) -> None:
        self._settings = scene.search
        self._improvement = improvement
        self._variation = Variation(scene)
        self._rejected: Counter[JudgeStatus] = Counter()
        self.rules_set = scene.making.rules_set
        seed = scene.search.seed
        self._pending: list[FeaturePoints] = [
            self._variation.initial(stream(seed, Purpose.INITIAL, 0, index))
            for index in range(scene.search.population)
        ]
        self._chosen: list[int] = []
        self._population: list[Individual] = []
        self._best_ever: Individual | None = None
        self.stage = CandidateKind.INITIAL
        self.generation = 0
        self.evaluations = 0

    def __repr__(self) -> str:
        return (
            f"<GeneticAlgorithm: generation {self.generation}, {self.stage.value}, "
            f"{self.evaluations} sections judged>"
        )

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
        """Sections that the next generation will have judged, at most."""
        each = 0 if self._improvement is None else self._improvement.most_evaluations + 1
        return 2 * self.pairs + self.mutants + each * self.improvements

    @property
    def improvements(self) -> int:
        """Individuals refined a little in a generation."""
        if self._improvement is None:
            return 0
        return round(self._settings.improved_share * self._settings.population)

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
        for one in judged:
            if one.verdict.status is not JudgeStatus.JUDGED:
                self._rejected[one.verdict.status] += 1
            ever = self._best_ever
            if ever is None or one.verdict.ruled_loss < ever.verdict.ruled_loss:
                self._best_ever = one
        if self.stage is CandidateKind.INITIAL:
            self._population = judged
        elif self.stage is CandidateKind.OFFSPRING:
            self._select(judged)
            if self._choose_mutants() or self._improve():
                return None
        elif self.stage is CandidateKind.MUTANTS:
            for place, mutant in zip(self._chosen, judged, strict=True):
                self._population[place] = mutant
            if self._improve():
                return None
        else:
            for place, better in zip(self._chosen, judged, strict=True):
                if better.verdict.T < self._population[place].verdict.T:
                    self._population[place] = better
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
        self._chosen = [int(place) for place in chosen]
        self._pending = [
            self._variation.mutant(
                self._population[place].points,
                stream(settings.seed, Purpose.MUTATION, self.generation, index),
            )
            for index, place in enumerate(self._chosen)
        ]
        self.stage = CandidateKind.MUTANTS
        return bool(self._pending)

    def _improve(self) -> bool:
        """Ask for the best individuals, refined a little; False where there are none to make."""
        if self._improvement is None or not self.improvements:
            return False
        order = sorted(range(len(self._population)), key=lambda k: self._population[k].verdict.T)
        self._chosen = order[: self.improvements]
        self._pending = []
        for index, place in enumerate(self._chosen):
            points = self._population[place].points
            better, judged = self._improvement(points, self.generation, index)
            self.evaluations += judged
            self._pending.append(better)
        self.stage = CandidateKind.IMPROVED
        return True

    def _complete(self) -> Generation:
        best = min(self._population, key=lambda one: one.verdict.ruled_loss)
        ever, population = self._best_ever or best, tuple(self._population)
        rejected = dict(self._rejected)
        record = Generation(self.generation, self.evaluations, population, best, ever, rejected)
        self.generation += 1
        self.stage = CandidateKind.OFFSPRING
        self._pending = self._recombined()
        return record

    def _recombined(self) -> list[FeaturePoints]:
        settings = self._settings
        offspring: list[FeaturePoints] = []
        for pair in range(self.pairs):
            rng = stream(settings.seed, Purpose.RECOMBINATION, self.generation, pair)
            a, b = (
                self._population[int(k)].points
                for k in rng.choice(settings.population, 2, replace=False)
            )
            offspring += self._variation.offspring(a, b, rng)
        return offspring
