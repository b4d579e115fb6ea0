"""Progress on the terminal, with losses and time left."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from beamopt.base.provenance import thread_settings

__all__ = ["console", "counted", "progress_bar", "say_workers", "work_progress"]

EVERY = 10.0  # s between two lines where there is no terminal

console = Console(highlight=False)


def say_workers(workers: int) -> None:
    """Print how many tasks are worked on at once, and the threads of each."""
    threads = " ".join(f"{key}={value}" for key, value in thread_settings().items())
    console.print(f"{workers} at once, {threads}", soft_wrap=True)


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


@contextmanager
def counted(
    unit: str, title: str, total: int | None = None, *, said: str = "starting", lines: int = 0
) -> Iterator[Callable[[int, int, str], None]]:
    """A function to call with the number of `unit`s that are done, of all of them, and a text.

    It moves a bar on a terminal; elsewhere it prints so many lines with the time that is left.
    """
    started, first = time.perf_counter(), 0
    with progress_bar(unit) as bar:
        task = bar.add_task(escape(title), total=total, said=said)

        def show(done: int, total: int, said: str) -> None:
            nonlocal first
            first = first or done - 1
            bar.update(task, completed=done, total=total, said=escape(said))
            if lines and bar.disable and done * lines // total > (done - 1) * lines // total:
                left = (time.perf_counter() - started) / (done - first) * (total - done)
                console.print(f"{done:,} of {total:,} {unit}, {left / 60:.1f} min left")

        yield show


@contextmanager
def work_progress() -> Iterator[Callable[[str, float], None]]:
    """A function to call with the part of some work and the share of it that is spent.

    It shows the time since the part began, and how much may be left, on standard error: on a
    terminal in one line that leaves nothing behind, elsewhere in a line every ten seconds.
    """
    terminal = Console(stderr=True, highlight=False)
    status = terminal.status("…") if terminal.is_terminal else None
    began: dict[str, float] = {}
    last = time.monotonic()

    def show(part: str, share: float) -> None:
        nonlocal last
        now = time.monotonic()
        seconds = now - began.setdefault(part, now)
        left = f", at most {seconds * (1 - share) / share:.0f} s left" if share > 0 else ""
        said = f"{part}: {seconds:.0f} s{left}"
        if status is not None:
            status.update(said)
        elif now - last >= EVERY:
            last = now
            terminal.print(said, soft_wrap=True, markup=False)

    with status or nullcontext():
        yield show
