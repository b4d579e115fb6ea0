"""A machine that is busy, and clocks that run away: neither may have a say in a result."""

import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

CLOCKS = ("perf_counter", "monotonic", "time", "process_time", "thread_time")
BURN = "import time; end = time.monotonic() + 120\nwhile time.monotonic() < end: pass"


class Clock:
    """A clock that goes on by hours each time that it is read, from a certain reading on."""

    def __init__(self, from_reading: int = 0) -> None:
        self._left, self._now = from_reading, 0.0

    def __call__(self) -> float:
        self._left -= 1
        self._now += 3600.0 if self._left < 0 else 0.0
        return self._now


def run_away(monkeypatch: pytest.MonkeyPatch) -> None:
    """Have every clock jump by hours, as it would on a machine that is as busy as can be."""
    for name in CLOCKS:
        monkeypatch.setattr(time, name, Clock())


@contextmanager
def busy(count: int = 3) -> Iterator[None]:
    """So many processes beside this one that do nothing but count, for two minutes at most."""
    burning = [subprocess.Popen([sys.executable, "-c", BURN]) for _ in range(count)]
    try:
        yield
    finally:
        for process in burning:
            process.kill()
            process.wait()
