"""Ways to damage a file, whatever is in it."""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Callable
from functools import partial
from pathlib import Path

__all__ = ["CONTENTS", "NUMBERS", "PLACES", "Damage"]

Damage = Callable[[Path], None]

NUMBER = re.compile(rb"(?<![\w.\"#-])-?[0-9]+(?:\.[0-9]+)?(?:[eE][-+]?[0-9]+)?(?![\w.\"])")
COMMENT = re.compile(rb"^# [^\n]*|(?<= )# [^\n]*", re.MULTILINE)
STRING = re.compile(rb'"(?:[^"\\]|\\.)*"')


def _content(change: Callable[[bytes], bytes]) -> Damage:
    def damage(file: Path) -> None:
        file.write_bytes(change(file.read_bytes()))

    return damage


def _number(place: int, value: bytes) -> Damage:
    """Put something else in the place of a number: the first or the last of the file.

    Those in the comments of a TOML file, and in the strings of a JSON file, are none.
    """

    def change(content: bytes) -> bytes:
        aside = STRING if content.startswith(b"{") else COMMENT
        read = aside.sub(lambda found: b" " * len(found[0]), content)
        found = list(NUMBER.finditer(read))[place]
        return content[: found.start()] + value + content[found.end() :]

    return _content(change)


def _instead(make: Callable[[Path], None]) -> Damage:
    def damage(file: Path) -> None:
        file.unlink()
        make(file)

    return damage


def _huge(file: Path) -> None:
    """Put a terabyte of zeros in its place, which takes no room on the disk."""
    file.touch()
    os.truncate(file, 2**40)


def _link(to: str, file: Path) -> None:
    file.symlink_to(to)


CONTENTS: dict[str, Damage] = {
    "empty": _content(lambda content: b""),
    "half": _content(lambda content: content[: len(content) // 2]),
    "zeros": _content(lambda content: bytes(5000)),
    "bytes": _content(lambda content: bytes(range(256)) * 20),
    "utf-16": _content(lambda content: content.decode().encode("utf-16")),
    "latin": _content(lambda content: content[:30] + b"\xe9" + content[30:]),
    "deep": _content(lambda content: b"[" * 100_000),
    "deep tables": _content(lambda content: b'{"a":' * 50_000),
    "other": _content(lambda content: b"[1, 2]\n"),
    "text": _content(lambda content: b"hello\n" * 3),
}
NUMBERS: dict[str, Damage] = {
    f"{('first', 'last')[place]} {name}": _number(place, value)
    for place, name, value in (
        (0, "nan", b"NaN"),
        (0, "toml nan", b"nan"),
        (0, "-1e999", b"-1e999"),
        (0, "digits", b"9" * 400),
        (0, "list", b"[]"),
        (-1, "1e999", b"1e999"),
        (-1, "many digits", b"9" * 5000),
        (-1, "digits", b"9" * 400),
        (-1, "minus", b"-1"),
        (-1, "text", b'"x"'),
    )
}
PLACES: dict[str, Damage] = {
    "missing": lambda file: file.unlink(),
    "folder": _instead(lambda file: file.mkdir()),
    "pipe": _instead(lambda file: os.mkfifo(file)),
    "dangling link": _instead(partial(_link, "nowhere")),
    "loop of links": _instead(lambda file: file.symlink_to(file.name)),
    "device without an end": _instead(partial(_link, "/dev/zero")),
    "empty device": _instead(partial(_link, "/dev/null")),
    "huge": _instead(_huge),
}


def copied(assets: Path, *names: str) -> Callable[[Path], None]:
    """Make copies of assets in a case's folder."""

    def make(folder: Path) -> None:
        for name in names:
            source = assets / name
            if source.is_dir():
                shutil.copytree(source, folder / name)
            else:
                shutil.copy(source, folder / name)

    return make
