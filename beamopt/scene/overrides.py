"""Single keys of a scene, replaced from the command line."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from beamopt.base.errors import InputError
from beamopt.storage.input_file import MOST_KEY_PARTS, parse_toml

__all__ = ["overridden"]


def overridden(data: dict[str, Any], overrides: Sequence[str]) -> dict[str, Any]:
    """A scene's data with `section.key=value` texts put in."""
    for override in overrides:
        key, separator, text = override.partition("=")
        if not separator or not key.strip() or "\n" in override:
            raise InputError("--set", "", override, "written as section.key=value")
        try:
            value = parse_toml(f"value = {text}", "--set")["value"]
        except InputError:
            value = text.strip()
        *sections, last = key.strip().split(".")
        if len(sections) >= MOST_KEY_PARTS:
            raise InputError("--set", "", override, f"a key of at most {MOST_KEY_PARTS} parts")
        table = data
        for name in sections:
            table = table.setdefault(name, {})
            if not isinstance(table, dict):
                raise InputError("--set", key, text, f"{name} is no section")
        table[last] = value
    return data
