"""Killing what writes a folder, and what must be the same in the end whatever was killed."""

from __future__ import annotations

import csv
import io
import json
import os
import random
import signal
import sys
import time
import traceback
import warnings
from collections.abc import Callable, Collection
from pathlib import Path
from typing import Any

import numpy as np

__all__ = ["MOMENT", "differing", "survives", "timeless"]

MOMENT = "beamopt.moment"
"""Audit event by which work names a moment at which it may be killed, besides changes of files."""

CHANGES = {"os.rename", "os.remove", "os.mkdir", "os.truncate"}
WRITING = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_APPEND | os.O_TRUNC
SECONDS = 300.0  # after which a child is taken to hang
UNLIKE = {"timing.csv", "provenance.json", "picture.png"}


def survives(
    work: Callable[[Path], object],
    root: Path,
    *,
    kills: int = 5,
    seed: int = 0,
    begin: Callable[[Path], object] = lambda folder: None,
    apart: Collection[str] = (),
) -> None:
    """Kill work before changes of its folder, go on with it, and compare it with whole work.

    work : makes, or goes on with, the folder that it is given. begin : what is there before.
    apart : files that hold times besides those that always do.
    """
    rng, number, done = random.Random(seed), 0, 0
    whole, counted = root / "whole", root / "counted"
    begin(whole)
    work(whole)  # in this process: its children find every kernel loaded
    begin(counted)
    moments = _in_child(work, counted)
    assert moments is not None
    while done < kills:
        number += 1
        folder = root / f"killed-{number}"
        begin(folder)
        at: int | None = rng.randint(1, moments)
        while _in_child(work, folder, at) is None:
            done += 1
            at = rng.randint(1, moments) if done < kills else None
        assert differing(whole, folder, apart) == []


def _in_child(work: Callable[[Path], object], folder: Path, at: int | None = None) -> int | None:
    """Work in a forked child; the number of its moments, None where it was killed before one."""
    reading, writing = os.pipe()
    with warnings.catch_warnings():  # of threads, from Python 3.12 on
        warnings.simplefilter("ignore", DeprecationWarning)
        child = os.fork()
    if child == 0:
        os.close(reading)
        _work_and_end(work, folder, at, writing)
    os.close(writing)
    until = time.monotonic() + SECONDS
    while (ended := os.waitpid(child, os.WNOHANG))[0] == 0:
        if time.monotonic() > until:
            os.kill(child, signal.SIGKILL)
        time.sleep(0.002)
    with os.fdopen(reading) as stream:
        said = stream.read()
    if os.WIFSIGNALED(ended[1]):
        assert time.monotonic() < until, "it hung"
        return None
    assert os.WEXITSTATUS(ended[1]) == 0, said
    return int(said)


def _work_and_end(
    work: Callable[[Path], object], folder: Path, at: int | None, writing: int
) -> None:
    count, below, code = 0, str(folder), 1

    def hook(event: str, arguments: tuple[Any, ...]) -> None:
        nonlocal count
        if _is_moment(event, arguments, below):
            count += 1
            if count == at:
                os.kill(os.getpid(), signal.SIGKILL)

    try:
        sys.addaudithook(hook)
        work(folder)
        said, code = str(count), 0
    except BaseException:
        said = traceback.format_exc()
    os.write(writing, said.encode()[-4000:])
    os._exit(code)


def _is_moment(event: str, arguments: tuple[Any, ...], below: str) -> bool:
    if event == MOMENT:
        return True
    if event not in CHANGES and not (event == "open" and arguments[2] & WRITING):
        return False
    return str(arguments[0]).startswith(below)


def differing(whole: Path, other: Path, apart: Collection[str] = ()) -> list[str]:
    """Names of files that are not the same in both folders, but for times."""
    a, b = timeless(whole, apart), timeless(other, apart)
    return sorted(name for name in a.keys() | b.keys() if a.get(name) != b.get(name))


def timeless(folder: Path, apart: Collection[str] = ()) -> dict[str, object]:
    """Every file below a folder without the times in it; none of files that hold nothing else."""
    return {
        str(path.relative_to(folder)): None
        if path.name in UNLIKE or path.name in apart
        else _without_times(path)
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def _without_times(path: Path) -> object:
    content = path.read_bytes()
    if path.suffix == ".jsonl" and b'"seconds"' in content:
        lines = [json.loads(line) for line in content.splitlines()]
        return sorted(json.dumps(_without_time(line)) for line in lines)
    if path.suffix == ".csv" and b"seconds" in content.partition(b"\n")[0]:
        head, *rows = csv.reader(io.StringIO(content.decode(), newline=""))
        kept = [k for k, name in enumerate(head) if "seconds" not in name]
        return [[row[k] for k in kept] for row in (head, *rows)]
    if path.suffix == ".npz":
        with np.load(io.BytesIO(content)) as arrays:
            return {name: arrays[name].tobytes() for name in arrays.files if name != "seconds"}
    return content


def _without_time(line: dict[str, Any]) -> dict[str, Any]:
    """A line of a journal; its digest is of the time too."""
    return {name: value for name, value in line.items() if name not in ("seconds", "digest")}
