"""All cases of all stages, each as soon as what predicts it is known."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from concurrent.futures import Executor, Future
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.lost_workers import lost_errors
from femcheck.check.stage import Stage
from femcheck.continuation.limits import Limits
from femcheck.continuation.pressure_tree import Node, all_nodes, ancestors, prediction
from femcheck.solid.state import State
from femcheck.solved.case import Case, CaseResult, rest_slopes, solve_case, stopped

__all__ = ["Key", "Schedule"]

Key = tuple[str, Node]
"""A case: the name of its stage, and its node of the pressure tree."""


@dataclass
class Schedule:
    """What is known and what is to be done; guesses depend on nothing but the tree.

    Parameters
    ----------
    stages : in the order in which they are begun.
    levels : three pressure levels [kPa].
    limits : of a case.
    results : of the cases that are done.
    slopes : of the stages' shapes at rest.
    """

    stages: Sequence[Stage]
    levels: tuple[float, float, float]
    limits: Limits
    results: dict[Key, CaseResult] = field(default_factory=dict)
    slopes: dict[str, FloatArray | None] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._tried: set[str] = set()
        self._stage = {stage.name: stage for stage in self.stages}
        self.keys = [(stage.name, node) for stage in self.stages for node in all_nodes()]

    def pressures(self, node: Node) -> FloatArray:
        """(3,) [kPa]."""
        return np.array([self.levels[index] for index in node])

    def is_ready(self, key: Key) -> bool:
        """Whether everything that predicts a case is known, and everything that it may start from.

        What else is known by then must not matter: it depends on how many are solved at once.
        """
        return all(self._is_known(name, source) for name, source in self._sources(key))

    def builds_on(self, key: Key, others: Collection[Key]) -> bool:
        """True if a case is predicted from, or may start from, any of the others."""
        return any((name, source) in others for name, source in self._sources(key))

    def _sources(self, key: Key) -> list[tuple[str, Node | int]]:
        """Cases, and supplies whose slope at rest is meant, each with the name of its stage."""
        name, node = key
        follows = self._stage[name].follows
        needed = [source for _, source in prediction(node, self.levels)]
        own = [(name, source) for source in (*needed, *ancestors(node))]
        led = [] if follows is None else [(follows, source) for source in (*needed, node)]
        return own + led

    def _is_known(self, name: str, source: Node | int) -> bool:
        return name in self.slopes if isinstance(source, int) else (name, source) in self.results

    def begin(self, executor: Executor, waiting: Sequence[Key]) -> bool:
        """Find the slopes at rest of all stages begun; False where a process died of it.

        A stage whose process dies twice has none.
        """
        begun = {key[0] for key in waiting}
        begun |= {stage.follows for stage in self.stages if stage.name in begun and stage.follows}
        for stage in self.stages:
            if stage.name in begun and stage.name not in self.slopes:
                try:
                    self.slopes[stage.name] = executor.submit(rest_slopes, stage.solid).result()
                except lost_errors():
                    if stage.name in self._tried:
                        self.slopes[stage.name] = None  # its cases start without a prediction
                    self._tried.add(stage.name)
                    return False
        return True

    def submit(self, executor: Executor, key: Key) -> Future[CaseResult]:
        """Have a case solved."""
        return executor.submit(solve_case, self.case(key))

    def stopped(self, key: Key) -> CaseResult:
        """The result of a case whose process died."""
        return stopped()

    def case(self, key: Key) -> Case:
        """The case with its guess and its start."""
        name, node = key
        solid = self._stage[name].solid
        return Case(solid, self.pressures(node), self._guess(key), self._start(key), self.limits)

    def _start(self, key: Key) -> tuple[State, FloatArray] | None:
        """The nearest equilibrium on the way back to the first node."""
        name, node = key
        for ancestor in ancestors(node):
            found = self.results.get((name, ancestor))
            if found is not None and found.outcome.state is not None:
                return found.outcome.state, self.pressures(ancestor)
        return None

    def _guess(self, key: Key) -> FloatArray | None:
        name, node = key
        own = self._predicted(name, node)
        follows = self._stage[name].follows
        if follows is None:
            return own
        before = self.results[follows, node].shape
        if before is None or own is None:
            return own if before is None else before
        foretold = self._predicted(follows, node)
        return before if foretold is None else before + (own - foretold)

    def _predicted(self, name: str, node: Node) -> FloatArray | None:
        """The sum of the prediction's terms; None where one of them is missing."""
        total: Any = 0.0
        for factor, source in prediction(node, self.levels):
            if isinstance(source, int):
                slopes = self.slopes.get(name)
                term = None if slopes is None else slopes[source - 1]
            else:
                term = self.results[name, source].shape
            if term is None:
                return None
            total = total + factor * term
        return np.asarray(total)
