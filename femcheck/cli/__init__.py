"""The command line: `femcheck run`."""

from __future__ import annotations

__all__ = ["main"]


def main() -> None:
    """Run the command line; bad input is one line on standard error and exit code 2."""
    from beamopt.cli import start

    start("femcheck")
