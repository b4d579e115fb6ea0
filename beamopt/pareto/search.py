"""NSGA-II over feature points: pymoo's selection and survival, the paper's operators."""

from __future__ import annotations

from array import array
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.random_streams import Purpose, stream
from beamopt.judge.judge import JudgeStatus
from beamopt.pareto.scores import Score, nondominated
from beamopt.scene.scene import Scene
from beamopt.search.variation import Variation
from beamopt.section.feature_points import FeaturePoints

__all__ = ["Candidate", "FrontNumbers", "FrontRecord", "FrontSearch", "front_values"]

LEAST = 1e-12  # mm²; a lower L is none

TRIES = 20  # matings for each pair that is wanted, before fewer offspring will do


@dataclass(frozen=True, slots=True)
class Candidate:
    """A genotype and its score."""

    points: FeaturePoints
    score: Score


@dataclass(frozen=True, slots=True)
class FrontRecord:
    """The state after a generation.

    index : 0 for the initial population. evaluations : sections judged so far.
    front : of all that were judged so far, those that none beats, by the first objective.
    """

    index: int
    evaluations: int
    front: tuple[Candidate, ...]


@dataclass(frozen=True, eq=False)
class FrontNumbers:
    """The numbers of a generation, without genotypes.

    index : 0 for the initial population. evaluations : sections judged so far.
    values : (n, objectives) along the front of all that were judged so far.
    """

    index: int
    evaluations: int
    values: FloatArray


class FrontSearch:
    """NSGA-II (Deb et al., 2002) on several objectives of a scene: ask, judge, tell.

    Deterministic: candidates follow from the scene's search settings and the scores told. What can
    not be judged is never on a front; among such, fewer chambers too many are selected.

    Parameters
    ----------
    scene : its section, rules, operators and seed. objectives : names, see `OBJECTIVES`.
    population : individuals.
    """

    def __init__(self, scene: Scene, objectives: Sequence[str], population: int) -> None:
        self._settings, self._objectives = scene.search, tuple(objectives)
        self._variation = Variation(scene)
        self._size = population
        self._algorithm, self._problem = _nsga2(self, len(objectives))
        self.generation = self.evaluations = 0
        self.rejected: Counter[JudgeStatus] = Counter()
        self.front: tuple[Candidate, ...] = ()
        self._seen = array("d")
        self._ask()

    def first(self) -> list[FeaturePoints]:
        """The initial population, of which the first ones are those of the scene's own search."""
        seed = self._settings.seed
        return [
            self._variation.initial(stream(seed, Purpose.INITIAL, 0, index))
            for index in range(self._size)
        ]

    @property
    def seen(self) -> FloatArray:
        """(n, objectives) values of all that were judged."""
        return np.array(self._seen).reshape(-1, len(self._objectives))

    def ask(self) -> tuple[FeaturePoints, ...]:
        """The candidates to be judged now; asking again gives the same ones."""
        return tuple(self._pending)

    def tell(self, scores: Sequence[Score]) -> FrontRecord:
        """Take the scores of what was asked for, in that order; a generation is then complete."""
        from pymoo.problems.static import StaticProblem

        judged = [Candidate(p, s) for p, s in zip(self._pending, scores, strict=True)]
        self.evaluations += len(judged)
        self._remember(judged)
        values = np.array([score.values(self._objectives) for score in scores])
        excess = np.array([[score.excess] for score in scores])
        # of what is not judged pymoo looks at the excess only
        known = StaticProblem(self._problem, F=np.where(excess > 0, 0.0, _scaled(values)), G=excess)
        algorithm = self._algorithm
        algorithm.random_state = self._stream(Purpose.FRONT_SURVIVAL)
        algorithm.evaluator.eval(known, self._infills)
        algorithm.tell(infills=self._infills)
        record = FrontRecord(self.generation, self.evaluations, self.front)
        self.generation += 1
        self._ask()
        return record

    def offspring(self, population: Any, count: int) -> list[FeaturePoints]:
        """New genotypes from pymoo's population, each unlike all there, `count` at most."""
        settings = self._settings
        rng = self._stream(Purpose.FRONT_PARENTS)
        self._algorithm.random_state = rng
        parents = [individual.X[0] for individual in population]
        known = {points.digest for points in parents}
        made: list[FeaturePoints] = []
        index = 0
        while len(made) < count and index < TRIES * count:
            pairs = -(-(count - len(made)) // 2)
            for one, other in self._select(population, pairs, rng):
                own = stream(settings.seed, Purpose.FRONT_OFFSPRING, self.generation, index)
                index += 1
                for points in self._children(parents[one], parents[other], known, own):
                    if points.digest not in known and len(made) < count:
                        known.add(points.digest)
                        made.append(points)
        return made

    def _children(
        self, a: FeaturePoints, b: FeaturePoints, known: set[str], rng: np.random.Generator
    ) -> list[FeaturePoints]:
        """Two from two, mutated with p_m, and always where they are nothing new."""
        settings, two = self._settings, (a, b)
        if rng.random() < settings.crossover_probability:
            two = self._variation.offspring(a, b, rng)
        draws = rng.random(2)
        return [
            self._variation.mutant(one, rng)
            if one.digest in known or draw < settings.mutation_probability
            else one
            for one, draw in zip(two, draws, strict=True)
        ]

    def _select(self, population: Any, pairs: int, rng: np.random.Generator) -> Any:
        """Places (pairs, 2) of parents, each the better of two random ones."""
        from pymoo.algorithms.moo.nsga2 import binary_tournament
        from pymoo.operators.selection.tournament import TournamentSelection

        tournament = TournamentSelection(func_comp=binary_tournament)
        about = {"n_parents": 2, "to_pop": False, "random_state": rng, "algorithm": self._algorithm}
        return tournament.do(self._problem, population, pairs, **about)

    def _ask(self) -> None:
        self._infills = self._algorithm.ask()
        found = [] if self._infills is None else [individual.X[0] for individual in self._infills]
        self._pending: list[FeaturePoints] = found

    def _remember(self, judged: list[Candidate]) -> None:
        """Add to the front what belongs there, and to what was seen and rejected."""
        for one in judged:
            if one.score.judged:
                self._seen.extend(one.score.values(self._objectives))
            else:
                self.rejected[one.score.verdict.status] += 1
        everyone = [*self.front, *(one for one in judged if one.score.judged)]
        if everyone:
            values = np.array([one.score.values(self._objectives) for one in everyone])
            kept = [everyone[k] for k in nondominated(values)]
            kept.sort(key=lambda one: one.score.values(self._objectives))
            self.front = tuple(kept)

    def _stream(self, purpose: Purpose) -> np.random.Generator:
        return stream(self._settings.seed, purpose, self.generation)


@dataclass(frozen=True)
class _Mating:
    """Makes offspring as pymoo asks for them."""

    search: FrontSearch

    def do(self, problem: Any, population: Any, count: int, **about: Any) -> Any:
        from pymoo.core.population import Population

        return Population.new("X", _column(self.search.offspring(population, count)))


def _nsga2(search: FrontSearch, objectives: int) -> tuple[Any, Any]:
    """The algorithm, and the problem that it takes this to be."""
    from pymoo.algorithms.moo.nsga2 import NSGA2
    from pymoo.config import Config
    from pymoo.core.problem import Problem
    from pymoo.core.termination import NoTermination

    Config.warnings["not_compiled"] = False
    problem = Problem(n_var=1, n_obj=objectives, n_ieq_constr=1, vtype=object)
    first = search.first()
    algorithm = NSGA2(
        pop_size=len(first),
        sampling=_column(first),
        mating=_Mating(search),
        eliminate_duplicates=False,
        output=None,
    )
    algorithm.setup(problem, termination=NoTermination())
    return algorithm, problem


def _scaled(values: FloatArray) -> FloatArray:
    """Values (n, objectives) with L by its logarithm, which leaves what beats what as it is.

    L goes over decades along a front: as it is, all low ones would be crowded by the highest one.
    """
    scaled = values.copy()
    scaled[:, 0] = np.log(np.maximum(values[:, 0], LEAST))
    return scaled


def _column(points: Sequence[FeaturePoints]) -> Any:
    """Genotypes as pymoo keeps variables of any kind: (n, 1) objects."""
    column = np.empty((len(points), 1), dtype=object)
    for k, one in enumerate(points):
        column[k, 0] = one
    return column


def front_values(front: Sequence[Candidate], objectives: Sequence[str]) -> FloatArray:
    """(n, objectives) values along a front."""
    return np.array([one.score.values(objectives) for one in front]).reshape(-1, len(objectives))
