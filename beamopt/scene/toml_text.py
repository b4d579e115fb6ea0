"""A scene as a commented file that names every key, its unit and what it may hold."""

from __future__ import annotations

import json
from textwrap import wrap
from typing import Any

from beamopt.scene.scene import Scene
from beamopt.storage.checked_keys import CheckedKeys, allowed

__all__ = ["scene_text"]


def scene_text(scene: Scene) -> str:
    """The TOML file of a scene; reading it gives the same scene."""
    plain: list[str] = []
    tables: list[str] = []
    for name, field in Scene.model_fields.items():
        value = getattr(scene, name)
        if not isinstance(value, CheckedKeys):
            plain.append(f"{field.alias or name} = {_toml(value)}  # {field.description}")
            continue
        text = " ".join((type(value).__doc__ or "").split())
        tables += ["", *(f"# {line}" for line in wrap(text, 96)), f"[{name}]", *_table(value)]
    return "\n".join(plain + tables) + "\n"


def _table(model: CheckedKeys) -> list[str]:
    lines = []
    for name, field in type(model).model_fields.items():
        value, limits = getattr(model, name), allowed(field)
        said = f"  # {field.description}" + (f" [{limits}]" if limits else "")
        lines.append(f"# {name} ={said}" if value is None else f"{name} = {_toml(value)}{said}")
    return lines


def _toml(value: Any) -> str:
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, CheckedKeys):
        return _toml(value.model_dump(exclude_defaults=True))
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_key(key)} = {_toml(item)}" for key, item in value.items()) + "}"
    if isinstance(value, bool):
        return repr(value).lower()
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_toml(item) for item in value) + "]"
    return repr(value)


def _key(name: str) -> str:
    bare = name.isascii() and name.replace("_", "").replace("-", "").isalnum()
    return name if bare else _text(name)


def _text(value: str) -> str:
    """A basic string of TOML: JSON's escapes, and DEL, which JSON holds as it is."""
    return json.dumps(value, ensure_ascii=False, allow_nan=False).replace("\x7f", "\\u007f")
