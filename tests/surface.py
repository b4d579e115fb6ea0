"""`python -m tests.surface [--write]`: what users can name, as a sorted text.

One line for each command, argument and option with its default and choices, key of a scene and of
a design with its default and range, bundled scene, and public name with its parameters or members.
For the list of another tree: `PYTHONPATH=TREE python -P tests/surface.py`.
"""

from __future__ import annotations

import inspect
import sys
import typing
from collections.abc import Iterator
from enum import Enum
from importlib import import_module
from pathlib import Path
from typing import Any

SNAPSHOT = Path(__file__).parent / "data" / "surface.txt"
PACKAGES = ("beamopt", "femcheck")


def lines() -> list[str]:
    """All lines, sorted."""
    found = [*_keys("scene", "Scene"), *_keys("design", "Design"), *_scenes()]
    for package in PACKAGES:
        found += [*_commands(package), *_names(package)]
    return sorted(set(found))


def text() -> str:
    return "\n".join(lines()) + "\n"


def _commands(program: str) -> Iterator[str]:
    from typer.main import get_command

    app = import_module(f"{program}.cli.application").app
    group: Any = get_command(app)
    for name, command in (("", group), *group.commands.items()):
        called = f"{program} {name}".strip()
        yield f"command {called}"
        for given in command.params:
            if given.param_type_name == "argument":
                label = f"argument {given.metavar or given.name}"
            else:
                label = "option " + " ".join([*given.opts, *given.secondary_opts])
            yield f"{label} of {called}{_kind(given)}{_default(given)}"


def _kind(given: Any) -> str:
    bare = given.type_descriptor.annotation
    bare = (typing.get_args(bare) or (bare,))[0]
    values = (
        [str(one.value) for one in bare] if inspect.isclass(bare) and issubclass(bare, Enum) else []
    )
    repeated = ", repeated" if given.multiple or given.nargs == -1 else ""
    bounds = [
        f"{low_or_high:g}" for low_or_high in (given.min, given.max) if low_or_high is not None
    ]
    within = f", {' … '.join(bounds)}" if bounds else ""
    return repeated + within + (f", one of {' '.join(values)}" if values else "")


def _default(given: Any) -> str:
    if given.required:
        return ", required"
    plain = getattr(given.default, "value", given.default)
    return "" if plain is None else f" = {plain}"


def _keys(file: str, name: str) -> Iterator[str]:
    beamopt = import_module("beamopt")
    return _keys_of(getattr(beamopt, name), f"key of a {file}: ", "")


def _keys_of(table: Any, label: str, above: str) -> Iterator[str]:
    for name, field in table.model_fields.items():
        path = above + (field.alias or name)
        inner = list(_tables(field.annotation))
        if inner:
            yield f"{label}{path}"
            for one in inner:
                yield from _keys_of(one, label, f"{path}.")
            continue
        default = "required" if field.is_required() else f"= {_value(field)}"
        yield f"{label}{path} {default}{_range(field)}"


def _tables(annotation: Any) -> Iterator[Any]:
    """Tables of keys in an annotation."""
    if hasattr(annotation, "model_fields"):
        yield annotation
    for part in typing.get_args(annotation):
        yield from _tables(part)


def _value(field: Any) -> str:
    return "computed" if field.default_factory else repr(field.default)


def _range(field: Any) -> str:
    pairs = [(one, name) for one in field.metadata for name in ("ge", "le")]
    bounds = [
        f"{getattr(one, name):g}" for one, name in pairs if getattr(one, name, None) is not None
    ]
    choices = [repr(one) for one in typing.get_args(field.annotation) if isinstance(one, str)]
    within = f", {' … '.join(bounds)}" if bounds else ""
    return within + (f", one of {' '.join(choices)}" if choices else "")


def _scenes() -> Iterator[str]:
    folder = Path(str(import_module("beamopt").__file__)).parent / "scenes"
    return (f"bundled scene {path.stem}" for path in folder.glob("*.toml"))


def _names(package: str) -> Iterator[str]:
    face = import_module(package)
    for name in face.__all__:
        public = getattr(face, name)
        yield f"name {package}.{name}"
        members = _members(public) if inspect.isclass(public) else _parameters(public)
        yield from (f"name {package}.{name}{member}" for member in members)


def _parameters(function: Any) -> Iterator[str]:
    for one in inspect.signature(function).parameters.values():
        if not one.name.startswith("_"):
            default = "" if one.default is one.empty else f" = {_short(one.default)}"
            yield f"({one.name}){default}"


def _short(default: object) -> str:
    plain = isinstance(default, str | int | float | bool | None)
    return repr(default) if plain else type(default).__name__


def _members(public: type) -> Iterator[str]:
    """Public attributes, methods and fields that a class of this project has."""
    for base in public.__mro__:
        if base.__module__.startswith(PACKAGES):
            names = {*vars(base), *vars(base).get("__annotations__", ())}
            yield from (f".{name}" for name in names if not name.startswith(("_", "model_")))


if __name__ == "__main__":
    if sys.argv[1:] == ["--write"]:
        SNAPSHOT.write_text(text(), encoding="utf-8")
    else:
        sys.stdout.write(text())
