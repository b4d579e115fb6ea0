"""Progress on the terminal, with losses and time left."""

from __future__ import annotations

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

__all__ = ["console", "progress_bar"]

console = Console(highlight=False)


def progress_bar(unit: str) -> Progress:
    """A bar that counts `unit`s, to standard error; it leaves nothing behind."""
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(bar_width=None),
        MofNCompleteColumn(),
        TextColumn(unit),
        TimeRemainingColumn(compact=True),
        TextColumn("{task.fields[said]}"),
        console=Console(stderr=True, highlight=False),
        transient=True,
    )
