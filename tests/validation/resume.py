"""Killed at any instant, a run goes on and ends in the same bytes; workers change nothing."""

from __future__ import annotations

import contextlib
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
PROGRAMS = ("beamopt", "femcheck")
SIGNALS = (signal.SIGKILL, signal.SIGKILL, signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
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


def as_in_a_terminal() -> None:
    """Heed Ctrl-C, which what a shell starts in the background ignores, as do its children."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def killed(arguments: Sequence[str], after: float, temporary: Path, number: int) -> bool:
    """Run and send a signal after some seconds; whether it ended the command."""
    with subprocess.Popen(
        command(*arguments),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"TMPDIR": str(temporary)},
        preexec_fn=as_in_a_terminal,
    ) as process:
        try:
            _, said = process.communicate(timeout=after)
        except subprocess.TimeoutExpired:
            os.kill(process.pid, number)
            _, said = process.communicate()
            if process.returncode not in ENDED:
                out = Path(arguments[arguments.index("--out") + 1])
                _check_ended(process.returncode, number, said, out)
                return True
    assert process.returncode in ENDED, said
    return False


def _check_ended(code: int, number: int, said: str, out: Path) -> None:
    """One line and the exit code of shells; none where all was written, and Python was ending."""
    if number == signal.SIGKILL:
        assert code == -number
        return
    if code == -number:
        assert (out / "provenance.json").exists(), said
        return
    lines = [line for line in said.splitlines() if line.partition(": ")[0] in PROGRAMS]
    assert code == 128 + number, said
    assert len(lines) == 1, said
    assert "Traceback" not in said, said


def kill_a_worker(arguments: Sequence[str], after: float) -> bool:
    """Run to the end, and send SIGKILL to one of its processes; whether there was one."""
    with subprocess.Popen(
        command(*arguments), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    ) as process:
        time.sleep(after)
        workers = _workers_of(process.pid)
        for number in workers[:1]:
            with contextlib.suppress(ProcessLookupError):
                os.kill(number, signal.SIGKILL)
        _, said = process.communicate()
    assert process.returncode in ENDED, said
    assert "Traceback" not in said, said
    return bool(workers)


def _workers_of(process: int) -> list[int]:
    """Processes that a process has spawned to work for it."""
    found = []
    for number in Path(f"/proc/{process}/task/{process}/children").read_text().split():
        with contextlib.suppress(OSError):
            if b"spawn_main" in Path(f"/proc/{number}/cmdline").read_bytes():
                found.append(int(number))
    return found


@dataclass(frozen=True)
class Chain:
    """A command that is killed, gone on with, and killed again.

    arguments : without `--out`; {small} stands for the file of a small sealed design.
    goes_on : whether it has `--resume`; others begin again in the same folder.
    apart : files that hold times besides those that always do.
    processes : whether it has workers that are processes.
    """

    name: str
    arguments: tuple[str, ...]
    kills: int
    goes_on: bool = True
    apart: tuple[str, ...] = ()
    processes: bool = False

    def survive(self, seed: int) -> Iterator[Row]:
        """Kill it so many times, over as many folders as that takes; then one of its processes.

        Rows count the files that differ from an undisturbed run's, or that are left in the
        temporary folder.
        """
        from tests.femcheck.check.small import design_of, three_circles  # which loads femcheck

        rng = random.Random(seed)
        with tempfile.TemporaryDirectory() as name:
            root = Path(name)
            small, temporary = root / "small.json", root / "temporary"
            design_of(three_circles()).save(small)
            temporary.mkdir()
            arguments = [part.format(small=small) for part in self.arguments]
            whole = root / "whole"
            seconds = run([*arguments, "--out", str(whole)])
            done = wrong = folder = 0
            while done < self.kills:
                folder += 1
                there = root / f"killed-{folder}"
                again = [*arguments, "--out", str(there), *(["--resume"] if self.goes_on else [])]
                while done < self.kills and killed(
                    again, rng.uniform(0.1, 1.1) * seconds, temporary, rng.choice(SIGNALS)
                ):
                    done += 1
                if done == self.kills:  # the last one goes on to its end, whatever that takes
                    run(again)
                wrong += len(differing(whole, there, self.apart))
                wrong += len(list(temporary.glob("beamopt-*")))
            what = f"{self.name}: files that differ from an undisturbed run's, after {done} kills"
            yield Row(what, "signals at random moments", 0, wrong, 0)
            if not self.processes:
                return
            there, tried = root / "lost-0", 0
            while not kill_a_worker(
                [*arguments, "--out", str(there)], rng.uniform(0.2, 0.9) * seconds
            ):
                tried += 1
                there = root / f"lost-{tried}"
            what = f"{self.name}: files that differ after one of its processes was killed"
            yield Row(what, "SIGKILL", 0, len(differing(whole, there, self.apart)), 0)


SOLID = ("--layers", "2", "--size", "9")
SILICONE = ("--law", "neo-hookean", "--nu", "0.4")
STUDY = ("study", "--iterations", "1", "--set", "search.generations=4")
FRONT = ("pareto", "random-section", "--objectives", "L,mass", "--population", "24")
CHAINS = (
    Chain("study", (*STUDY, "--workers", "2"), 3, processes=True),
    Chain("front", (*FRONT, "--generations", "30"), 5),
    Chain("bound", ("bound", "hand-drawn-workspace"), 4, goes_on=False),
    Chain("export", ("export", "{small}"), 5, goes_on=False),
    Chain(
        "chart of rods",
        ("chart", "gravity"),
        2,
        goes_on=False,
        apart=("chart.csv", "chart.svg", "chart.png"),  # a clock ends its methods
    ),
    Chain(
        "map of rods",
        ("stability", "--samples", "4", "--workers", "2"),
        2,
        apart=(
            "reading.md",
            *(
                f"{figure}.{end}"
                for figure in ("stability", "slenderness")
                for end in ("svg", "png")
            ),
        ),
        processes=True,
    ),
    Chain("check", ("femcheck", "run", "{small}", "--element", "tet4", *SOLID), 5, processes=True),
    Chain(
        "prediction",
        ("femcheck", "run", "{small}", "--law", "neo-hookean", *SOLID),
        5,
        processes=True,
    ),
    Chain(
        "accuracy",
        ("femcheck", "run", "{small}", *SILICONE, "--accuracy", "5mm"),
        2,
    ),
    Chain(
        "baseline", ("femcheck", "baseline", "{small}", "--force"), 3, goes_on=False, processes=True
    ),
    Chain(
        "chart",
        ("femcheck", "chart", "{small}", "--family", "raster", "--family", "beam"),
        4,
        apart=("chart.svg", "chart.png", "reading.md", "cheapest.csv"),
        processes=True,
    ),
    Chain("map", ("femcheck", "stability", "--axis", "tube"), 2),
)
"""Every command that writes a folder, but for a search.

Processes of the longest two are killed in `tests/hostile/test_killed_workers.py` only.
"""


def checks(full: bool) -> list[Check]:
    scene = ["optimize", "hand-drawn-section", "--seed", "7"]
    generations = "100" if full else "10"
    search = [*scene, "--set", f"search.generations={generations}"]

    def after_kills(chain: Chain) -> Check:
        return Check(chain.name, lambda: chain.survive(seed=2))

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
