"""Searches at equal budgets: each begins with the scene's seed and runs until it is stopped."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from itertools import count
from typing import Any

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.random_streams import Purpose, stream
from beamopt.refine.refine import refine
from beamopt.scene.scene import Scene
from beamopt.scene.search_keys import Search
from beamopt.search.loop import run
from beamopt.search.variation import Variation
from beamopt.section.feature_points import FeaturePoints
from tests.bench.search_tape import TapedJudge

__all__ = ["METHODS", "Method"]

Method = Callable[[Scene, TapedJudge], None]
"""Searches with a scene's seed; ends by itself, or when the judge's budget is spent."""

PAPER = {
    "FD": ("fixed", "direct"),
    "FW": ("fixed", "weighted"),
    "RD": ("range", "direct"),
    "RW": ("range", "weighted"),
}
ENDLESS = 1_000_000  # generations
STEP = 0.5  # mm, of CMA-ES at first; see `cma_es`
RESTARTS = 9  # most that the library's manual asks for


def paper(combination: str, scene: Scene, judge: TapedJudge) -> None:
    """The paper's genetic algorithm."""
    recombination, mutation = PAPER[combination]
    settings = {"recombination": recombination, "mutation": mutation, "generations": ENDLESS}
    run(with_search(scene, settings), judge)


def memetic(scene: Scene, judge: TapedJudge) -> None:
    """The genetic algorithm, the best tenth of whose individuals are refined in a generation."""
    run(with_search(scene, {"improved_share": 0.1, "generations": ENDLESS}), judge)


def random_search(scene: Scene, judge: TapedJudge) -> None:
    """Random genotypes, of which the first ones are the first population of the others."""
    starts = random_starts(scene)
    while True:
        judge([next(starts) for _ in range(scene.search.population)])


def refined(scene: Scene, judge: TapedJudge) -> None:
    """Annealing and Gauss-Newton, from one random genotype; ends by itself."""
    _refine(scene, judge, next(random_starts(scene)))


def evolved_and_refined(scene: Scene, judge: TapedJudge) -> None:
    """The paper's search, then a refinement of the lowest L that it met; ends by itself."""
    ended = run(scene, judge)
    _refine(scene, judge, ended.last.best_ever.points)


def pymoo_ga(scene: Scene, judge: TapedJudge) -> None:
    """pymoo's GA on T: its tournament and survival, the paper's operators and probabilities."""
    from pymoo.algorithms.soo.nonconvex.ga import GA
    from pymoo.config import Config
    from pymoo.core.crossover import Crossover
    from pymoo.core.duplicate import ElementwiseDuplicateElimination
    from pymoo.core.mutation import Mutation
    from pymoo.core.problem import Problem
    from pymoo.core.termination import NoTermination

    Config.warnings["not_compiled"] = False
    variation, settings, starts = Variation(scene), scene.search, random_starts(scene)

    class Sections(Problem):  # type: ignore[misc]
        def _evaluate(self, x: Any, out: dict[str, Any], *args: Any, **about: Any) -> None:
            out["F"] = np.array([[verdict.T] for verdict in judge(list(x[:, 0]))])

    class Recombination(Crossover):  # type: ignore[misc]
        def _do(self, problem: Any, x: Any, *args: Any, random_state: Any, **about: Any) -> Any:
            pairs = zip(*x[:, :, 0], strict=True)
            made = [variation.offspring(a, b, random_state) for a, b in pairs]
            return np.stack([_column([pair[k] for pair in made]) for k in range(2)])

    class Change(Mutation):  # type: ignore[misc]
        def _do(self, problem: Any, x: Any, *args: Any, random_state: Any, **about: Any) -> Any:
            return _column([variation.mutant(points, random_state) for points in x[:, 0]])

    class Twins(ElementwiseDuplicateElimination):  # type: ignore[misc]
        def is_equal(self, a: Any, b: Any) -> bool:
            return bool(a.X[0].digest == b.X[0].digest)

    algorithm = GA(
        pop_size=settings.population,
        sampling=_column([next(starts) for _ in range(settings.population)]),
        crossover=Recombination(2, 2, prob=settings.crossover_probability),
        mutation=Change(prob=settings.mutation_probability),
        eliminate_duplicates=Twins(),
    )
    problem = Sections(n_var=1, n_obj=1, vtype=object)
    algorithm.setup(problem, termination=NoTermination(), seed=settings.seed, verbose=False)
    while algorithm.has_next():
        algorithm.next()


def cma_es(objective: str, scene: Scene, judge: TapedJudge) -> None:
    """CMA-ES on positions, from a random genotype whose types stay; BIPOP restarts from others.

    Its first step is that of the lowest T after 7,280 sections on random-section, of 0.12, 0.25, …
    8 mm and three other seeds; on hand-drawn-workspace 0.25 mm is as good, 2 mm early on better.

    objective : "T" or "L".
    """
    import cma

    starts, types = random_starts(scene), np.zeros(0, dtype=np.uint8)

    def start() -> FloatArray:
        nonlocal types
        points = next(starts)
        types = points.type
        return np.concatenate([points.x, points.y])

    def losses(places: list[FloatArray]) -> list[float]:
        genotypes = [FeaturePoints(*place.reshape(2, -1), types) for place in places]
        values = [getattr(verdict, objective) for verdict in judge(genotypes)]
        return [value if np.isfinite(value) else 1e12 for value in values]

    options = {"seed": scene.search.seed + 1, "verbose": -9, "verb_log": 0}  # 0 is the clock's
    before = np.random.get_state()  # noqa: NPY002  the library draws from this one
    try:
        cma.fmin2(
            None, start, STEP, options, parallel_objective=losses, restarts=RESTARTS, bipop=True
        )
    finally:
        np.random.set_state(before)  # noqa: NPY002


METHODS: dict[str, Method] = {
    **{f"paper {combination}": partial(paper, combination) for combination in PAPER},
    "random search": random_search,
    "pymoo GA": pymoo_ga,
    "CMA-ES": partial(cma_es, "T"),
    "CMA-ES on L": partial(cma_es, "L"),
    "refine": refined,
    "GA, then refine": evolved_and_refined,
    "memetic GA": memetic,
}


def with_search(scene: Scene, settings: dict[str, Any]) -> Scene:
    """The scene with some of its search's settings replaced, and checked."""
    search = Search.model_validate(scene.search.model_dump() | settings)
    return scene.model_copy(update={"search": search})


def random_starts(scene: Scene) -> Iterator[FeaturePoints]:
    """Random genotypes without end; the first ones are the genetic algorithm's population."""
    variation = Variation(scene)
    for index in count():
        yield variation.initial(stream(scene.search.seed, Purpose.INITIAL, 0, index))


def _refine(scene: Scene, judge: TapedJudge, points: FeaturePoints) -> None:
    refine(judge, points, scene.refine, seed=scene.search.seed)


def _column(points: list[FeaturePoints]) -> Any:
    """Genotypes as pymoo keeps variables of any kind: (n, 1) objects."""
    column = np.empty((len(points), 1), dtype=object)
    column[:, 0] = points
    return column
