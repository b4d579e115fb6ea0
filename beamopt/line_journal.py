"""Results on disk as they come, a line each: a kill loses those under way only."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from beamopt.errors import InputError

__all__ = ["LineJournal"]


class LineJournal:
    """A file whose first line says what was asked, and whose others are results.

    path : of the file. asked : what the results depend on; that of a file that is there must be
    the same. kind : what it is a journal of, for people.

    Raises
    ------
    InputError : the file that is there is another one's, or is damaged.
    """

    def __init__(self, path: Path, asked: dict[str, Any], kind: str) -> None:
        self.path = path
        self.kind = kind
        self.entries: list[dict[str, Any]] = []
        lines = path.read_bytes().splitlines(keepends=True) if path.exists() else []
        whole = [line for line in lines if line.endswith(b"\n")]
        if not whole:
            path.write_text(json.dumps(asked) + "\n", encoding="utf-8")
            return
        try:
            head, *entries = (json.loads(line) for line in whole)
        except ValueError:
            raise self.damaged() from None
        if head != json.loads(json.dumps(asked)):
            said = f"the {kind} there is of another question; name another folder, or ask alike"
            raise InputError(path, "", None, said)
        if not all(isinstance(entry, dict) for entry in entries):
            raise self.damaged()
        self.entries = entries
        if len(whole) < len(lines):  # a kill left half a line
            with path.open("r+b") as stream:
                stream.truncate(sum(map(len, whole)))

    def damaged(self) -> InputError:
        """What to raise where an entry can not be read."""
        return InputError(self.path, "", None, f"no journal of a {self.kind}")

    def add(self, entry: dict[str, Any]) -> None:
        """Keep a result."""
        self.entries.append(entry)
        with self.path.open("a", encoding="utf-8") as stream:
            stream.write(json.dumps(entry) + "\n")
