"""One process at a time: a lock on a journal, held while a search writes to it."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from beamopt.errors import InputError

__all__ = ["locked"]

PATIENCE = 2.0  # s; a process that was just killed may still be letting go

_HELD: list[BinaryIO] = []


def _let_go() -> None:
    """In a forked child: a worker that outlives its parent must not keep the parent's locks."""
    while _HELD:
        _HELD.pop().close()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_let_go)


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Keep every other process from `locked` of the same file, where the system can.

    The file is made if it is not there, and else left as it is.

    Raises
    ------
    InputError : another process holds it.
    """
    with path.open("ab") as stream:
        _lock(stream, path)
        _HELD.append(stream)
        try:
            yield
        finally:
            if stream in _HELD:  # not in a forked child
                _HELD.remove(stream)


def _lock(stream: BinaryIO, path: Path) -> None:
    try:
        import fcntl
    except ImportError:
        return
    patience = time.monotonic() + PATIENCE
    while True:
        try:
            fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            if time.monotonic() > patience:
                said = "another process is writing to this folder"
                raise InputError(path, "", None, said) from None
            time.sleep(0.05)
        else:
            return
