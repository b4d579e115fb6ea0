"""Compiled kernels: numba, with one set of options and with types that a checker can follow."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, ParamSpec, TypeVar, cast

import numba

__all__ = ["compiled"]

P = ParamSpec("P")
R = TypeVar("R")

SETTINGS: Any = numba.config
KERNELS = Path(__file__).parent / "section"


def _cache_folder() -> str:
    """A folder for the kernels as they stand now.

    Kernels are compiled into those that call them, but numba looks only at the file of the one it
    loads: after a change in another file it would go on with the old code.
    """
    state = hashlib.blake2b(digest_size=8)
    for source in sorted(KERNELS.glob("*.py")):
        state.update(source.read_bytes())
    above = SETTINGS.CACHE_DIR or str(Path(__file__).parent / "__pycache__")
    return str(Path(above) / f"kernels-{state.hexdigest()}")


CACHE_FOLDER = _cache_folder()


def compiled(function: Callable[P, R]) -> Callable[P, R]:
    """Compile `function` at its first call and keep the result on disk.

    Kernels release the interpreter lock (threads may evaluate side by side), use IEEE arithmetic
    without re-association or contraction, so that a result does not depend on how a batch is cut,
    and divide as numpy does.
    """
    before, SETTINGS.CACHE_DIR = SETTINGS.CACHE_DIR, CACHE_FOLDER
    try:
        options = numba.njit(cache=True, nogil=True, fastmath=False, error_model="numpy")
        return cast("Callable[P, R]", options(function))
    finally:
        SETTINGS.CACHE_DIR = before
