"""Single keys of a scene, replaced from the command line."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from typing import Any

from beamopt.errors import InputError

__all__ = ["overridden"]


def overridden(data: dict[str, Any], overrides: Sequence[str]) -> dict[str, Any]:
    """A scene's data with `section.key=value` texts put in."""
    for override in overrides:
        key, separator, text = override.partition("=")
        if not separator or not key.strip() or "\n" in override:
            raise InputError("--set", "", override, "written as section.key=value")
        try:
            value = tomllib.loads(f"value = {text}")["value"]
        except (ValueError, RecursionError):
            value = text.strip()
        *sections, last = key.strip().split(".")
        table = data
        for name in sections:
            table = table.setdefault(name, {})
            if not isinstance(table, dict):
                raise InputError("--set", key, text, f"{name} is no section")
        table[last] = value
    return data
