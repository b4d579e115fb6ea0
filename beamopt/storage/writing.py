"""Writing files so that a kill never leaves half a one, and so that people can read them."""

from __future__ import annotations

import csv
import errno
import json
import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

from beamopt.base.errors import InputError

__all__ = [
    "cell_text",
    "check_replaceable",
    "csv_text",
    "json_text",
    "naming",
    "refuse_link",
    "replacing",
    "still_complete",
    "write_atomic",
    "write_changed",
]

FORMULA = re.compile(r"'*[=+\-@\t\r]")  # also behind apostrophes: one more tells them apart
NUMBER = re.compile(r"[+-]?([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][+-]?[0-9]+)?")
LINE_END = "\r\n"
END = 1 << 14  # bytes, in which a file says what wrote it


def write_atomic(path: Path, content: str | bytes) -> None:
    """Write a whole file or nothing: to a temporary name beside it, to disk, then renamed.

    Raises
    ------
    InputError : the name is a link.
    OSError : the folder is missing or can not be written.
    """
    data = _bytes(content)
    with replacing(path) as temporary, temporary.open("xb") as stream:
        stream.write(data)


def _bytes(content: str | bytes) -> bytes:
    """UTF-8; what a name of any bytes holds that is none is written as an escape."""
    return content.encode("utf-8", "backslashreplace") if isinstance(content, str) else content


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A temporary name beside a file; what is written to it takes the file's place in the end.

    Raises
    ------
    InputError : the file is a link.
    OSError : the folder is missing or can not be written.
    """
    refuse_link(path)
    if not path.parent.is_dir():
        raise FileNotFoundError(errno.ENOENT, "no such folder", str(path.parent))
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    with naming(path):
        temporary.unlink(missing_ok=True)  # of an earlier process with this number
        try:
            yield temporary
            with temporary.open("rb+") as stream:
                os.fsync(stream.fileno())
            temporary.replace(path)
        finally:
            temporary.unlink(missing_ok=True)


@contextmanager
def naming(path: Path) -> Iterator[None]:
    """Let an error of the file system name the file, which one of a full disk does not."""
    try:
        yield
    except OSError as error:
        error.filename, error.filename2 = str(path), None
        raise


def refuse_link(path: Path) -> None:
    """Refuse to write to, or through, a symbolic link.

    Raises
    ------
    InputError : it is one.
    """
    if path.is_symlink():
        said = "is a link; nothing is written through links: name the file or folder itself"
        raise InputError(path, "", None, said)


def check_replaceable(path: Path, mark: str, made_by: str, *, force: bool = False) -> None:
    """Refuse to write over a file that a command did not write.

    mark : a text near the beginning or the end of each file that the command writes.
    force : whether it may be written over all the same.

    Raises
    ------
    InputError : the file has no mark and `force` is off; it is a link, a folder or a device.
    """
    refuse_link(path)
    if not path.exists():
        return
    if not path.is_file():
        said = "is a folder; name a file" if path.is_dir() else "is no file; name another one"
        raise InputError(path, "", None, said)
    if not force and mark.encode() not in _ends_of(path):
        said = f"was not written by {made_by}; --force writes over it all the same"
        raise InputError(path, "", None, said)


def _ends_of(path: Path) -> bytes:
    """Return the beginning and the end of a file's content."""
    with path.open("rb") as stream:
        head = stream.read(END)
        stream.seek(max(len(head), path.stat().st_size - END))
        return head + stream.read(END)


def write_changed(path: Path, content: str | bytes) -> bool:
    """Write a file as `write_atomic` does, unless it holds just that; says whether it wrote.

    Raises
    ------
    InputError : the name is a link.
    OSError : the folder is missing or can not be written.
    """
    data = _bytes(content)
    refuse_link(path)
    if _holds(path, data):
        return False
    write_atomic(path, data)
    return True


def _holds(path: Path, data: bytes) -> bool:
    return path.is_file() and path.read_bytes() == data


def still_complete(folder: Path, texts: Mapping[str, str]) -> bool:
    """True if a folder was written to its end, and these of its files stay as they are.

    Its `provenance.json`, which is written last, says the first. It is deleted where a file is to
    change: a kill between the files leaves a folder whose figures and times are made again.
    """
    mark = folder / "provenance.json"
    if not all(_holds(folder / name, _bytes(text)) for name, text in texts.items()):
        mark.unlink(missing_ok=True)
    return mark.exists()


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
            f"{inner}{_json(key, inner, escaped)}: {_json(item, inner, escaped)}"
            for key, item in value.items()
        ]
        return "{\n" + ",\n".join(items) + f"\n{indent}}}"
    if isinstance(value, list) and any(isinstance(item, dict) for item in value):
        items = [inner + _json(item, inner, escaped) for item in value]
        return "[\n" + ",\n".join(items) + f"\n{indent}]"
    return json.dumps(value, allow_nan=False, ensure_ascii=escaped)
