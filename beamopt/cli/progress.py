"""Progress on the terminal, with losses and time left."""

from __future__ import annotations

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

__all__ = ["console", "progress_bar"]

console = Console(highlight=False)


def progress_bar(unit: str) -> Progress:
    """A bar that counts `unit`s on the terminal's standard error; it leaves nothing behind."""
    terminal = Console(stderr=True, highlight=False)
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(bar_width=None),
        MofNCompleteColumn(),
        TextColumn(unit),
        TimeRemainingColumn(compact=True),
        TextColumn("{task.fields[said]}"),
        console=terminal,
        disable=not terminal.is_terminal,
        transient=True,
    )
