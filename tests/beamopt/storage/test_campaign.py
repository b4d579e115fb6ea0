"""Tasks of a command that can be resumed: what is stored and reported, and in which order."""

from collections.abc import Iterator
from concurrent.futures import BrokenExecutor, Executor, Future
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from beamopt.base.errors import InputError, NotComputedError
from beamopt.base.processes import InProcess
from beamopt.base.tasks import Tasks
from beamopt.storage.campaign import Campaign, claimed_journal
from beamopt.storage.result_folder import FolderKind, check_same, claimed

KIND = FolderKind("a test", "journal.jsonl", ('{"schema":"test/',), files=("a.csv", "front-*.json"))
DEADLY = 2
ASKED = {"schema": "test/1", "grid": {"size": 3}}


class Dying(InProcess):
    """An executor that breaks under one task."""

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        if args[0] == DEADLY:
            raise BrokenExecutor
        return super().submit(fn, *args, **kwargs)


def squares(known: dict[int, int | None]) -> Tasks[int, int]:
    return Tasks(pow, {number: (number, 2) for number in range(4)}, known)


def test_what_is_known_is_not_done_again_and_a_report_follows_what_is_stored() -> None:
    """Results of other tasks do not count as done."""
    seen: list[tuple[object, ...]] = []
    campaign = Campaign(progress=lambda done, total, text: seen.append((done, total, text)))
    work = squares({1: 1, 17: 289})
    campaign.solve(work, lambda key, result: seen.append((key, result)), lambda key, _: f"of {key}")
    assert seen == [
        (1, 4, "starting"),
        *((0, 0), (2, 4, "of 0")),
        *((2, 4), (3, 4, "of 2")),
        *((3, 9), (4, 4, "of 3")),
    ]


def test_a_task_without_a_result_is_not_stored_and_named_in_the_end() -> None:
    @contextmanager
    def pool(workers: int) -> Iterator[Executor]:
        yield Dying()

    stored: dict[int, int] = {}
    with pytest.raises(NotComputedError) as raised:
        Campaign(2, pool).solve_every(squares({}), stored.__setitem__, "a way out")
    assert raised.value.what == str(DEADLY)
    assert stored == {0: 0, 1: 1, 3: 9}


def test_a_claim_deletes_what_a_kill_left_of_the_files_of_its_kind(tmp_path: Path) -> None:
    with claimed_journal(tmp_path, KIND, ASKED, "test", resume=False) as journal:
        journal.add({"done": 1})
    mine = [".journal.jsonl.11.tmp", ".a.csv.12.tmp", ".front-007.json.13.tmp"]
    others = [".b.csv.14.tmp", "a.csv", ".notes"]
    for name in (*mine, *others):
        (tmp_path / name).write_text("")
    with claimed_journal(tmp_path, KIND, ASKED, "test", resume=True) as journal:
        assert journal.entries == [{"done": 1}]
        assert {one.name for one in tmp_path.iterdir()} - {".beamopt.lock"} == {
            *others,
            "journal.jsonl",
        }


def test_a_marker_that_is_a_pattern_names_no_leftovers(tmp_path: Path) -> None:
    """Of files that many commands write only those that a command names itself are deleted."""
    (tmp_path / "one.json").write_text('{"schema":"test/1"}')
    (tmp_path / ".two.json.11.tmp").write_text("")
    with claimed(tmp_path, FolderKind("baselines", "*.json", ('{"schema":"test/',)), resume=True):
        assert (tmp_path / ".two.json.11.tmp").exists()


def test_other_settings_are_refused_by_their_first_key(tmp_path: Path) -> None:
    now = {"schema": "test/1", "grid": {"size": 4}, "seed": 1}
    with pytest.raises(InputError) as raised:
        check_same(tmp_path / "asked", ASKED, now, "test")
    assert (raised.value.key, raised.value.value) == ("grid.size", 3)
    check_same(tmp_path / "asked", ASKED, now, "test", free={"grid.size", "seed"})
