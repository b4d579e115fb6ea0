"""Signals that ask a command to end: one line, an exit code, a folder that goes on."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from beamopt.cli.application import run
from tests.hostile.programs import MAIN

PATIENCE = 60.0  # s
SIGNALS = {
    signal.SIGINT: ("interrupted", 130),
    signal.SIGTERM: ("terminated", 143),
    signal.SIGHUP: ("hung up", 129),
}


def _as_in_a_terminal() -> None:
    """What a shell starts in the background ignores Ctrl-C, and so do all that it starts."""
    for number in SIGNALS:
        signal.signal(number, signal.SIG_DFL)


def ended(
    program: str, arguments: list[str], began: Callable[[], bool], number: int, *, group: bool
) -> tuple[int, str, str]:
    """Run a command, send it a signal once it has begun; returns exit code, output and errors.

    group : whether its workers get the signal too, as all that a terminal runs does.
    """
    with subprocess.Popen(
        [sys.executable, "-c", MAIN[program], *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=_as_in_a_terminal,
    ) as process:
        try:
            patience = time.monotonic() + PATIENCE
            while not began():
                assert process.poll() is None, process.communicate()
                assert time.monotonic() < patience
                time.sleep(0.02)
            (os.killpg if group else os.kill)(process.pid, number)
            said, wrong = process.communicate(timeout=PATIENCE)
        finally:
            process.kill()
    assert not _left(process.pid)
    lines = wrong.splitlines(keepends=True)  # findings about the design are no complaints
    return process.returncode, said, "".join(one for one in lines if not one.startswith("note: "))


def _left(session: int) -> bool:
    """Whether anything of a session is running a second after its first process has ended."""
    patience = time.monotonic() + 5.0
    while time.monotonic() < patience:
        try:
            os.killpg(session, 0)
        except ProcessLookupError:
            return False
        time.sleep(0.05)
    return True


@pytest.mark.parametrize("number", SIGNALS)
def test_a_search(number: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    journal = tmp_path / "run" / "journal.jsonl"
    arguments = ["optimize", "random-section", "--out", "run"]
    code, said, wrong = ended(
        "beamopt",
        [*arguments, "--set", "search.generations=100000"],
        lambda: journal.exists() and journal.stat().st_size > 5_000,
        number,
        group=False,
    )
    word, expected = SIGNALS[signal.Signals(number)]
    assert (code, wrong) == (expected, f"beamopt: {word}\n")
    assert "--resume" in said
    done = json.loads((tmp_path / "run" / "summary.json").read_text())["generations"]
    more = ["--resume", "--set", f"search.generations={done + 1}"]
    assert run([*arguments, *more]) == 0
    summary = json.loads((tmp_path / "run" / "summary.json").read_text())
    assert summary["generations"] == done + 1


STUDY = [
    *("study", "--out", "out", "--workers", "2", "--iterations", "1", "--no-refine"),
    *("--target", "random-section", "--set", "search.generations=20"),
]


@pytest.mark.parametrize(
    ("number", "group"), [(signal.SIGINT, True), (signal.SIGTERM, False), (signal.SIGHUP, True)]
)
def test_a_study_with_workers(
    number: int, group: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ctrl-C finishes the searches under way; other signals end the workers too."""
    monkeypatch.chdir(tmp_path)
    out = tmp_path / "out"

    def began() -> bool:
        return any(one.stat().st_size > 500 for one in out.rglob("journal.jsonl"))

    code, _, wrong = ended("beamopt", STUDY, began, number, group=group)
    word, expected = SIGNALS[signal.Signals(number)]
    assert (code, wrong) == (expected, f"beamopt: {word}\n")
    assert not (out / "table.csv").exists()
    assert run([*STUDY, "--resume"]) == 0
    assert (out / "table.csv").exists()
