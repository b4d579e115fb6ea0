"""Executors of a user, whose workers die under a search."""

import os
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import pytest

from beamopt.base.errors import NotComputedError
from beamopt.base.lost_workers import results_on
from beamopt.pareto.find_front import find_front
from beamopt.scene.scene import load_scene
from beamopt.search.optimize import optimize

TINY = ("search.generations=2", "search.population=8", "section.feature_points=6")


class Dying(Executor):
    """Does what is submitted at once; tasks of some numbers end as those of a dead worker do."""

    def __init__(self, *dying: int) -> None:
        self.dying, self.asked = dying, 0

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        future: Future[Any] = Future()
        if self.asked in self.dying:
            future.set_exception(BrokenProcessPool("dead"))
        else:
            future.set_result(fn(*args, **kwargs))
        self.asked += 1
        return future


def test_a_task_is_given_to_another_worker_once() -> None:
    assert results_on(Dying(1), str, [1, 2, 3]) == ["1", "2", "3"]
    with pytest.raises(NotComputedError):
        results_on(Dying(1, 3), str, [1, 2, 3])


def test_an_error_of_the_function_is_no_dead_worker() -> None:
    with pytest.raises(ZeroDivisionError), ProcessPoolExecutor(1, get_context("spawn")) as pool:
        results_on(pool, (1).__truediv__, [1, 0])


@pytest.mark.parametrize("search", ["optimize", "find_front"])
def test_a_search_goes_on_from_its_folder(search: str, tmp_path: Path) -> None:
    """A pool of processes that is broken says so, and the same bytes follow from a new one."""
    scene = load_scene("random-section", TINY)

    def searched(out: Path, **options: Any) -> bytes:
        if search == "optimize":
            optimize(scene, out, figures=False, **options)
        else:
            find_front(scene, ["L", "ratio"], out, population=8, figures=False, **options)
        return (out / "journal.jsonl").read_bytes()

    whole = searched(tmp_path / "whole")
    with ProcessPoolExecutor(2, get_context("spawn")) as pool:
        pool.submit(os._exit, 1).exception()
        with pytest.raises(NotComputedError, match="resume"):
            searched(tmp_path / "cut", executor=pool, workers=2)
    assert searched(tmp_path / "cut", executor=Dying(1), workers=2, resume=True) == whole
