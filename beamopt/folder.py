"""Taking a folder for a result: an empty one, or the one that is to be gone on with."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Any

from beamopt.errors import InputError

__all__ = ["claim_folder", "clear_leftovers", "design_file", "differences"]

LEFTOVER = re.compile(r"\..+\.\d+\.tmp")  # what a kill leaves of `write_atomic`


def claim_folder(path: Path, marker: str, early: Collection[str] = (), *, resume: bool) -> None:
    """Make a folder, or check that what it holds may be gone on with.

    Parameters
    ----------
    marker : the file that tells a folder of this kind.
    early : files that such a folder may hold before it has its marker.
    resume : whether it may hold anything.

    Raises
    ------
    InputError : it holds files and `resume` is off, or it is of another kind, or can not be made.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
        held = {item.name for item in path.iterdir() if not LEFTOVER.fullmatch(item.name)}
    except OSError as error:
        reason = (error.strerror or "can not be made").lower()
        raise InputError(path, "", None, f"{reason}; name a folder that can be written") from None
    if held and not resume:
        raise InputError(path, "", None, "holds files already; --resume goes on with what is there")
    if marker not in held and held - set(early):
        raise InputError(path, "", None, f"holds files but no {marker}; nothing to go on with")


def clear_leftovers(path: Path, names: Collection[str] | None) -> None:
    """Delete what a kill left of writing any of the files `names`; None: of any file."""
    for item in path.iterdir():
        name = item.name[1:].rpartition(".tmp")[0].rpartition(".")[0]
        if LEFTOVER.fullmatch(item.name) and (names is None or name in names):
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
