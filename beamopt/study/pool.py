"""Processes for searches that do not depend on each other."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing.connection import wait

from beamopt.provenance import THREAD_SETTINGS

__all__ = ["processes"]


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


def _follow_first_process() -> None:
    """Leave Ctrl-C, which goes to every process of a terminal, to the first one; end with it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    first = multiprocessing.parent_process()
    if first is not None:

        def end() -> None:
            wait([first.sentinel])
            os._exit(1)

        threading.Thread(target=end, daemon=True).start()
