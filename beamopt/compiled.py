"""Compiled kernels: numba, with one set of options and with types that a checker can follow."""

from __future__ import annotations

from collections.abc import Callable
from typing import ParamSpec, TypeVar, cast

import numba

__all__ = ["compiled"]

P = ParamSpec("P")
R = TypeVar("R")


def compiled(function: Callable[P, R]) -> Callable[P, R]:
    """Compile `function` at its first call and keep the result on disk.

    Kernels release the interpreter lock (threads may evaluate side by side), use IEEE arithmetic
    without re-association or contraction (the same bits on every machine and thread) and divide as
    numpy does.
    """
    jitted = numba.njit(cache=True, nogil=True, fastmath=False, error_model="numpy")(function)
    return cast("Callable[P, R]", jitted)
