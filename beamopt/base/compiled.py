"""Compiled kernels: numba, with one set of options and with types that a checker can follow."""

from __future__ import annotations

import hashlib
import logging
import multiprocessing
import os
from collections.abc import Callable
from functools import cache
from pathlib import Path
from tempfile import TemporaryFile
from typing import Any, ParamSpec, TypeVar, cast

import numba

__all__ = ["compiled", "inlined"]

P = ParamSpec("P")
R = TypeVar("R")

LOG = logging.getLogger(__name__)

SETTINGS: Any = numba.config

OPTIONS: dict[str, Any] = {"nogil": True, "fastmath": False, "error_model": "numpy"}


@cache
def _caches() -> Path | None:
    """The folder above the kernels of all rooms; None where no folder can be written."""
    given = SETTINGS.CACHE_DIR
    usual = (Path(__file__).parents[1] / "__pycache__", *_of_user())
    for place in (Path(given),) if given else usual:
        if _can_be_written(place):
            return place
    if multiprocessing.parent_process() is None:  # not by every worker
        LOG.warning(
            "%s can not be written: kernels are compiled at every start; set NUMBA_CACHE_DIR to a "
            "folder that can",
            given or " nor ".join(map(str, usual)),
        )
    return None


def _of_user() -> list[Path]:
    """The user's folder for caches, where the system knows one."""
    try:
        above = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    except RuntimeError:  # no home
        return []
    return [Path(above) / "beamopt"]


def _can_be_written(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with TemporaryFile(dir=folder):
            return True
    except OSError:
        return False


@cache
def _cache_folder(room: Path) -> str | None:
    """A folder for the kernels of a room (a folder of modules) as they stand now.

    Kernels are compiled into those that call them, but numba looks only at the file of the one it
    loads: after a change in another file it would go on with the old code. Kernels therefore call
    kernels of their own room only.
    """
    above = _caches()
    if above is None:
        return None
    state = hashlib.blake2b(digest_size=8)
    for source in sorted(room.glob("*.py")):
        state.update(source.read_bytes())
    return str(above / f"kernels-{state.hexdigest()}")


def compiled(function: Callable[P, R]) -> Callable[P, R]:
    """Compile `function` at its first call and keep the result on disk, where one can be written.

    Kernels release the interpreter lock (threads may evaluate side by side), use IEEE arithmetic
    without re-association or contraction, so that a result does not depend on how a batch is cut,
    and divide as numpy does.
    """
    folder = _cache_folder(Path(function.__code__.co_filename).parent)
    if folder is None:
        return cast("Callable[P, R]", numba.njit(**OPTIONS)(function))
    before, SETTINGS.CACHE_DIR = SETTINGS.CACHE_DIR, folder
    try:
        return cast("Callable[P, R]", numba.njit(cache=True, **OPTIONS)(function))
    finally:
        SETTINGS.CACHE_DIR = before


def inlined(function: Callable[P, R]) -> Callable[P, R]:
    """A kernel that stands as text in each that calls it, and is not kept by itself.

    For pieces of a kernel that get many arrays in tuples: handing those over takes longer than
    what the piece does. It may not return early.
    """
    return cast("Callable[P, R]", numba.njit(inline="always", **OPTIONS)(function))
