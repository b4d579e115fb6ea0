"""Compiled kernels: numba, with one set of options and with types that a checker can follow."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, ParamSpec, TypeVar, cast

import numba

__all__ = ["compiled", "inlined"]

P = ParamSpec("P")
R = TypeVar("R")

SETTINGS: Any = numba.config

OPTIONS: dict[str, Any] = {"nogil": True, "fastmath": False, "error_model": "numpy"}


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
        return cast("Callable[P, R]", numba.njit(cache=True, **OPTIONS)(function))
    finally:
        SETTINGS.CACHE_DIR = before


def inlined(function: Callable[P, R]) -> Callable[P, R]:
    """A kernel that stands as text in each that calls it, and is not kept by itself.

    For pieces of a kernel that get many arrays in tuples: handing those over takes longer than
    what the piece does. It may not return early.
    """
    return cast("Callable[P, R]", numba.njit(inline="always", **OPTIONS)(function))
