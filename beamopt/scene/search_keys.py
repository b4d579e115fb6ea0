"""How a scene searches, and when it stops."""

from __future__ import annotations

from typing import Literal

from beamopt.scene.generation_size import check_generation
from beamopt.storage.checked_keys import CheckedKeys, Count, Number, quantity

__all__ = ["Refining", "Search", "Stop"]


class Search(CheckedKeys):
    """The genetic algorithm.

    Examples
    --------
    >>> import beamopt
    >>> beamopt.Search(generations=50).population
    20
    """

    population: Count = quantity(20, "individuals, N_p", low=2, high=10_000)
    generations: Count = quantity(100, "generations, N_g", low=0, high=1_000_000)
    crossover_probability: Number = quantity(0.8, "offspring per individual, p_c", low=0, high=10)
    mutation_probability: Number = quantity(0.1, "share of individuals mutated, p_m", low=0, high=1)
    mutated_share: Number = quantity(0.1, "mutated edges per feature point, p_f", low=0, high=1)
    swapped_share: Number = quantity(0.5, "share swapped by fixed recombination, ν", low=0, high=1)
    improved_share: Number = quantity(
        0.0, "share of individuals refined a little in a generation, the best first", low=0, high=1
    )
    neighbour_weight: Number = quantity(
        1000.0, "weight of the second objective, λ", low=0, high=1e9
    )
    recombination: Literal["fixed", "range"] = quantity("fixed", "crossover method")
    mutation: Literal["direct", "weighted"] = quantity("direct", "mutation method")
    seed: Count = quantity(0, "seed of everything random in the search", low=0)

    def check_memory(self, points: int, elements: int) -> None:
        """Refuse a generation that takes gigabytes; see `check_generation`."""
        batch = round(max(1.0, self.crossover_probability) * self.population)
        check_generation("search.population", self.population, batch, points, elements)


class Stop(CheckedKeys):
    """Reasons to stop before the last generation; a key that is left out never does.

    Examples
    --------
    >>> import beamopt
    >>> beamopt.Stop(evaluations=500)
    Stop(evaluations=500)
    """

    evaluations: Count | None = quantity(
        None, "most sections judged; the first population is", low=1
    )
    seconds: Number | None = quantity(None, "most time, counted anew on --resume", unit="s", low=0)
    stall: Count | None = quantity(None, "generations without a lower L", unit="generations", low=1)
    loss: Number | None = quantity(None, "an L that is good enough", unit="mm²", low=0)


class Refining(CheckedKeys):
    """What goes beyond the genetic algorithm: annealing of types, Gauss-Newton on positions.

    Examples
    --------
    >>> import beamopt
    >>> beamopt.Refining(rounds=2).rounds
    2
    """

    finish: bool = quantity(False, "whether a search ends by refining its best design")
    flips: Count = quantity(40_000, "flips of a type proposed in a round", low=0, high=10**9)
    walks: Count = quantity(
        20, "chains of flips in a round, each judged at its end", low=1, high=1_000_000
    )
    hot: Number = quantity(150.0, "first temperature of the annealing", unit="mm²", low=1e-9)
    cold: Number = quantity(3.0, "last temperature of the annealing", unit="mm²", low=1e-9)
    steps: Count = quantity(60, "most sections judged while points move in a round", low=0)
    outline_steps: Count = quantity(
        40, "most outlines judged in the end, of sealed sections", low=0
    )
    rounds: Count | None = quantity(
        None,
        "most rounds, fewer where moving settles; left out: 6, or 16 if sealed",
        low=1,
        high=1000,
    )
    good_enough: Number = quantity(0.05, "a loss with nothing left to refine", unit="mm²", low=0)
    ratio_enough: Number = quantity(
        0.65, "share of the first neighbour ratio that is low enough", low=0, high=1
    )
