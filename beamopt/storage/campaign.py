"""A command that can be resumed: its folder and journal, and its tasks on any executor."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from beamopt.base.processes import in_process, processes
from beamopt.base.tasks import Key, Result, Tasks, Work, check_none_lost, solve_all
from beamopt.storage.line_journal import LineJournal
from beamopt.storage.result_folder import FolderKind, claimed

__all__ = ["Campaign", "Pool", "Progress", "claimed_journal"]

Progress = Callable[[int, int, str], None]
"""Called with the number of tasks that are done, of all tasks, and a text on the last one."""

Pool = Callable[[int], AbstractContextManager[Executor]]
"""Makes an executor of a number of workers."""


@contextmanager
def claimed_journal(
    folder: Path, kind: FolderKind, asked: dict[str, Any], subject: str, *, resume: bool
) -> Iterator[LineJournal]:
    """Claim a folder whose marker is a journal, and open that.

    asked, subject : what the results depend on, and what they are of; see `LineJournal`.

    Raises
    ------
    InputError : see `claimed` and `LineJournal`.
    """
    with claimed(folder, kind, resume=resume):
        yield LineJournal(folder / kind.marker, asked, subject)


@dataclass(frozen=True, slots=True)
class Campaign:
    """Tasks on an executor.

    workers : tasks at once; no result depends on it.
    pool : makes the executor; None stays in this process where there is one worker only.
    """

    workers: int = 1
    pool: Pool | None = None
    progress: Progress | None = None

    def solve(
        self,
        work: Work[Key, Result],
        store: Callable[[Key, Result], None],
        text: Callable[[Key, Result], str] | None = None,
    ) -> None:
        """Do the tasks that have no result yet.

        store : is called with every result as it comes, in any order.
        text : of a result, for `progress`.
        """

        def finish(key: Key, result: Result) -> None:
            store(key, result)
            if text is not None:
                self._report(work, text(key, result))

        if text is not None:
            self._report(work, "starting")
        pool = self.pool or (processes if self.workers > 1 else in_process)
        solve_all(work, partial(pool, self.workers), self.workers, finish)

    def solve_every(
        self, work: Tasks[Key, Result], store: Callable[[Key, Result], None], way_out: str
    ) -> None:
        """Do all tasks; complain in the end of those that their process died of.

        Raises
        ------
        NotComputedError : see `check_none_lost`, also for `way_out`.
        """

        def store_found(key: Key, result: Result | None) -> None:
            if result is not None:
                store(key, result)

        self.solve(work, store_found)
        check_none_lost(work, way_out)

    def _report(self, work: Work[Key, Result], text: str) -> None:
        if self.progress is not None:
            keys = set(work.keys)
            self.progress(len(keys & work.results.keys()), len(keys), text)
