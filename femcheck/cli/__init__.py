"""The command line: `femcheck run`."""

from __future__ import annotations

import signal
import sys

__all__ = ["main"]


def _end(number: int, _frame: object) -> None:
    """Leave as by Ctrl-C, so that gmsh and the workers are taken along."""
    sys.exit(128 + number)


def main() -> None:
    """Run the command line; bad input is one line on standard error and exit code 2."""
    from beamopt.cli import prepare

    prepare()
    signal.signal(signal.SIGTERM, _end)
    from femcheck.cli.application import run

    sys.exit(run(sys.argv[1:]))
