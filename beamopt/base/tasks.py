"""Work on any executor, whose tasks may depend on others, and on processes that may die under it.

Workers are processes, or one thread: a worker keeps factors between tasks.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from typing import Any, Generic, Protocol, TypeVar

from beamopt.base.errors import NotComputedError
from beamopt.base.lost_workers import lost_errors

__all__ = ["Key", "Result", "Tasks", "Work", "check_none_lost", "solve_all"]

Key = TypeVar("Key", bound=tuple[Any, ...] | str | int)
Result = TypeVar("Result")


class Work(Protocol[Key, Result]):
    """Tasks by key, and the results so far; independent ones unless a class says otherwise."""

    results: dict[Key, Result]

    @property
    def keys(self) -> Sequence[Key]:
        """All tasks, in the order in which they are begun."""
        ...

    def begin(self, executor: Executor, waiting: Sequence[Key]) -> bool:
        """Do what comes before the tasks; False where a process died of it."""
        return True

    def is_ready(self, key: Key) -> bool:
        """Whether everything that a task builds on is known."""
        return True

    def submit(self, executor: Executor, key: Key) -> Future[Result]:
        """Have a task done."""
        ...

    def stopped(self, key: Key) -> Result:
        """The result of a task whose process died."""
        ...


@dataclass
class Tasks(Work[Key, Result | None], Generic[Key, Result]):
    """Independent tasks: one function, and its arguments by key.

    A task that its process dies of twice has no result: None.
    """

    function: Callable[..., Result]
    arguments: Mapping[Key, tuple[Any, ...]]
    results: dict[Key, Result | None] = field(default_factory=dict)

    @property
    def keys(self) -> Sequence[Key]:
        """In the order of the arguments."""
        return list(self.arguments)

    def submit(self, executor: Executor, key: Key) -> Future[Result | None]:
        """Have a task done."""
        return executor.submit(self.function, *self.arguments[key])

    def stopped(self, key: Key) -> Result | None:
        """No result."""
        return None

    @property
    def lost(self) -> list[Key]:
        """Tasks that their process died of."""
        return [key for key in self.keys if key in self.results and self.results[key] is None]


def check_none_lost(work: Tasks[Key, Any], way_out: str) -> None:
    """Check that every task has a result.

    Raises
    ------
    NotComputedError : names the first task that has none; `way_out` says what to do.
    """
    if work.lost:
        others = f" (and of {len(work.lost) - 1} others)" if len(work.lost) > 1 else ""
        said = f"its process{others} ended before it was done, also alone; {way_out}"
        raise NotComputedError(str(work.lost[0]), said)


def solve_all(
    work: Work[Key, Result],
    pool: Callable[[], AbstractContextManager[Executor]],
    workers: int,
    keep: Callable[[Key, Result], None],
) -> None:
    """Do what is not in `work.results` yet, `workers` tasks at once.

    Where a process dies, the others go on in a new pool, and each task that was under way is tried
    again alone; only one that its process dies of then, too, gets the result `stopped`, whatever
    the number of workers.

    pool : makes the executor. keep : is called with every result as it comes, in any order.
    """
    waiting = [key for key in work.keys if key not in work.results]
    suspects: list[Key] = []
    while waiting:
        batch, at_once = (suspects[:1], 1) if suspects else (waiting, workers)
        with pool() as executor:
            lost = _until_broken(work, batch, executor, at_once, keep)
        if suspects and lost:
            key = suspects[0]
            work.results[key] = work.stopped(key)
            keep(key, work.results[key])
            lost.discard(key)
        suspects = suspects[1:] + sorted(lost)
        waiting = [key for key in waiting if key not in work.results]


def _until_broken(
    work: Work[Key, Result],
    waiting: Sequence[Key],
    executor: Executor,
    workers: int,
    keep: Callable[[Key, Result], None],
) -> set[Key]:
    """Go on until all is done, or a process died; then return what was under way."""
    if not work.begin(executor, waiting):
        return set()
    running: dict[Future[Result], Key] = {}
    left = list(waiting)
    while left or running:
        for key in [key for key in left if work.is_ready(key)]:
            if len(running) >= workers:
                break
            try:
                running[work.submit(executor, key)] = key
            except lost_errors():
                return {key, *running.values()}
            left.remove(key)
        finished, _ = wait(running, return_when=FIRST_COMPLETED)
        lost: set[Key] = set()
        for future in finished:
            key = running.pop(future)
            try:
                result = future.result()
            except lost_errors():
                lost.add(key)
            else:
                work.results[key] = result
                keep(key, result)
        if lost:
            return {*lost, *running.values()}
    return set()
