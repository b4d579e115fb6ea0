"""Processes for work that does not depend on each other's, or none."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing.connection import wait
from typing import Any

from beamopt.provenance import THREAD_SETTINGS

__all__ = ["InProcess", "in_process", "processes"]


@contextmanager
def processes(workers: int) -> Iterator[Executor]:
    """Fresh processes with one thread each; on Ctrl-C the searches under way are finished."""
    before = {name: os.environ.get(name) for name in THREAD_SETTINGS}
    os.environ.update(dict.fromkeys(THREAD_SETTINGS, "1"))
    pool = ProcessPoolExecutor(
        workers, mp_context=multiprocessing.get_context("spawn"), initializer=_follow_first_process
    )
    try:
        yield pool
    finally:
        pool.shutdown(cancel_futures=True)
        for name, value in before.items():
            os.environ.pop(name) if value is None else os.environ.update({name: value})


@contextmanager
def in_process(workers: int) -> Iterator[Executor]:
    """No processes: whatever is submitted is done at once, here, one after the other."""
    yield InProcess()


class InProcess(Executor):
    """What is submitted is done at once, in this process."""

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Do it; the future is done."""
        future: Future[Any] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:
            future.set_exception(error)
        return future


def _follow_first_process() -> None:
    """Leave Ctrl-C, which goes to every process of a terminal, to the first one; end with it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    first = multiprocessing.parent_process()
    if first is not None:

        def end() -> None:
            wait([first.sentinel])
            os._exit(1)

        threading.Thread(target=end, daemon=True).start()
