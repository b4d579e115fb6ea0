"""Writing files so that a kill never leaves half a one, and so that people can read them."""

from __future__ import annotations

import csv
import errno
import json
import os
import re
from collections.abc import Iterable, Sequence
from pathlib import Path

__all__ = ["cell_text", "csv_text", "json_text", "write_atomic", "write_changed"]

FORMULA = re.compile(r"'*[=+\-@\t\r]")  # also behind apostrophes: one more tells them apart
NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")
LINE_END = "\r\n"


def write_atomic(path: Path, content: str | bytes) -> None:
    """Write a whole file or nothing: to a temporary name beside it, to disk, then renamed.

    Raises
    ------
    OSError : the folder is missing or can not be written.
    """
    data = content.encode() if isinstance(content, str) else content
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    if not path.parent.is_dir():
        raise FileNotFoundError(errno.ENOENT, "no such folder", str(path.parent))
    try:
        with temporary.open("wb") as stream:
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def write_changed(path: Path, content: str | bytes) -> bool:
    """Write a file as `write_atomic` does, unless it holds just that; says whether it wrote.

    Raises
    ------
    OSError : the folder is missing or can not be written.
    """
    data = content.encode() if isinstance(content, str) else content
    if path.is_file() and path.read_bytes() == data:
        return False
    write_atomic(path, data)
    return True


def csv_text(header: str, rows: Iterable[Sequence[object]]) -> str:
    """A comma-separated table; floats with all their digits, empty cells for None.

    Text that a spreadsheet would run as a formula gets an apostrophe in front; `cell_text` takes
    it off again.
    """
    lines = _Lines([header])
    cells = ([_defused(cell) if isinstance(cell, str) else cell for cell in row] for row in rows)
    csv.writer(lines, lineterminator=LINE_END).writerows(cells)
    return "\n".join([*lines, ""])


class _Lines(list[str]):
    """Lines of a csv writer, a row each; it quotes cells that hold a part of `LINE_END`."""

    def write(self, line: str) -> None:
        """Take a row."""
        self.append(line.removesuffix(LINE_END))


def _defused(text: str) -> str:
    harmless = not FORMULA.match(text) or NUMBER.fullmatch(text)
    return text if harmless else "'" + text


def cell_text(cell: str) -> str:
    """The text that `csv_text` was given for a cell."""
    return cell[1:] if cell.startswith("'") and FORMULA.match(cell) else cell


def json_text(value: object, *, escaped: bool = True) -> str:
    """JSON with one key a line and lists of plain values on one line.

    escaped : whether characters beyond ASCII are written as escapes. What no file can hold as it
        is (control characters, halves of a surrogate pair) always is.
    """
    text = _json(value, "", escaped) + "\n"
    return text.encode("utf-8", "backslashreplace").decode("utf-8")  # such a half: JSON's escape


def _json(value: object, indent: str, escaped: bool) -> str:
    inner = indent + " "
    if isinstance(value, dict) and value:
        items = [
            f"{inner}{json.dumps(key, ensure_ascii=escaped)}: {_json(item, inner, escaped)}"
            for key, item in value.items()
        ]
        return "{\n" + ",\n".join(items) + f"\n{indent}}}"
    if isinstance(value, list) and any(isinstance(item, dict) for item in value):
        items = [inner + _json(item, inner, escaped) for item in value]
        return "[\n" + ",\n".join(items) + f"\n{indent}]"
    return json.dumps(value, allow_nan=False, ensure_ascii=escaped)
