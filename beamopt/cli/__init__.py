"""The command line: `beamopt optimize`, `study`, `tips`, `show`, `scenes`, `init`."""

from __future__ import annotations

import io
import os
import sys

__all__ = ["main", "prepare"]


def prepare() -> None:
    """Pin threads before numpy is loaded, and let any terminal take any text."""
    from beamopt.provenance import THREAD_SETTINGS

    for name in THREAD_SETTINGS:  # small matrices gain nothing from threads
        os.environ.setdefault(name, "1")
    for stream in (sys.stdout, sys.stderr):  # a terminal that has no "²" still gets an answer
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")


def main() -> None:
    """Run the command line; bad input is one line on standard error and exit code 2."""
    prepare()
    from beamopt.cli.application import run

    sys.exit(run(sys.argv[1:]))
