"""Reading the files of a user: regular files of a bounded size, text in UTF-8, JSON, TOML."""

from __future__ import annotations

import json
import os
import re
import stat
import tomllib
from collections import Counter
from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import Any

from beamopt.base.errors import InputError

__all__ = [
    "MOST_BYTES",
    "MOST_KEY_PARTS",
    "MOST_MESH",
    "check_regular",
    "parse_toml",
    "read_bytes",
    "read_json",
    "read_text",
]

MOST_BYTES = 16 * 2**20
"""Largest size of a file that is read as a whole: designs, tables, figures; journals have none."""

MOST_MESH = 256 * 2**20
"""Largest size of a mesh, or of the arrays of a solid."""

MOST_TOML = 8 * 2**20  # bytes of a scene, with the sections of its segments
MOST_DEPTH = 100  # tables and lists within each other; a design has six
MOST_KEY_PARTS = 16  # a.b.c has three; the time and memory of a parser grow with their square

READING = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
"""Opening returns at once, also where the file was replaced by a pipe since it was checked."""

KINDS = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISFIFO, "a named pipe"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
    (stat.S_ISSOCK, "a socket"),
)
TOML_TOKEN = re.compile(
    r'"""(?:[^"\\]|\\.|"(?!""))*+(?:"{3,5})?'
    r"|'''(?:[^']|'(?!''))*+(?:'{3,5})?"
    r'|"(?:[^"\\\n]|\\.)*+"?'
    r"|'[^'\n]*+'?"
    r"|\#[^\n]*+"
    r"|(?P<dot>\.)"
    r"|(?P<end>[=,\n\[\]{}])",
    re.DOTALL,
)
"""Strings and comments, in which a dot means nothing; dots; and what ends a key.

A string without an end goes on to the end of the file: nothing in it is read a second time.
"""


def check_regular(path: Path, most: int | None = MOST_BYTES) -> None:
    """Check a file without opening it: opening a pipe waits, and opening a device may act.

    most : bytes that it may have; None sets no limit.

    Raises
    ------
    InputError : it is missing, no regular file, or too large.
    """
    try:
        found = path.stat()
    except OSError as error:
        raise _unreadable(path, error) from None
    except ValueError as error:  # a path that can not be one
        raise InputError(repr(str(path)), "", None, str(error)) from None
    _check(path, found, most)


def _unreadable(path: Path, error: OSError) -> InputError:
    return InputError(path, "", None, (error.strerror or "can not be read").lower())


def _check(path: Path, found: os.stat_result, most: int | None) -> None:
    if not stat.S_ISREG(found.st_mode):
        kind = next((name for holds, name in KINDS if holds(found.st_mode)), "something else")
        raise InputError(path, "", None, f"is {kind}: must be a regular file")
    if most is not None and found.st_size > most:
        raise _too_large(path, found.st_size, most)


def _too_large(path: Path, size: int, most: int) -> InputError:
    return InputError(path, "size", size, f"at most {most} bytes ({most // 2**20} MiB)")


def read_bytes(path: Path, most: int = MOST_BYTES) -> bytes:
    """The content of a regular file.

    most : bytes that it may have.

    Raises
    ------
    InputError : it is missing, no regular file, not readable, or too large.
    """
    check_regular(path, most)
    try:
        with os.fdopen(os.open(path, READING), "rb") as stream:
            _check(path, os.fstat(stream.fileno()), most)  # it may be another file by now
            content = stream.read(most + 1)  # files of /proc have more than their size says
    except OSError as error:
        raise _unreadable(path, error) from None
    if len(content) > most:
        raise _too_large(path, len(content), most)
    return content


def read_text(path: Path, most: int = MOST_BYTES) -> str:
    """The text of a file, with every end of a line as "\\n".

    Raises
    ------
    InputError : as `read_bytes`, or it is not text.
    """
    try:
        text = read_bytes(path, most).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(path, "", None, "no text file in UTF-8") from None
    if "\0" in text:  # what a disk leaves of a file that was not written to its end
        raise InputError(path, "", None, "holds zero bytes: damaged, or no text file")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def read_json(path: Path) -> dict[str, Any]:
    """The object in a JSON file.

    Raises
    ------
    InputError : as `read_text`, or it is not one whole JSON object.
    """
    text = read_text(path)
    try:
        data = json.loads(text, object_pairs_hook=partial(_without_doubles, path))
    except json.JSONDecodeError as error:
        place = f"line {error.lineno}, column {error.colno}"
        raise InputError(path, place, error.msg, "a whole JSON file (is it cut off?)") from None
    except InputError:
        raise
    except (ValueError, RecursionError) as error:  # numbers too long, brackets too deep
        raise InputError(path, "", None, f"no JSON that can be read: {error}") from None
    if not isinstance(data, dict):
        raise InputError(path, "", type(data).__name__, "a JSON object {…}")
    _check_depth(path, data)
    return data


def _without_doubles(path: Path, pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    data = dict(pairs)
    if len(data) < len(pairs):
        times = Counter(key for key, _ in pairs)
        double = next(key for key, count in times.items() if count > 1)
        raise InputError(path, double, None, "stands there twice")
    return data


def parse_toml(text: str, where: object) -> dict[str, Any]:
    """The tables of a TOML text.

    where : the file or option that it comes from, for people.

    Raises
    ------
    InputError : it is no TOML, or too long or too deep to be a scene.
    """
    size = len(text.encode("utf-8", "surrogatepass"))
    if size > MOST_TOML:
        raise _too_large(Path(str(where)), size, MOST_TOML)
    _check_keys(text, where)
    try:
        data = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(where, "", None, f"no TOML file: {error}") from None
    _check_depth(where, data)
    return data


def _check_keys(text: str, where: object) -> None:
    """Refuse a key of very many parts before it is parsed."""
    parts = 1
    for token in TOML_TOKEN.finditer(text):
        if token["end"]:
            parts = 1
        elif token["dot"]:
            parts += 1
            if parts > MOST_KEY_PARTS:
                line = text.count("\n", 0, token.start()) + 1
                said = f"a key of at most {MOST_KEY_PARTS} parts"
                raise InputError(where, f"line {line}", None, said)


def _check_depth(where: object, data: Any) -> None:
    """Refuse data nested so deep that code which follows it would run out of stack."""
    level: list[Any] = [data]
    for _ in range(MOST_DEPTH):
        level = [inner for one in level for inner in _items(one) if isinstance(inner, dict | list)]
        if not level:
            return
    said = f"at most {MOST_DEPTH} tables and lists within each other"
    raise InputError(where, "", None, f"nested too deep: {said}")


def _items(container: Any) -> Iterable[Any]:
    return container.values() if isinstance(container, dict) else container
