"""One hostile case: files, a command line, and what must become of it."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tests.hostile.server import CPU_SECONDS, MEMORY

ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"
)


@dataclass(frozen=True)
class Case:
    """A command on hostile input.

    make : writes its files to an empty folder. codes : how it may end.
    settings : streams, environment, encoding and file_size; see `server`.
    """

    name: str
    program: str
    arguments: list[str]
    make: Callable[[Path], None]
    codes: tuple[int, ...] = (2,)
    settings: dict[str, Any] = field(default_factory=dict)


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
        asked = {"program": case.program, "arguments": case.arguments, **case.settings}
        paths = {"place": str(place), "folder": str(folder)}
        process.stdin.write(json.dumps(asked | paths) + "\n")
        process.stdin.flush()
        return dict(json.loads(process.stdout.readline()))

    def end(self) -> None:
        """Leave no process behind."""
        self._process.communicate()


def held(folder: Path) -> dict[str, tuple[object, ...]]:
    """What a folder holds: names, kinds, times of change, bytes of regular files."""
    found: dict[str, tuple[object, ...]] = {}
    for above, folders, files in os.walk(os.fsencode(folder)):
        for name in (*folders, *files):
            path = os.path.join(above, name)
            state = os.lstat(path)
            content: object = ""
            if os.path.islink(path):
                content = os.readlink(path)
            elif os.path.isfile(path) and state.st_size < 2**24:
                content = Path(os.fsdecode(path)).read_bytes()
            changed = 0 if os.path.isdir(path) else state.st_mtime_ns
            found[os.fsdecode(path)] = (state.st_mode, state.st_size, changed, content)
    return found


def check(case: Case, server: Server, place: Path) -> None:
    """Run a case and hold it to what every command promises."""
    folder, beside = place / "here", place / "beside"
    folder.mkdir()
    beside.mkdir()
    (beside / "somebody's.txt").write_text("of somebody")
    (beside / "best.json").write_text("{}")
    case.make(folder)
    before, other = held(folder), held(beside)
    found = server.run(case, place, folder)
    said, wrong = found["stdout"], found["stderr"]
    told = f"{found}"[:3000]
    assert not found["hung"], told
    assert "Traceback" not in wrong + said, wrong[-3000:]
    assert found["code"] in case.codes, told
    assert found["cpu"] < CPU_SECONDS, told
    assert found["memory"] < MEMORY, told
    assert held(beside) == other, told
    after = held(folder)
    assert {name: after.get(name) for name in before} == before or found["code"] in (0, 1, 3), told
    if found["code"] == 2 and wrong:
        lines = [line for line in wrong.splitlines() if not line.startswith("note: ")]
        assert len(lines) == 1, wrong
        assert lines[0].startswith(f"{case.program}: "), wrong
    if found["code"] == 2:
        assert after.keys() == before.keys(), sorted(after.keys() - before.keys())
