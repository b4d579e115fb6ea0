"""Exit codes of the commands of both programs."""

from __future__ import annotations

from collections.abc import Iterable
from enum import IntEnum

import typer

__all__ = ["ExitCode", "end_with", "joined"]


class ExitCode(IntEnum):
    """Meaning of a command's end to its caller."""

    HOLDS = 0
    DOES_NOT_HOLD = 1
    MISUSE = 2
    NOT_COMPUTED = 3


def joined(codes: Iterable[ExitCode]) -> ExitCode:
    """The code of several verdicts: one that does not hold settles it, whatever the others are."""
    found = set(codes)
    if ExitCode.DOES_NOT_HOLD in found:
        return ExitCode.DOES_NOT_HOLD
    return max(found, default=ExitCode.HOLDS)


def end_with(code: ExitCode) -> None:
    """End the command, unless all holds.

    Raises
    ------
    typer.Exit : with the code.
    """
    if code is not ExitCode.HOLDS:
        raise typer.Exit(code)
