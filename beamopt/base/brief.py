"""Short representations of objects, for interactive sessions and logs."""

from __future__ import annotations

import reprlib
from collections.abc import Iterator
from dataclasses import MISSING, fields
from typing import Any

__all__ = ["Brief", "changed_fields"]


class _Short(reprlib.Repr):
    """Cuts after some forty characters, or four items."""

    def __init__(self) -> None:
        super().__init__()
        self.maxlevel = self.maxdict = 2
        self.maxtuple = self.maxlist = self.maxset = 4
        self.maxstring = self.maxother = 40


SHORT = _Short()


class Brief:
    """A value whose representation is cut after some forty characters, or four items."""

    def __init__(self, value: object) -> None:
        self.value = value

    def __repr__(self) -> str:
        return SHORT.repr(self.value)


def changed_fields(self: Any) -> str:
    """Represent a dataclass of settings by the fields that differ from their defaults.

    Its use is `__repr__ = changed_fields` in the class.
    """
    shown = ", ".join(f"{name}={Brief(value)}" for name, value in _changed(self))
    return f"{type(self).__name__}({shown})"


def _changed(settings: Any) -> Iterator[tuple[str, object]]:
    for field in fields(settings):
        value, usual = getattr(settings, field.name), field.default
        if field.default_factory is not MISSING:
            usual = field.default_factory()
        if usual is MISSING or value != usual:
            yield field.name, value
