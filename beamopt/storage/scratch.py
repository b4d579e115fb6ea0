"""Temporary folders that do not outlive their process for long, however it ends."""

from __future__ import annotations

import os
import re
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from beamopt.storage.file_lock import is_free

__all__ = ["clear_scratch", "scratch_folder"]

PREFIX = "beamopt-"
NAME = re.compile(rf"{PREFIX}(\d+)-.+")


@contextmanager
def scratch_folder() -> Iterator[Path]:
    """A temporary folder, which other processes leave alone as long as this one lives."""
    with tempfile.TemporaryDirectory(
        prefix=f"{PREFIX}{os.getpid()}-", ignore_cleanup_errors=True
    ) as name:
        descriptor = _opened(name)
        if descriptor is not None:
            is_free(descriptor)
        try:
            yield Path(name)
        finally:
            if descriptor is not None:
                os.close(descriptor)


def clear_scratch() -> None:
    """Delete the temporary folders of processes that were killed.

    Those of this person only, whose process is gone and whose lock is free: the second tells a
    process of another container, whose number says nothing here.
    """
    if not hasattr(os, "getuid"):  # a system where a number is no way to ask for a process
        return
    try:
        found = [item for item in os.scandir(tempfile.gettempdir()) if NAME.fullmatch(item.name)]
    except OSError:
        return
    for item in found:
        if _is_ours(item) and not _lives(int(item.name.split("-")[1])):
            descriptor = _opened(item.path)
            if descriptor is None:
                continue
            if is_free(descriptor):
                shutil.rmtree(item.path, ignore_errors=True)
            os.close(descriptor)


def _is_ours(item: os.DirEntry[str]) -> bool:
    try:
        owner = item.stat(follow_symlinks=False).st_uid
    except OSError:
        return False
    return item.is_dir(follow_symlinks=False) and owner == os.getuid()


def _lives(process: int) -> bool:
    """Whether there is a process of that number."""
    try:
        os.kill(process, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except OSError:
        pass
    return True


def _opened(folder: str) -> int | None:
    try:
        return os.open(folder, os.O_RDONLY)
    except OSError:  # a system that opens no folders
        return None
