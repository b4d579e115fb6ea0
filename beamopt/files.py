"""Writing files so that a kill never leaves half a one, and so that people can read them."""

from __future__ import annotations

import csv
import errno
import io
import json
import os
from collections.abc import Iterable, Sequence
from pathlib import Path

__all__ = ["csv_text", "json_text", "write_atomic"]


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


def csv_text(header: str, rows: Iterable[Sequence[object]]) -> str:
    """A comma-separated table; floats with all their digits, empty cells for None."""
    stream = io.StringIO()
    stream.write(header + "\n")
    csv.writer(stream, lineterminator="\n").writerows(rows)
    return stream.getvalue()


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
