"""The command line: `femcheck run`."""

from __future__ import annotations

__all__ = ["main"]


def main() -> None:
    """Run the command line; bad input is one line on standard error and exit code 2."""
    from beamopt.cli import prepare, run_and_leave

    prepare()
    from femcheck.cli.application import run

    run_and_leave(run)
