"""Workers of executors that die under a task."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable
from concurrent.futures import BrokenExecutor, Executor, Future
from typing import TypeVar

from beamopt.base.errors import NotComputedError

__all__ = ["lost_errors", "results_on"]

Argument = TypeVar("Argument")
Result = TypeVar("Result")

OF_CLUSTERS = (("distributed", "KilledWorker"), ("ipyparallel.error", "EngineError"))
"""Module and name of the errors by which executors of clusters say that a worker died."""


def lost_errors() -> tuple[type[BaseException], ...]:
    """Errors that say a worker died under a task; of a cluster's library only if it is loaded."""
    known = [getattr(sys.modules.get(module), name, None) for module, name in OF_CLUSTERS]
    return (BrokenExecutor, *(kind for kind in known if isinstance(kind, type)))


def results_on(
    executor: Executor, function: Callable[[Argument], Result], arguments: Iterable[Argument]
) -> list[Result]:
    """Results of a function at several arguments, in their order.

    An argument whose worker dies is given to another worker once, as far as the executor has one:
    one of Python's processes has none then.

    Raises
    ------
    NotComputedError : a worker died, and there was no other one, or that died too.
    """
    asked = list(arguments)
    tasks: list[Future[Result]] = []
    try:
        tasks += [executor.submit(function, one) for one in asked]
        return [_result(executor, function, *one) for one in zip(asked, tasks, strict=True)]
    except lost_errors() as error:
        said = (
            "a worker of the executor ended before its work was done (out of memory?); "
            "use a new executor: resume=True goes on with the run in a folder"
        )
        raise NotComputedError("executor", said) from error
    finally:
        for task in tasks:
            task.cancel()


def _result(
    executor: Executor,
    function: Callable[[Argument], Result],
    argument: Argument,
    task: Future[Result],
) -> Result:
    try:
        return task.result()
    except lost_errors():
        return executor.submit(function, argument).result()
