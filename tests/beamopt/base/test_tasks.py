"""Tasks whose process dies: tried again alone; named if their process dies again."""

import os
import signal
import sys
from collections.abc import Iterator
from concurrent.futures import Executor, Future
from contextlib import contextmanager, nullcontext
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from beamopt.base.errors import NotComputedError
from beamopt.base.processes import InProcess, processes
from beamopt.base.tasks import Tasks, check_none_lost, solve_all


def die_once(marks: Path, number: int) -> int:
    """Square a number; the first time that it is 3, the process is killed."""
    if number == 3 and not (marks / "died").exists():
        (marks / "died").touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return number**2


def die(number: int) -> int:
    if number == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return number**2


def test_a_killed_task_is_done_again(tmp_path: Path) -> None:
    work = Tasks(die_once, {number: (tmp_path, number) for number in range(6)})
    solve_all(work, partial(processes, 2), 2, lambda key, result: None)
    assert (tmp_path / "died").exists()
    assert work.results == {number: number**2 for number in range(6)}
    check_none_lost(work, "")


def test_a_task_that_kills_twice_is_the_only_one_without_a_result() -> None:
    work = Tasks(die, {number: (number,) for number in range(6)})
    solve_all(work, partial(processes, 2), 2, lambda key, result: None)
    assert work.lost == [3]
    assert {key for key, one in work.results.items() if one is None} == {3}
    with pytest.raises(NotComputedError) as raised:
        check_none_lost(work, "a way out")
    assert raised.value.what == "3"


class Cluster(InProcess):
    """An executor that reports a lost worker by an error of its own, and goes on."""

    def __init__(self, error: type[Exception]) -> None:
        self.error, self.losses = error, 0

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        if args == (3,) and self.losses < 1:
            self.losses += 1
            future: Future[Any] = Future()
            future.set_exception(self.error("attempted on 4 workers"))
            return future
        return super().submit(fn, *args, **kwargs)


@pytest.mark.parametrize(
    ("module", "name"), [("distributed", "KilledWorker"), ("ipyparallel.error", "EngineError")]
)
def test_a_cluster_that_loses_a_worker(
    module: str, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    library, error = ModuleType(module), type(name, (Exception,), {})
    setattr(library, name, error)
    monkeypatch.setitem(sys.modules, module, library)
    cluster = Cluster(error)
    work = Tasks(abs, {number: (number,) for number in range(-2, 6)})
    solve_all(work, lambda: nullcontext(cluster), 4, lambda key, result: None)
    assert cluster.losses == 1
    assert work.results == {number: abs(number) for number in range(-2, 6)}


def test_an_error_of_a_task_is_no_lost_worker() -> None:
    @contextmanager
    def pool() -> Iterator[Executor]:
        yield Cluster(ValueError)

    work = Tasks(abs, {3: (3,)})
    with pytest.raises(ValueError, match="attempted"):
        solve_all(work, pool, 1, lambda key, result: None)
