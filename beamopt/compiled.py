"""Compiled kernels: numba, with one set of options and with types that a checker can follow."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, ParamSpec, TypeVar, cast

import numba

__all__ = ["compiled"]

P = ParamSpec("P")
R = TypeVar("R")

SETTINGS: Any = numba.config


@cache
def _cache_folder(room: Path) -> str:
    """A folder for the kernels of a room (a folder of modules) as they stand now.

    Kernels are compiled into those that call them, but numba looks only at the file of the one it
    loads: after a change in another file it would go on with the old code. Kernels therefore call
    kernels of their own room only.
    """
    state = hashlib.blake2b(digest_size=8)
    for source in sorted(room.glob("*.py")):
        state.update(source.read_bytes())
    name = f"kernels-{state.hexdigest()}"
    above = SETTINGS.CACHE_DIR or str(Path(__file__).parent / "__pycache__")
    return str(Path(above) / name)


def compiled(function: Callable[P, R]) -> Callable[P, R]:
    """Compile `function` at its first call and keep the result on disk.

    Kernels release the interpreter lock (threads may evaluate side by side), use IEEE arithmetic
    without re-association or contraction, so that a result does not depend on how a batch is cut,
    and divide as numpy does.
    """
    folder = _cache_folder(Path(function.__code__.co_filename).parent)
    before, SETTINGS.CACHE_DIR = SETTINGS.CACHE_DIR, folder
    try:
        options = numba.njit(cache=True, nogil=True, fastmath=False, error_model="numpy")
        return cast("Callable[P, R]", options(function))
    finally:
        SETTINGS.CACHE_DIR = before
