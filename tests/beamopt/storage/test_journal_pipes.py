"""A journal that is a pipe is refused at once: opening it would wait for a writer."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from beamopt.base.errors import InputError
from beamopt.search.journal import SearchJournal
from beamopt.storage.line_journal import LineJournal


def test_a_journal_that_is_a_pipe_is_refused(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "journal.jsonl")
    with pytest.raises(InputError):
        SearchJournal(tmp_path / "journal.jsonl")
    with pytest.raises(InputError):
        LineJournal(tmp_path / "journal.jsonl", {"a": 1}, "chart")
