"""One hostile case: files, a command line, and what must become of it."""

from __future__ import annotations

import csv
import io
import json
import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tests.hostile.server import MEMORY

ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"
)


@dataclass(frozen=True)
class Case:
    """Commands on hostile input, one after another.

    make : writes files to an empty folder. codes : how each may end.
    settings : streams, environment, encoding and file_size; see `server`.
    places : folder of each line within that of the case; that of the case itself if left out.
    """

    lines: list[list[str]]
    make: Callable[[Path], None]
    codes: tuple[int, ...] = (2,)
    settings: dict[str, Any] = field(default_factory=dict)
    places: tuple[str, ...] = ()

    def folders(self, folder: Path) -> list[Path]:
        """Folder of each line."""
        return [folder / place for place in self.places or [""] * len(self.lines)]


class Server:
    """The process that runs cases; see `server`."""

    def __init__(self) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", "tests.hostile.server"],
            cwd=Path(__file__).resolve().parents[2],
            env={**os.environ, **ONE_THREAD},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def run(self, case: Case, place: Path, folder: Path) -> dict[str, Any]:
        """Run a case in a folder; what it prints goes to `place`."""
        process = self._process
        assert process.stdin is not None
        assert process.stdout is not None
        asked = {"lines": case.lines, **case.settings}
        paths = {"place": str(place), "folders": [str(one) for one in case.folders(folder)]}
        process.stdin.write(json.dumps(asked | paths) + "\n")
        process.stdin.flush()
        return dict(json.loads(process.stdout.readline()))

    def end(self) -> None:
        """Leave no process behind."""
        self._process.communicate()


def held(folder: Path) -> dict[str, tuple[object, ...]]:
    """What a folder holds: names, kinds, times of change, bytes of regular files."""
    found: dict[str, tuple[object, ...]] = {}
    for above, folders, files in os.walk(folder):
        for path in (Path(above) / name for name in (*folders, *files)):
            state = path.lstat()
            content: object = ""
            if path.is_symlink():
                content = path.readlink()
            elif path.is_file() and state.st_size < 2**24:
                content = path.read_bytes()
            changed = 0 if path.is_dir() else state.st_mtime_ns
            found[str(path)] = (state.st_mode, state.st_size, changed, content)
    return found


def check(case: Case, server: Server, place: Path) -> str:
    """Run a case and hold it to what every command promises; its exit codes, a digit a line."""
    folder, beside = place / "here", place / "beside"
    folder.mkdir()
    beside.mkdir()
    (beside / "somebody's.txt").write_text("of somebody")
    (beside / "best.json").write_text("{}")
    case.make(folder)
    before, other = held(folder), held(beside)
    found = server.run(case, place, folder)
    assert not found["hung"], found
    assert found["memory"] < MEMORY, found
    assert held(beside) == other
    for line, ended in zip(case.lines, found["lines"], strict=True):
        _check_line(line, ended, case.codes)
    codes = "".join(str(ended["code"]) for ended in found["lines"])
    after = held(folder)
    changed = {Path(name) for name in {*before, *after} if after.get(name) != before.get(name)}
    for one, ended_there in _codes_by_folder(case, folder, codes).items():
        here = [name for name in changed if one in name.parents]
        assert set(ended_there) != {"2"} or not here, (here, found)
    return codes


def _codes_by_folder(case: Case, folder: Path, codes: str) -> dict[Path, str]:
    by_folder: dict[Path, str] = {}
    for one, code in zip(case.folders(folder), codes, strict=True):
        by_folder[one] = by_folder.get(one, "") + code
    return by_folder


CODES = dict(csv.reader((Path(__file__).parent / "codes.csv").read_text().splitlines()))
"""Exit codes by case, a digit for each of its lines, in their order."""


def check_codes(name: str, codes: str) -> None:
    """Compare a case's exit codes with those that its row in the table has."""
    row = io.StringIO()
    csv.writer(row, lineterminator="").writerow([name, codes])
    assert CODES.get(name) == codes, f"codes.csv has {CODES.get(name)}; right now: {row.getvalue()}"


def _check_line(line: list[str], ended: dict[str, Any], codes: tuple[int, ...]) -> None:
    about = f"{' '.join(line)[:300]}: {f'{ended}'[-3000:]}"
    assert "Traceback" not in ended["stderr"] + ended["stdout"], about
    assert ended["code"] in codes, about
    if ended["code"] == 2 and ended["stderr"]:
        said = [one for one in ended["stderr"].splitlines() if not one.startswith("note: ")]
        assert len(said) == 1, about
        assert said[0].startswith(f"{line[0]}: "), about
