"""Results on disk as they come, a line each: a kill loses those under way only.

Every line ends with a digest of the rest of it, so that a line that was damaged or changed is
told from one that was written. Journals of earlier versions have none; they are read, and gone on
with, without. JSON has no NaN and no infinity: {"not finite": "nan"} stands for one.
"""

from __future__ import annotations

import hashlib
import json
import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from beamopt.base.errors import InputError
from beamopt.storage.input_file import check_regular
from beamopt.storage.result_folder import check_same
from beamopt.storage.writing import naming, refuse_link, write_atomic

__all__ = ["LineJournal", "with_digest", "without_digest"]

T = TypeVar("T")

SEALED = re.compile(r'(\{.+),"digest":"([0-9a-f]{16})"\}', re.DOTALL)


NOT_FINITE = "not finite"


def _written(entry: Any) -> str:
    """An entry as JSON that every reader takes."""
    return json.dumps(_finite(entry), allow_nan=False)


def _finite(value: Any) -> Any:
    if isinstance(value, float) and not math.isfinite(value):
        return {NOT_FINITE: str(float(value))}
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    return [_finite(item) for item in value] if isinstance(value, list | tuple) else value


def _read(text: str) -> Any:
    """What `_written` was given, tuples as lists."""
    return json.loads(text, object_hook=_number_or_object)


def _number_or_object(found: dict[str, Any]) -> Any:
    if found.keys() != {NOT_FINITE}:
        return found
    if found[NOT_FINITE] not in ("nan", "inf", "-inf"):
        raise ValueError("another number")
    return float(found[NOT_FINITE])


def with_digest(text: str) -> str:
    """The text of a JSON object, which is not empty, with a digest of it as its last member."""
    return f'{text[:-1]},"digest":"{_digest(text)}"}}'


def without_digest(line: str) -> str | None:
    """The text that `with_digest` was given; None for a line without a digest.

    Raises
    ------
    ValueError : the digest is of another text.
    """
    found = SEALED.fullmatch(line)
    if found is None:
        return None
    text = found[1] + "}"
    if _digest(text) != found[2]:
        raise ValueError("the digest is of another text")
    return text


def _digest(text: str) -> str:
    return hashlib.blake2b(text.encode(), digest_size=8).hexdigest()


class LineJournal:
    """A file whose first line says what was asked, and whose others are results.

    path : of the file. asked : what the results depend on; that of a file that is there must be
    the same; None takes what the file says, and reads it only. kind : what it is a journal of, for
    people.

    Raises
    ------
    InputError : the file that is there is another one's, or is damaged (names the line), or is a
        link.
    """

    def __init__(self, path: Path, asked: dict[str, Any] | None, kind: str) -> None:
        self.path = path
        self.kind = kind
        self.entries: list[dict[str, Any]] = []
        self.digests = True
        if asked is not None:
            refuse_link(path)
        if path.exists():
            check_regular(path, None)
        content = path.read_bytes() if path.exists() else b""
        lines = content.splitlines(keepends=True)
        whole = [line for line in lines if line.endswith(b"\n")]
        if not whole:
            head = b"" if asked is None else (with_digest(_written(asked)) + "\n").encode()
            if asked is None or not head.startswith(content):  # half a line of another file
                raise self.damaged(1)
            self.asked = asked
            write_atomic(path, head)
            return
        self.digests = SEALED.fullmatch(whole[0][:-1].decode(errors="replace")) is not None
        self.asked = self._object(1, whole[0])
        if asked is not None:
            check_same(path, self.asked, _read(_written(asked)), kind)
        self.entries = [self._object(number, line) for number, line in enumerate(whole[1:], 2)]
        if asked is not None and len(whole) < len(lines):  # a kill left half a line
            with path.open("r+b") as stream:
                stream.truncate(sum(map(len, whole)))

    def _object(self, number: int, line: bytes) -> dict[str, Any]:
        """The object in a line, checked against its digest."""
        try:
            text = line[:-1].decode()
            checked = without_digest(text)
            found = _read(text if checked is None else checked)
        except (ValueError, RecursionError):
            raise self.damaged(number) from None
        if not isinstance(found, dict) or (checked is not None) != self.digests:
            raise self.damaged(number)
        if "digest" in found:  # of a line whose digest can not be read
            raise self.damaged(number)
        return found

    def damaged(self, number: int) -> InputError:
        """Return the error to raise where line `number`, from 1, can not be read."""
        said = (
            f"no journal of a {self.kind}: the line is damaged or was changed; "
            "cut the file off before it to compute it, and what follows, again"
        )
        return InputError(self.path, f"line {number}", None, said)

    def read(self, convert: Callable[[dict[str, Any]], T]) -> list[T]:
        """Every entry as what `convert` makes of it.

        Raises
        ------
        InputError : an entry that it can not convert, by its line.
        """
        found = []
        for number, entry in enumerate(self.entries, 2):
            try:
                found.append(convert(entry))
            except (ValueError, KeyError, TypeError, AttributeError, OverflowError):
                raise self.damaged(number) from None
        return found

    def add(self, entry: dict[str, Any], *, keep: bool = True) -> None:
        """Write a result; `keep` says whether `entries` holds it too."""
        if keep:
            self.entries.append(entry)
        text = _written(entry)
        with naming(self.path), self.path.open("a", encoding="utf-8") as stream:
            stream.write((with_digest(text) if self.digests else text) + "\n")
