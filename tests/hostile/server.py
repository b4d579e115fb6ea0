"""Commands run one after another, each in a fork of a process that has loaded everything.

Reads a case a line, writes a result a line, both JSON. A fork takes a tenth of a second, a process
of its own two.
"""

from __future__ import annotations

import importlib
import json
import os
import pkgutil
import resource
import signal
import sys
import tempfile
import time
import traceback
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

CPU_SECONDS = 10
"""Processor time that a command may take: the machine's other work must not matter."""
PATIENCE = 60.0
"""Seconds of the clock after which a line hangs: it waits for something that never comes."""
ENDS = ("stdout", "stderr", "code")
MEMORY = 2 * 2**30
"""Bytes of a command's largest resident set (`ru_maxrss`), which its mapped libraries belong to."""


def main() -> None:
    """Load the commands, then run cases until there are no more."""
    protocol = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    for package in ("beamopt", "femcheck"):
        path = importlib.import_module(package).__path__
        for module in pkgutil.walk_packages(path, f"{package}."):
            importlib.import_module(module.name)
    warm_up()
    for line in sys.stdin:
        protocol.write(json.dumps(run_case(json.loads(line))) + "\n")
        protocol.flush()


def warm_up() -> None:
    """Load, and compile, what forks would load or compile again and again."""
    from beamopt.cli.application import run as beamopt
    from beamopt.scene.bundled import bundled_scenes
    from femcheck.cli.application import run as femcheck

    design = str(bundled_scenes()["hand-drawn-section"].with_name("hand_drawn_section.json"))
    tiny = [f"--set={key}" for key in ("search.generations=0", "search.population=2")]
    check = str(Path(__file__).resolve().parents[2] / "reports" / "check")
    with tempfile.TemporaryDirectory() as folder, redirect_stdout(sys.stderr):
        out = Path(folder)
        beamopt(["optimize", "random-section", "--out", f"{out}/run", *tiny])
        beamopt(["show", design, "--out", f"{out}/shown.svg"])
        beamopt(["bound", design, "--work", "0.001"])
        femcheck(["report", check, f"{out}/run", "--out", f"{out}/report.html"])


def run_case(case: dict[str, Any]) -> dict[str, Any]:
    """Fork, run all command lines of a case, and say how each ended.

    A line's `code` is None where it did not end: it hung, or a limit ended the process.
    """
    place, lines = Path(case["place"]), case["lines"]
    child = os.fork()
    if child == 0:
        try:
            os.environ.update(case.get("environment", {}))
            for number, (folder, line) in enumerate(zip(case["folders"], lines, strict=True)):
                os.chdir(folder)
                code = _code_of(case, place, number, line)
                (place / f"{number}.code").write_text(str(code))
        finally:
            os._exit(0)
    patience, hung, ended_lines = time.monotonic() + PATIENCE, False, 0
    while True:
        done, _, used = os.wait4(child, os.WNOHANG)
        if done:
            break
        if (place / f"{ended_lines}.code").exists():
            patience, ended_lines = time.monotonic() + PATIENCE, ended_lines + 1
        if time.monotonic() > patience:
            hung = True
            os.kill(child, signal.SIGKILL)
        time.sleep(0.002)
    texts = [
        {end: _text(place / f"{number}.{end}") for end in ENDS} for number in range(len(lines))
    ]
    ended = [{**one, "code": int(one["code"]) if one["code"] else None} for one in texts]
    return {"hung": hung, "memory": used.ru_maxrss * 1024, "lines": ended}


def _text(path: Path) -> str:
    return path.read_text(errors="backslashreplace") if path.exists() else ""


def _code_of(case: dict[str, Any], place: Path, number: int, line: list[str]) -> int:
    """Run one command line as a process of its own would; its exit code."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    limit = int(used.ru_utime + used.ru_stime) + CPU_SECONDS
    resource.setrlimit(resource.RLIMIT_CPU, (limit, resource.RLIM_INFINITY))
    try:
        _open_streams(case, [place / f"{number}.{end}" for end in ("stdout", "stderr")])
        program, *sys.argv[1:] = line
        sys.argv[0] = program
        importlib.import_module(f"{program}.cli").main()
    except SystemExit as error:
        code = error.code if isinstance(error.code, int) else 1
    except BaseException:
        traceback.print_exc()
        code = 70
    else:
        code = 71  # `main` never returns
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (OSError, AttributeError):
            code = code or 120  # what an interpreter says that can not flush
    return code


def _open_streams(case: dict[str, Any], outputs: list[Path]) -> None:
    """Standard output and error as the case has them: files, closed, or others by name."""
    if "file_size" in case:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (case["file_size"],) * 2)
    for number, path in zip((1, 2), outputs, strict=True):
        wanted = case.get("streams", {}).get(str(number), str(path))
        name = ("stdout", "stderr")[number - 1]
        if wanted == "closed":
            os.close(number)
            setattr(sys, name, None)
            continue
        if wanted == "pipe":  # that nobody reads
            reader, writer = os.pipe()
            os.dup2(writer, number)
            os.close(reader)
            os.close(writer)
        else:
            opened = os.open(wanted, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644)
            os.dup2(opened, number)
            os.close(opened)
        encoding = case.get("encoding", "utf-8")
        stream = open(number, "w", encoding=encoding, closefd=False)  # noqa: SIM115
        setattr(sys, name, stream)


if __name__ == "__main__":
    main()
