"""Killed at any instant, a run goes on and ends in the same bytes; workers change nothing."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from tests.validation.check import Check, Row

UNLIKE = {"timing.csv", "provenance.json"}


def command(*arguments: str) -> list[str]:
    return [sys.executable, "-c", "from beamopt.cli import main; main()", *arguments]


def content(folder: Path) -> dict[str, bytes]:
    """Every file below a folder but those that hold times or the machine."""
    return {
        name: held for name, held in everything(folder).items() if Path(name).name not in UNLIKE
    }


def everything(folder: Path) -> dict[str, bytes]:
    """Every file below a folder, times and machine included."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def run(arguments: Sequence[str]) -> float:
    """Run to the end; returns seconds."""
    started = time.monotonic()
    subprocess.run(command(*arguments), check=True, capture_output=True)
    return time.monotonic() - started


def killed(arguments: Sequence[str], after: float) -> bool:
    """Run and send SIGKILL after some seconds; whether it was still running."""
    with subprocess.Popen(
        command(*arguments), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE
    ) as process:
        try:
            _, said = process.communicate(timeout=after)
        except subprocess.TimeoutExpired:
            os.kill(process.pid, signal.SIGKILL)
            process.communicate()
            return True
    assert process.returncode == 0, said
    return False


def differing(whole: Path, other: Path) -> list[str]:
    a, b = content(whole), content(other)
    return sorted(name for name in a.keys() | b.keys() if a.get(name) != b.get(name))


def survive(arguments: Sequence[str], kills: int, seed: int) -> tuple[int, int]:
    """Kill a command `kills` times, over as many folders as that takes.

    Returns how often it was killed and how many files differed from an undisturbed run's.
    """
    rng = random.Random(seed)
    with tempfile.TemporaryDirectory() as root:
        whole = Path(root) / "whole"
        seconds = run([*arguments, "--out", str(whole)])
        done = wrong = folder = 0
        while done < kills:
            folder += 1
            there = Path(root) / f"killed-{folder}"
            going_on = [*arguments, "--out", str(there), "--resume"]
            while killed(going_on, rng.uniform(0.1, 1.1) * seconds):
                done += 1
            wrong += len(differing(whole, there))
    return done, wrong


def checks(full: bool) -> list[Check]:
    kills, study_kills = (24, 6) if full else (3, 0)
    scene = ["optimize", "hand-drawn-section", "--seed", "7"]
    generations = "100" if full else "10"
    search = [*scene, "--set", f"search.generations={generations}"]
    study = ["study", "--iterations", "1", "--set", "search.generations=4", "--workers", "2"]

    def after_kills(name: str, arguments: list[str], count: int) -> Check:
        def rows() -> Iterator[Row]:
            done, wrong = survive(arguments, count, seed=2)
            source = "SIGKILL at random moments"
            what = f"{name}: files that differ from an undisturbed run's, after {done} kills"
            yield Row(what, source, 0, wrong, 0)

        return Check(name, rows)

    def same_for(name: str, arguments: list[str], workers: tuple[int, ...]) -> Check:
        def rows() -> Iterator[Row]:
            with tempfile.TemporaryDirectory() as root:
                folders = [Path(root) / str(count) for count in workers]
                for folder, count in zip(folders, workers, strict=True):
                    run([*arguments, "--workers", str(count), "--out", str(folder)])
                for folder, count in zip(folders[1:], workers[1:], strict=True):
                    wrong = len(differing(folders[0], folder))
                    what = f"{name}: files that differ between 1 and {count} workers"
                    yield Row(what, "same seed, same bytes", 0, wrong, 0)

        return Check(f"workers, {name}", rows)

    made: list[Callable[[], Check]] = [
        lambda: after_kills("search", search, kills),
        lambda: same_for("search", search, (1, 2, 3) if full else (1, 2)),
    ]
    if full:
        made += [
            lambda: after_kills("study", study, study_kills),
            lambda: same_for("study", study[:-2], (1, 2)),
        ]
    return [make() for make in made]
