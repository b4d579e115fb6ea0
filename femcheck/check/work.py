"""Work that depends on other work, on any executor, and on processes that may die under it.

Workers are processes, or one thread: a worker keeps factors between tasks.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import AbstractContextManager
from typing import Any, Protocol, TypeVar

__all__ = ["Work", "solve_all"]

Key = TypeVar("Key", bound=tuple[Any, ...])
Result = TypeVar("Result")


class Work(Protocol[Key, Result]):
    """Tasks by key, and the results so far."""

    results: dict[Key, Result]

    @property
    def keys(self) -> Sequence[Key]:
        """All tasks, in the order in which they are begun."""
        ...

    def begin(self, executor: Executor, waiting: Sequence[Key]) -> bool:
        """Do what comes before the tasks; False where a process died of it."""
        ...

    def is_ready(self, key: Key) -> bool:
        """Whether everything that a task builds on is known."""
        ...

    def submit(self, executor: Executor, key: Key) -> Future[Result]:
        """Have a task done."""
        ...

    def stopped(self, key: Key) -> Result:
        """The result of a task whose process died."""
        ...


def solve_all(
    work: Work[Key, Result],
    pool: Callable[[], AbstractContextManager[Executor]],
    workers: int,
    keep: Callable[[Key, Result], None],
) -> None:
    """Do what is not in `work.results` yet, `workers` tasks at once.

    A process that dies under a task gives it the result `stopped`; the others go on in a new pool.
    Where several were under way each is tried again alone, so that only the one to blame is given
    up, whatever the number of workers.

    pool : makes the executor. keep : is called with every result as it comes, in any order.
    """
    waiting = [key for key in work.keys if key not in work.results]
    suspects: list[Key] = []
    while waiting:
        batch, at_once = (suspects[:1], 1) if suspects else (waiting, workers)
        with pool() as executor:
            lost = _until_broken(work, batch, executor, at_once, keep)
        suspects = suspects[1:]
        if len(lost) == 1:
            (key,) = lost
            work.results[key] = work.stopped(key)
            keep(key, work.results[key])
        else:
            suspects += sorted(lost)
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
            except BrokenProcessPool:
                return {key, *running.values()}
            left.remove(key)
        finished, _ = wait(running, return_when=FIRST_COMPLETED)
        for future in finished:
            key = running.pop(future)
            try:
                result = future.result()
            except BrokenProcessPool:
                return {key, *running.values()}
            work.results[key] = result
            keep(key, result)
    return set()
