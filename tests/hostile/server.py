"""Commands run one after another, each in a fork of a process that has loaded everything.

Reads a case a line, writes a result a line, both JSON. A fork takes a tenth of a second, a process of
its own two.
"""

from __future__ import annotations

import importlib
import json
import os
import pkgutil
import resource
import signal
import sys
import time
import traceback
from pathlib import Path
from typing import Any

CPU_SECONDS = 10
"""Processor time that a command may take: the machine's other work must not matter."""
PATIENCE = 60.0
"""Seconds of the clock after which a command hangs: it waits for something that never comes."""
MEMORY = 2 * 2**30
"""Bytes of a command's largest resident set (`ru_maxrss`), which its mapped libraries belong to."""


def main() -> None:
    """Load the commands, then run cases until there are no more."""
    protocol = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    for package in ("beamopt.cli", "femcheck.cli"):
        for module in pkgutil.iter_modules(importlib.import_module(package).__path__):
            importlib.import_module(f"{package}.{module.name}")
    warm_up()
    for line in sys.stdin:
        protocol.write(json.dumps(run_case(json.loads(line))) + "\n")
        protocol.flush()


def warm_up() -> None:
    """Load kernels and libraries that forks would load again and again."""
    import matplotlib.figure
    import meshio
    import scipy.spatial  # noqa: F401

    from beamopt.bundled import bundled_scenes
    from beamopt.design import load_design
    from beamopt.plot.figures import design_figure
    from beamopt.plot.style import figure_bytes

    file = bundled_scenes()["hand-drawn-section"].with_name("hand_drawn_section.json")
    figure_bytes(design_figure(load_design(file)), "svg", "png")
    assert matplotlib.figure
    assert meshio


def run_case(case: dict[str, Any]) -> dict[str, Any]:
    """Fork, run, and say how it ended: exit code or signal, texts, processor time, memory."""
    place = Path(case["place"])
    outputs = [place / "stdout", place / "stderr"]
    child = os.fork()
    if child == 0:
        try:
            _prepare(case, outputs)
            _run(case)
        except SystemExit as error:
            _leave(error.code if isinstance(error.code, int) else 1)
        except BaseException:
            traceback.print_exc()
            _leave(70)
        _leave(71)
    patience, hung = time.monotonic() + PATIENCE, False
    while True:
        done, status, used = os.wait4(child, os.WNOHANG)
        if done:
            break
        if time.monotonic() > patience:
            hung = True
            os.kill(child, signal.SIGKILL)
        time.sleep(0.002)
    return {
        "code": os.waitstatus_to_exitcode(status),
        "hung": hung,
        "cpu": used.ru_utime + used.ru_stime,
        "memory": used.ru_maxrss * 1024,
        **{
            path.name: path.read_text(errors="backslashreplace") if path.exists() else ""
            for path in outputs
        },
    }


def _prepare(case: dict[str, Any], outputs: list[Path]) -> None:
    """The streams, the limits and the folder of a fresh process."""
    os.chdir(case["folder"])
    os.environ.update(case.get("environment", {}))
    resource.setrlimit(resource.RLIMIT_CPU, (CPU_SECONDS, CPU_SECONDS + 1))
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
            opened = os.open(wanted, os.O_WRONLY | os.O_CREAT, 0o644)
            os.dup2(opened, number)
            os.close(opened)
        encoding = case.get("encoding", "utf-8")
        stream = open(number, "w", encoding=encoding, closefd=False)  # noqa: SIM115
        setattr(sys, name, stream)


def _run(case: dict[str, Any]) -> None:
    program = importlib.import_module(f"{case['program']}.cli")
    sys.argv = [case["program"], *case["arguments"]]
    program.main()


def _leave(code: int) -> None:
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (OSError, AttributeError):
            code = code or 120  # what an interpreter says that can not flush
    os._exit(code)


if __name__ == "__main__":
    main()
