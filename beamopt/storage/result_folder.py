"""Taking a folder for a result: an empty one, or the one that is to be gone on with."""

from __future__ import annotations

import errno
import os
import re
from collections.abc import Collection, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from fnmatch import fnmatchcase
from glob import escape
from pathlib import Path
from typing import Any, BinaryIO

from beamopt.base.errors import InputError
from beamopt.storage.file_lock import HeldElsewhereError, locked
from beamopt.storage.scratch import clear_scratch
from beamopt.storage.writing import refuse_link

__all__ = [
    "LOCK",
    "FolderKind",
    "claimed",
    "clear_leftovers",
    "design_file",
    "differences",
    "own_subfolder",
]

LOCK = ".beamopt.lock"
"""File that a command has in its folder while it writes there; a kill leaves it."""

HEAD = 80  # bytes of a marker, which are enough to tell it

LEFTOVER = re.compile(r"\..+\.\d+\.tmp")  # what a kill leaves of `write_atomic`

FULL = (errno.ENOSPC, errno.EDQUOT, errno.EIO)
"""Errors that another folder on the same disk would not mend."""


@dataclass(frozen=True, slots=True)
class FolderKind:
    """What tells the folders of one command from all others.

    name : of the command. marker : a file, or a pattern of files, that each of them has once the
    command has begun, or, where it can not go on, once it is done.
    begins : how the marker begins, white space left out; a text for each version.
    goes_on : whether the command can go on with one.
    files : names, or patterns of names, of what the command writes beside the marker.
    """

    name: str
    marker: str
    begins: tuple[str, ...]
    goes_on: bool = True
    files: tuple[str, ...] = ()

    def is_of(self, folder: Path) -> bool:
        """Whether a folder has the marker; a kill may have left only a part of its beginning."""
        return any(self._marks(file) for file in folder.glob(self.marker) if file.is_file())

    def _marks(self, file: Path) -> bool:
        beginnings = [one.encode() for one in self.begins]
        with file.open("rb") as stream:
            head = b"".join(stream.read(HEAD).split())
        return any(head.startswith(one) or one.startswith(head) for one in beginnings)


@contextmanager
def claimed(
    path: Path, kind: FolderKind, *, resume: bool, patience: float | None = None
) -> Iterator[None]:
    """Make a folder, or take an empty one or one of the same kind; lock it while it is written.

    A folder is of a kind by its marker, or by the lock file of a command that was killed in it. In
    such a folder files under the names that the command writes are the command's.

    resume : whether the folder may hold anything.
    patience : time to wait for another process that writes there [s]; short if left out.

    Raises
    ------
    InputError : it holds files and `resume` is off; it is of another kind; it holds a link; another
        process is writing to it; or it can not be made.
    """
    with ExitStack() as held:
        try:
            is_new = not path.exists()
            path.mkdir(parents=True, exist_ok=True)
            _check(path, kind, resume)  # before there is a lock file in it
            lock = held.enter_context(locked(path / LOCK, patience))
            _check(path, kind, resume)  # what another process wrote meanwhile
            _say(lock, kind.name)
        except HeldElsewhereError:
            said = "another process is writing to this folder"
            raise InputError(path, "", None, said) from None
        except OSError as error:
            if error.errno in FULL:
                raise
            said = f"{(error.strerror or 'can not be made').lower()}; name a folder to write to"
            raise InputError(path, "", None, said) from None
        clear_scratch()
        clear_leftovers(path, (escape(kind.marker), *kind.files))
        owner = os.getpid()
        try:
            yield
        except BaseException:
            if os.getpid() == owner and path.is_dir():
                _leave(path, kind, is_new=is_new)
            raise
        if os.getpid() == owner:
            (path / LOCK).unlink(missing_ok=True)


def _leave(path: Path, kind: FolderKind, *, is_new: bool) -> None:
    """Delete the lock file after an error, unless it alone tells whose the files are.

    is_new : whether the folder was made for the claim; it is deleted if nothing is in it.
    """
    if not _names(path) or kind.is_of(path):
        (path / LOCK).unlink(missing_ok=True)
    if is_new and not any(path.iterdir()):
        path.rmdir()


def _say(lock: BinaryIO, name: str) -> None:
    """Write which command has the folder, for a claim after a kill."""
    lock.truncate(0)
    lock.write(name.encode())


def _check(path: Path, kind: FolderKind, resume: bool) -> None:
    """Refuse a folder that may not be written to."""
    names = _names(path)
    for name in (*names, LOCK):
        refuse_link(path / name)
        _refuse_special(path / name)
    if not names:
        return
    is_done, is_cut = kind.is_of(path), _was_cut(path, kind)
    if not (is_done or is_cut):
        said = f"holds files but no {kind.marker} of {kind.name}; nothing to go on with"
        said = said if resume else "holds files already"
        raise InputError(path, "", None, f"{said}: name another folder")
    if kind.goes_on and not resume:
        raise InputError(path, "", None, "holds files already; --resume goes on with what is there")
    if not kind.goes_on and is_done:
        raise InputError(path, "", None, "holds files already: name another folder")


def _refuse_special(path: Path) -> None:
    """Refuse pipes and devices, which opening could wait for, or act on."""
    if path.exists() and not (path.is_file() or path.is_dir()):
        raise InputError(path, "", None, "must be a regular file or a folder")


def _names(path: Path) -> list[str]:
    """What a folder holds, apart from what a kill left."""
    names = sorted(item.name for item in path.iterdir())
    return [name for name in names if name != LOCK and not LEFTOVER.fullmatch(name)]


def _was_cut(path: Path, kind: FolderKind) -> bool:
    lock = path / LOCK
    return lock.is_file() and lock.read_bytes() == kind.name.encode()


def own_subfolder(path: Path) -> Path:
    """Make a folder within a claimed one, and delete what a kill left in it.

    Raises
    ------
    InputError : it is a link.
    """
    refuse_link(path)
    path.mkdir(exist_ok=True)
    clear_leftovers(path, ("*",))
    return path


def clear_leftovers(path: Path, names: Collection[str]) -> None:
    """Delete what a kill left of writing any of the files `names`, which may be patterns."""
    for item in path.iterdir():
        name = item.name[1:].rpartition(".tmp")[0].rpartition(".")[0]
        if LEFTOVER.fullmatch(item.name) and any(fnmatchcase(name, one) for one in names):
            item.unlink(missing_ok=True)


def design_file(path: Path) -> Path:
    """The design of a run folder: its refined one where there is one, else the best of the search.

    A file is itself.
    """
    if not path.is_dir():
        return path
    refined = path / "refined.json"
    return refined if refined.exists() else path / "best.json"


def differences(
    before: Any, now: Any, free: Collection[str] = (), key: str = ""
) -> Iterator[tuple[str, Any, Any]]:
    """Keys of nested tables whose values differ, as "table.key", with both values.

    free : keys, or whole tables, that may differ.
    """
    if isinstance(before, dict) and isinstance(now, dict):
        for name in before | now:
            inner = f"{key}.{name}" if key else name
            if inner not in free:
                yield from differences(before.get(name), now.get(name), free, inner)
    elif before != now:
        yield key, before, now
