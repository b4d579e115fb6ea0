"""The command line: `beamopt optimize`, `study`, `tips`, `show`, `scenes`, `init`."""

from __future__ import annotations

import io
import os
import sys
from importlib import import_module
from typing import NoReturn

__all__ = ["main", "prepare", "start"]


def prepare() -> None:
    """Pin threads before numpy is loaded, let any terminal take any text, and heed signals."""
    from beamopt.base.provenance import THREAD_SETTINGS
    from beamopt.cli.signals import heed_signals

    for name in THREAD_SETTINGS:  # small matrices gain nothing from threads
        os.environ.setdefault(name, "1")
    _open_closed_streams()
    for stream in (sys.stdout, sys.stderr):  # a terminal that has no "²" still gets an answer
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
    heed_signals()


def _open_closed_streams() -> None:
    """Let what is written to a closed stream go nowhere, and no file open in its place."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # gets the lowest number that is free
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: PTH123, SIM115


def start(program: str) -> NoReturn:
    """Run the command line of a program with the process's arguments; ends the process."""
    try:
        prepare()
        code = import_module(f"{program}.cli.application").run(sys.argv[1:])
    except KeyboardInterrupt:  # while it loads
        from beamopt.cli.signals import exit_code, name_of_end

        print(f"{program}: {name_of_end()}", file=sys.stderr)
        code = exit_code()
    try:
        sys.stdout.flush()
    except OSError:  # said by `run`; the interpreter is not to try, and complain, again
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    sys.exit(code)


def main() -> None:
    """Run the command line; bad input is one line on standard error and exit code 2."""
    start("beamopt")
