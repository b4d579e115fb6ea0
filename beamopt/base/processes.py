"""Processes for work that does not depend on each other's, or none."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection, wait
from typing import Any, TypeVar

from beamopt.base.errors import EndedBySignalError
from beamopt.base.provenance import THREAD_SETTINGS

__all__ = ["InProcess", "in_process", "processes"]

T = TypeVar("T")


@contextmanager
def processes(workers: int) -> Iterator[Executor]:
    """Fresh processes with one thread each.

    On Ctrl-C the tasks under way are finished; a signal that ends the process ends them too.
    """
    before = {name: os.environ.get(name) for name in THREAD_SETTINGS}
    os.environ.update(dict.fromkeys(THREAD_SETTINGS, "1"))
    ended, end = multiprocessing.Pipe(duplex=False)
    _start_tracker()
    pool = _Processes(
        workers,
        mp_context=multiprocessing.get_context("spawn"),
        initializer=_follow_first_process,
        initargs=(ended,),
    )
    try:
        yield pool
    except EndedBySignalError:
        end.close()
        raise
    finally:
        pool.shutdown(cancel_futures=True)
        ended.close()
        end.close()
        for name, value in before.items():
            os.environ.pop(name) if value is None else os.environ.update({name: value})


def _start_tracker() -> None:
    """Start Python's tracker of semaphores, with the signal of a closed terminal blocked.

    That signal goes to every process of the terminal; Python warns where the tracker has ended.
    """
    if not hasattr(signal, "pthread_sigmask"):
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGHUP})
    try:
        resource_tracker.ensure_running()
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


class _Processes(ProcessPoolExecutor):
    """Processes that Ctrl-C, which goes to every process of a terminal, does not interrupt.

    They start with the signal blocked: while they load, they could only die of it with a traceback.
    """

    def submit(self, fn: Callable[..., T], /, *args: Any, **kwargs: Any) -> Future[T]:
        """Have it done; the first tasks start the processes."""
        if not hasattr(signal, "pthread_sigmask"):
            return super().submit(fn, *args, **kwargs)
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            return super().submit(fn, *args, **kwargs)
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)


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


def _follow_first_process(ended: Connection) -> None:
    """Leave Ctrl-C to the first process; end with it, and when it closes its side of `ended`."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    first = multiprocessing.parent_process()
    if first is not None:

        def end() -> None:
            wait([first.sentinel, ended])
            os._exit(1)

        threading.Thread(target=end, daemon=True).start()
