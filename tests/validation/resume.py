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
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from tests.kills import differing
from tests.validation.check import Check, Row

ENDED = (0, 1)  # exit codes of what was computed, whatever it says
UNLIKE = {"timing.csv", "provenance.json"}


def command(*arguments: str) -> list[str]:
    """What starts a command of beamopt, or of femcheck if that is the first argument."""
    program, rest = (
        ("femcheck", arguments[1:]) if arguments[0] == "femcheck" else ("beamopt", arguments)
    )
    return [sys.executable, "-c", f"from {program}.cli import main; main()", *rest]


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
    done = subprocess.run(command(*arguments), check=False, capture_output=True)
    assert done.returncode in ENDED, done.stderr
    return time.monotonic() - started


def killed(arguments: Sequence[str], after: float, temporary: Path) -> bool:
    """Run and send SIGKILL after some seconds; whether it was still running."""
    with subprocess.Popen(
        command(*arguments),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        env=os.environ | {"TMPDIR": str(temporary)},
    ) as process:
        try:
            _, said = process.communicate(timeout=after)
        except subprocess.TimeoutExpired:
            os.kill(process.pid, signal.SIGKILL)
            process.communicate()
            return True
    assert process.returncode in ENDED, said
    return False


@dataclass(frozen=True)
class Chain:
    """A command that is killed, gone on with, and killed again.

    arguments : without `--out`; {small} stands for the file of a small sealed design.
    goes_on : whether it has `--resume`; others begin again in the same folder.
    apart : files that hold times besides those that always do.
    """

    name: str
    arguments: tuple[str, ...]
    kills: int
    goes_on: bool = True
    apart: tuple[str, ...] = ()

    def survive(self, seed: int) -> tuple[int, int]:
        """Kill it so many times, over as many folders as that takes.

        Returns how often it was killed, and how many files differed from an undisturbed run's or
        were left in the temporary folder.
        """
        from tests.femcheck.check.small import design_of, three_circles  # which loads femcheck

        rng = random.Random(seed)
        with tempfile.TemporaryDirectory() as name:
            root = Path(name)
            small, temporary = root / "small.json", root / "temporary"
            design_of(three_circles()).save(small)
            temporary.mkdir()
            arguments = [part.format(small=small) for part in self.arguments]
            seconds = run([*arguments, "--out", str(root / "whole")])
            done = wrong = folder = 0
            while done < self.kills:
                folder += 1
                there = root / f"killed-{folder}"
                again = [*arguments, "--out", str(there), *(["--resume"] if self.goes_on else [])]
                while killed(again, rng.uniform(0.1, 1.1) * seconds, temporary):
                    done += 1
                wrong += len(differing(root / "whole", there, self.apart))
                wrong += len(list(temporary.glob("beamopt-*")))
        return done, wrong


SOLID = ("--layers", "2", "--size", "9")
SILICONE = ("--law", "neo-hookean", "--nu", "0.4")
STUDY = ("study", "--iterations", "1", "--set", "search.generations=4")
FRONT = ("pareto", "random-section", "--objectives", "L,mass", "--population", "24")
CHAINS = (
    Chain("study", (*STUDY, "--workers", "2"), 6),
    Chain("front", (*FRONT, "--generations", "30"), 8),
    Chain("bound", ("bound", "hand-drawn-workspace"), 6, goes_on=False),
    Chain("export", ("export", "{small}"), 8, goes_on=False),
    Chain(
        "chart of rods",
        ("chart", "gravity"),
        3,
        goes_on=False,
        apart=("chart.csv", "chart.svg", "chart.png"),  # a clock ends its methods
    ),
    Chain(
        "map of rods",
        ("stability", "--samples", "8", "--workers", "2"),
        4,
        apart=("reading.md", "stability.svg", "stability.png"),
    ),
    Chain("check", ("femcheck", "run", "{small}", "--element", "tet4", *SOLID), 8),
    Chain("prediction", ("femcheck", "run", "{small}", "--law", "neo-hookean", *SOLID), 8),
    Chain("accuracy", ("femcheck", "run", "{small}", *SILICONE, "--accuracy", "5mm"), 6),
    Chain(
        "chart",
        ("femcheck", "chart", "{small}", "--family", "raster", "--family", "beam"),
        6,
        apart=("chart.svg", "chart.png", "reading.md", "cheapest.csv"),
    ),
    Chain("map", ("femcheck", "stability", "--axis", "tube"), 6),
)
"""Every command that writes a folder, but for a search."""


def checks(full: bool) -> list[Check]:
    scene = ["optimize", "hand-drawn-section", "--seed", "7"]
    generations = "100" if full else "10"
    search = [*scene, "--set", f"search.generations={generations}"]

    def after_kills(chain: Chain) -> Check:
        def rows() -> Iterator[Row]:
            done, wrong = chain.survive(seed=2)
            source = "SIGKILL at random moments"
            what = f"{chain.name}: files that differ from an undisturbed run's, after {done} kills"
            yield Row(what, source, 0, wrong, 0)

        return Check(chain.name, rows)

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
        lambda: after_kills(Chain("search", tuple(search), 24 if full else 3)),
        lambda: same_for("search", search, (1, 2, 3) if full else (1, 2)),
    ]
    if full:
        made += [partial(after_kills, chain) for chain in CHAINS]
        made.append(lambda: same_for("study", list(STUDY), (1, 2)))
    return [make() for make in made]
