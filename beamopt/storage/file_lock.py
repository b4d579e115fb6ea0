"""One process at a time: a lock on a file, which ends with the process that holds it."""

from __future__ import annotations

import errno
import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

__all__ = ["HeldElsewhereError", "is_free", "locked"]

PATIENCE = 2.0  # s

_HELD: list[BinaryIO] = []


class HeldElsewhereError(Exception):
    """Another process holds the lock."""


def _let_go() -> None:
    """In a forked child: a worker that outlives its parent must not keep the parent's locks."""
    while _HELD:
        _HELD.pop().close()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_let_go)


@contextmanager
def locked(path: Path, patience: float | None = None) -> Iterator[BinaryIO]:
    """Keep every other process from `locked` of the same file, where the system can.

    The file is made if it is not there, and else left as it is. Who holds the lock may write to
    the stream, and may delete the file.

    patience : time to wait for it [s]; a process that was just killed may still be letting go.

    Raises
    ------
    HeldElsewhereError : another process holds it.
    OSError : the file is a link, or can not be made.
    """
    until = time.monotonic() + (PATIENCE if patience is None else patience)
    while True:
        stream = os.fdopen(os.open(path, _FLAGS, 0o666), "r+b", buffering=0)
        _HELD.append(stream)
        try:
            if not _lock(stream, until):
                raise HeldElsewhereError
            if _is_at(stream, path):
                yield stream
                return
        finally:
            if stream in _HELD:  # not in a forked child
                _HELD.remove(stream)
                stream.close()


_FLAGS = os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0)


def is_free(descriptor: int) -> bool:
    """Lock an open file or folder if no other process has; false where one has.

    True too where the system has no locks.
    """
    try:
        import fcntl
    except ImportError:
        return True
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        return error.errno not in (errno.EWOULDBLOCK, errno.EACCES)
    return True


def _lock(stream: BinaryIO, until: float) -> bool:
    while not is_free(stream.fileno()):
        if time.monotonic() > until:
            return False
        time.sleep(0.05)
    return True


def _is_at(stream: BinaryIO, path: Path) -> bool:
    """False where the process that held the lock before deleted the file."""
    try:
        return os.path.samestat(os.fstat(stream.fileno()), path.stat(follow_symlinks=False))
    except FileNotFoundError:
        return False
