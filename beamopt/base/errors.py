"""Misuse, said in one line: which file, which key, what it holds and what is allowed."""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum

__all__ = ["EndedBySignalError", "InputError", "NoEquilibriumError", "NotComputedError"]


class InputError(ValueError):
    """Input that cannot be used.

    Parameters
    ----------
    where : the file (or command-line option) that holds the input, "" when there is none.
    key : the key, row or field, as a person finds it in that file ("grid.radial").
    value : what stands there; None when it is too long to show, or nothing.
    allowed : what may stand there, and the way out where there is one.

    Examples
    --------
    >>> import beamopt
    >>> try:
    ...     beamopt.load_scene("random-section", ["grid.radial=3"])
    ... except beamopt.InputError as error:
    ...     print(error.key, error.value, "|", error.allowed)
    grid.radial 3 | allowed: 4 … 4096
    """

    def __init__(self, where: object, key: str, value: object, allowed: str) -> None:
        self.where, self.key, self.value, self.allowed = str(where), key, value, allowed
        super().__init__(where, key, value, allowed)

    def __str__(self) -> str:
        try:
            shown = repr(self.value) if isinstance(self.value, str) else str(self.value)
        except (RecursionError, ValueError):  # brackets too deep, numbers too long
            shown = "(too long to show)"
        if len(shown) > 60:
            shown = shown[:57] + "..."
        said = self.key
        if self.value is not None:
            said = f"{self.key} = {shown}" if self.key else shown
        parts = [part for part in (self.where, said, self.allowed) if part]
        text = " ".join(": ".join(parts).split())
        return text.encode("utf-8", "backslashreplace").decode()  # names of files hold any bytes


class NoEquilibriumError(ValueError):
    """A tip was asked for where the loaded rod has no stable equilibrium.

    pressures : (3,) [kPa]. status : a `RodStatus`, whose value is the text for people.

    Examples
    --------
    >>> import beamopt
    >>> design = beamopt.load_design(str(beamopt.load_scene("sealed-section").target.file))
    >>> try:
    ...     tips = design.workspace.tips
    ... except beamopt.NoEquilibriumError as error:
    ...     print(error.pressures, error.status)
    >>> tips.shape
    (27, 3)
    """

    def __init__(self, pressures: Sequence[float], status: Enum) -> None:
        self.pressures, self.status = tuple(float(one) for one in pressures), status
        super().__init__(self.pressures, status)

    def __str__(self) -> str:
        at = ", ".join(f"{one:g}" for one in self.pressures)
        return f"no tip at {at} kPa: {self.status.value}"


class NotComputedError(RuntimeError):
    """Failure to compute: a process or the machine gave out, not the input.

    what : the task. why : in the words of people, with the way out where there is one.
    """

    def __init__(self, what: str, why: str) -> None:
        self.what, self.why = what, why
        super().__init__(what, why)

    def __str__(self) -> str:
        return f"{self.what}: {self.why}"


class EndedBySignalError(KeyboardInterrupt):
    """A signal asked the process to end, as Ctrl-C does, and soon; `number` is the signal's."""

    def __init__(self, number: int) -> None:
        self.number = number
        super().__init__(number)
