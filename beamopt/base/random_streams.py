"""Random streams: one for every (seed, purpose, generation, index), never one for a worker."""

from __future__ import annotations

from enum import IntEnum

import numpy as np

__all__ = ["Purpose", "stream"]


class Purpose(IntEnum):
    """What a stream is drawn for; the numbers are part of every result."""

    INITIAL = 0
    RECOMBINATION = 1
    CHOICE_OF_MUTANTS = 2
    MUTATION = 3
    REFINEMENT = 4
    IMPROVEMENT = 5
    FRONT_PARENTS = 6
    FRONT_OFFSPRING = 7
    FRONT_SURVIVAL = 8


def stream(seed: int, purpose: Purpose, generation: int = 0, index: int = 0) -> np.random.Generator:
    """The generator of random numbers for one step of a search."""
    key = (int(purpose), generation, index)
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed, spawn_key=key)))
