"""Keys of a file that may hold any values which JSON and TOML can both hold."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import Annotated, Any

from pydantic import AfterValidator

from beamopt.base.errors import InputError

__all__ = ["FreeTable"]

DEEPEST = 100  # tables and lists within each other; code that follows them is recursive
LONG = 40  # letters of a key that are shown where it is nested too deep

ALLOWED = "text, true or false, finite numbers below 1e308, lists and tables of them"


def _checked(table: dict[str, Any]) -> dict[str, Any]:
    """The table itself.

    Raises
    ------
    InputError : the first value that a design file can not hold, by its key.
    """
    level: list[tuple[str, Any]] = [("", table)]
    for _ in range(DEEPEST):
        level = [inner for key, container in level for inner in _containers(key, container)]
        if not level:
            return table
    raise InputError(
        "", f"{level[0][0][:LONG]}…", None, f"nested deeper than {DEEPEST} tables and lists"
    )


def _containers(key: str, container: Any) -> Iterator[tuple[str, Any]]:
    """Tables and lists directly in a container, by key; its plain values are checked."""
    for place, value in _items(container):
        if isinstance(container, dict) and not isinstance(place, str):
            raise InputError("", key, place, "must have keys that are text")
        if isinstance(value, dict | list | tuple):
            yield _joined(key, place), value
        elif not (value is None or isinstance(value, str | bool) or _is_number(value)):
            raise InputError("", _joined(key, place), value, f"allowed: {ALLOWED}")


def _items(container: Any) -> Iterable[tuple[Any, Any]]:
    return container.items() if isinstance(container, dict) else enumerate(container)


def _joined(key: str, place: object) -> str:
    if isinstance(place, int):
        return f"{key}[{place}]"
    return f"{key}.{place}" if key else str(place)


def _is_number(value: Any) -> bool:
    try:
        return isinstance(value, int | float) and math.isfinite(value)
    except OverflowError:  # a whole number beyond every float
        return False


FreeTable = Annotated[dict[str, Any], AfterValidator(_checked)]
"""A table of any keys, whose values every design file can hold."""
