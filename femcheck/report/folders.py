"""Which folders a report is made of, told by the files that they hold."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from enum import Enum
from pathlib import Path
from typing import NamedTuple

from beamopt.base.errors import InputError

__all__ = ["ContentKind", "Folder", "find_folders"]


class ContentKind(Enum):
    """What a folder holds; the value is the text shown to people."""

    SOLID = "check or prediction"
    ACCURACY = "answer to an accuracy"
    SEARCH = "search"
    FIGURES = "figures"


class Folder(NamedTuple):
    """A folder of results."""

    kind: ContentKind
    path: Path


ALLOWED = (
    "a folder of femcheck run (check.json; tried.csv), of beamopt optimize (scene.toml), of a "
    "chart or map (provenance.json and .svg), or one that holds such folders"
)


def find_folders(paths: Sequence[Path]) -> list[Folder]:
    """The folders named, and those in folders that hold several; each once, in order.

    Raises
    ------
    InputError : a path that is none of them.
    """
    found: dict[Path, Folder] = {}
    for path in paths:
        inside = list(_folders(path))
        if not inside:
            raise InputError(path, "", None, f"no folder for a report; allowed: {ALLOWED}")
        for folder in inside:
            found.setdefault(folder.path.resolve(), folder)
    return list(found.values())


def _folders(path: Path) -> Iterator[Folder]:
    kind = _kind(path)
    if kind is not None:
        yield Folder(kind, path)
    elif path.is_dir():
        for inner in sorted(path.iterdir()):
            kind = _kind(inner)
            if kind is not None:
                yield Folder(kind, inner)


def _kind(path: Path) -> ContentKind | None:
    if not path.is_dir():
        return None
    if (path / "check.json").exists():
        return ContentKind.SOLID
    if (path / "tried.csv").exists() and (path / "summary.json").exists():
        return ContentKind.ACCURACY
    if (path / "scene.toml").exists() and (path / "summary.json").exists():
        return ContentKind.SEARCH
    if (path / "provenance.json").exists() and any(path.glob("*.svg")):
        return ContentKind.FIGURES
    return None
