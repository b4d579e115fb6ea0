"""What a study runs: every target, combination of methods and iteration (paper, Results)."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import dataclass

from beamopt.base.brief import changed_fields
from beamopt.base.errors import InputError
from beamopt.scene.bundled import bundled_scenes
from beamopt.scene.scene import Scene, load_scene

__all__ = ["COMBINATIONS", "TARGETS", "Plan", "Run"]

TARGETS = ("random-section", "hand-drawn-section", "hand-drawn-workspace")
COMBINATIONS = {
    "FD": ("fixed", "direct"),
    "FW": ("fixed", "weighted"),
    "RD": ("range", "direct"),
    "RW": ("range", "weighted"),
}


DECIDED = ("search.seed", "search.recombination", "search.mutation", "refine.finish")


@dataclass(frozen=True, slots=True)
class Run:
    """One search of a study.

    Its scene is a bundled one with two methods and a seed, so that any single run can be repeated
    with `beamopt optimize`. The initial population follows from the seed alone: it differs between
    iterations and is the same for every combination and target.

    Examples
    --------
    >>> import beamopt
    >>> run: beamopt.Run = beamopt.Plan(iterations=1).runs()[0]
    >>> run.name
    'random-section-FD-1'
    """

    target: str
    combination: str
    iteration: int
    seed: int
    overrides: tuple[str, ...] = ()
    refine: bool = False

    __repr__ = changed_fields

    @property
    def name(self) -> str:
        """Folder of the run."""
        return f"{self.target}-{self.combination}-{self.iteration}"

    def scene(self) -> Scene:
        """The scene that this run searches."""
        recombination, mutation = COMBINATIONS[self.combination]
        methods = (f'search.recombination="{recombination}"', f'search.mutation="{mutation}"')
        decided = (
            *methods,
            f"search.seed={self.seed}",
            f"refine.finish={str(self.refine).lower()}",
        )
        return load_scene(self.target, [*self.overrides, *decided])


@dataclass(frozen=True, slots=True)
class Plan:
    """All runs of a study.

    iterations : runs of each target and combination.
    seed : seed of the first iteration; the others count up from it.
    overrides : keys replaced in every scene.
    targets : the bundled scenes to search.
    refine : whether every search ends by refining its best design.

    Raises
    ------
    InputError : an override of what the study itself decides, or a target that is no bundled scene.

    Examples
    --------
    >>> import beamopt
    >>> len(beamopt.Plan(iterations=1).runs())
    12
    """

    iterations: int = 4
    seed: int = 0
    overrides: tuple[str, ...] = ()
    targets: tuple[str, ...] = TARGETS
    refine: bool = True

    __repr__ = changed_fields

    def __post_init__(self) -> None:
        for override in self.overrides:
            key = override.partition("=")[0].strip()
            if key in DECIDED:
                raise InputError("--set", "", override, f"a study decides {key} for every search")
        for target in self.targets:
            if target not in bundled_scenes():
                said = f"one of {', '.join(bundled_scenes())}"
                raise InputError("--target", "", target, said)
        if len(set(self.targets)) < len(self.targets) or not self.targets:
            raise InputError("--target", "", " ".join(self.targets), "one or more, once each")

    def runs(self) -> Sequence[Run]:
        """Every run, in the order of the table."""
        return [
            Run(
                target,
                combination,
                iteration,
                self.seed + iteration - 1,
                self.overrides,
                self.refine,
            )
            for target in self.targets
            for combination in COMBINATIONS
            for iteration in range(1, self.iterations + 1)
        ]

    @property
    def command(self) -> str:
        """What makes this study, but for `--out`."""
        words = ["beamopt", "study", "--iterations", str(self.iterations), "--seed", str(self.seed)]
        if self.targets != TARGETS:
            words += [word for target in self.targets for word in ("--target", target)]
        words += [] if self.refine else ["--no-refine"]
        return shlex.join([*words, *(f"--set={override}" for override in self.overrides)])
