"""Claims of folders: whose a folder is, one writer at a time, and what a kill leaves."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest

from beamopt.base.errors import InputError
from beamopt.storage.file_lock import HeldElsewhereError, locked
from beamopt.storage.result_folder import LOCK, FolderKind, claimed, clear_leftovers, own_subfolder
from beamopt.storage.scratch import clear_scratch, scratch_folder

KIND = FolderKind("a test", "marker.json", ('{"schema":"test/',))
AT_ONCE = FolderKind("a chart", "provenance.json", ("{",), goes_on=False)

CLAIM = """
import sys, time
from pathlib import Path
from tests.beamopt.storage.test_result_folder import AT_ONCE, KIND, claimed
from beamopt.storage.scratch import scratch_folder
kind = KIND if sys.argv[2] == "KIND" else AT_ONCE
with claimed(Path(sys.argv[1]), kind, resume=True), scratch_folder() as scratch:
    for name in sys.argv[3:]:
        (Path(sys.argv[1]) / name).write_text("half")
    print(scratch, flush=True)
    time.sleep(60)
"""


@pytest.fixture(autouse=True)
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("beamopt.storage.file_lock.PATIENCE", 0.3)


def names(folder: Path) -> set[str]:
    return {item.name for item in folder.iterdir()}


def claim_and_begin(folder: Path, *, resume: bool = False) -> None:
    with claimed(folder, KIND, resume=resume):
        assert LOCK in names(folder)
        (folder / "marker.json").write_text('{"schema": "test/1"}')


def begun(folder: Path, *arguments: str) -> tuple[subprocess.Popen[str], Path]:
    """A process that holds a folder, and its temporary folder."""
    process = subprocess.Popen(
        [sys.executable, "-c", CLAIM, str(folder), *arguments], stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    return process, Path(process.stdout.readline().strip())


def killed(folder: Path, *arguments: str) -> Path:
    """Leave a folder as a kill leaves it; returns the temporary folder of the killed process."""
    process, scratch = begun(folder, *arguments)
    with process:
        os.kill(process.pid, signal.SIGKILL)
    return scratch


def test_a_folder_is_made_and_left_without_a_lock(tmp_path: Path) -> None:
    claim_and_begin(tmp_path / "a" / "b")
    assert names(tmp_path / "a" / "b") == {"marker.json"}
    claim_and_begin(tmp_path / "a" / "b", resume=True)
    with pytest.raises(InputError, match="--resume"):
        claim_and_begin(tmp_path / "a" / "b")


@pytest.mark.parametrize("content", ['{"schema": "other/1"}', '{"schema": "tess', "mine", "{}\n"])
@pytest.mark.parametrize("resume", [False, True])
def test_a_marker_of_another_is_none(tmp_path: Path, content: str, *, resume: bool) -> None:
    (tmp_path / "marker.json").write_text(content)
    with pytest.raises(InputError, match="holds files") as caught:
        claim_and_begin(tmp_path, resume=resume)
    assert caught.value.where == str(tmp_path)
    assert names(tmp_path) == {"marker.json"}
    assert (tmp_path / "marker.json").read_text() == content


@pytest.mark.parametrize("length", range(21))
def test_the_beginning_of_a_marker_is_enough(tmp_path: Path, length: int) -> None:
    (tmp_path / "marker.json").write_text('{"schema": "test/1"}'[:length])
    claim_and_begin(tmp_path, resume=True)


@pytest.mark.parametrize("kind", [KIND, AT_ONCE])
def test_a_foreign_folder_is_left_as_it_is(tmp_path: Path, kind: FolderKind) -> None:
    """Also one with files under names that the command writes, and one with another's lock."""
    (tmp_path / "table.csv").write_text("mine")
    (tmp_path / ".table.csv.1.tmp").write_text("mine, too")
    for lock in (None, "another command"):
        if lock is not None:
            (tmp_path / LOCK).write_text(lock)
        before = {item: item.read_bytes() for item in tmp_path.iterdir()}
        with (
            pytest.raises(InputError, match="nothing to go on with"),
            claimed(tmp_path, kind, resume=True),
        ):
            raise AssertionError
        assert {item: item.read_bytes() for item in tmp_path.iterdir()} == before


@pytest.mark.parametrize("name", ["marker.json", "table.csv", "cases", LOCK])
@pytest.mark.parametrize("there", [True, False], ids=["link", "dangling"])
def test_a_link_in_a_folder_is_refused(tmp_path: Path, name: str, *, there: bool) -> None:
    folder, other = tmp_path / "folder", tmp_path / "other"
    claim_and_begin(folder)
    (folder / name).unlink(missing_ok=True)
    if there:
        other.write_text('{"schema": "test/1"}')
    (folder / name).symlink_to(other)
    with pytest.raises(InputError, match="is a link"):
        claim_and_begin(folder, resume=True)
    assert (folder / name).is_symlink()
    assert other.exists() is there


def test_a_subfolder_that_is_a_link_is_refused(tmp_path: Path) -> None:
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / ".a.vtu.1.tmp").write_text("somebody's")
    (tmp_path / "cases").symlink_to(tmp_path / "other")
    with pytest.raises(InputError, match="is a link"):
        own_subfolder(tmp_path / "cases")
    assert names(tmp_path / "other") == {".a.vtu.1.tmp"}


def test_the_folder_itself_may_be_named_by_a_link(tmp_path: Path) -> None:
    (tmp_path / "disk").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "disk")
    claim_and_begin(tmp_path / "link")
    assert names(tmp_path / "disk") == {"marker.json"}


def test_two_writers_are_one_too_many(tmp_path: Path) -> None:
    process, _ = begun(tmp_path, "KIND")
    with process:
        for kind in (KIND, AT_ONCE):
            with (
                pytest.raises(InputError, match="another process is writing"),
                claimed(tmp_path, kind, resume=True),
            ):
                raise AssertionError
        os.kill(process.pid, signal.SIGKILL)
    claim_and_begin(tmp_path)  # nobody holds it now, and there was nothing in it
    assert names(tmp_path) == {"marker.json"}


def test_what_was_killed_before_its_marker_is_gone_on_with(tmp_path: Path) -> None:
    killed(tmp_path, "KIND", "table.csv")
    assert names(tmp_path) == {LOCK, "table.csv"}
    with pytest.raises(InputError, match="--resume"):
        claim_and_begin(tmp_path)
    with (
        pytest.raises(InputError, match="nothing to go on with"),
        claimed(tmp_path, AT_ONCE, resume=True),
    ):
        raise AssertionError
    claim_and_begin(tmp_path, resume=True)
    assert names(tmp_path) == {"marker.json", "table.csv"}


def test_what_can_not_go_on_begins_again_after_a_kill(tmp_path: Path) -> None:
    killed(tmp_path, "AT_ONCE", "chart.csv")
    with claimed(tmp_path, AT_ONCE, resume=False):
        (tmp_path / "provenance.json").write_text("{}")
    with (
        pytest.raises(InputError, match="name another folder"),
        claimed(tmp_path, AT_ONCE, resume=False),
    ):
        raise AssertionError


def test_an_error_leaves_the_folder_claimed(tmp_path: Path) -> None:
    """As a kill does, where nothing else says whose the files are."""
    for folder in (tmp_path, tmp_path / "new"):
        with pytest.raises(KeyboardInterrupt), claimed(folder, AT_ONCE, resume=False):
            raise KeyboardInterrupt
    assert names(tmp_path) == set()
    with pytest.raises(FileExistsError), claimed(tmp_path, AT_ONCE, resume=False):
        [(tmp_path / "chart.csv").touch(exist_ok=False) for _ in range(2)]
    with claimed(tmp_path, AT_ONCE, resume=False):
        pass
    assert names(tmp_path) == {"chart.csv"}


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs a system that forks")
def test_a_forked_worker_does_not_keep_the_lock(tmp_path: Path) -> None:
    """Nor lets it go, or takes the lock file away, when it ends."""
    asking, telling = os.pipe()
    with claimed(tmp_path, KIND, resume=True):
        child = os.fork()
        if child == 0:  # lives until it is told to end
            os.read(asking, 1)
            os._exit(0)
    try:
        with claimed(tmp_path, KIND, resume=True):
            pass
    finally:
        os.write(telling, b"x")
        os.waitpid(child, 0)
        os.close(asking)
        os.close(telling)


def test_whoever_waits_does_not_get_a_lock_that_was_deleted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The process before deletes its lock file as the last thing that it does."""
    path, place = tmp_path / LOCK, os.open

    def late(*arguments: object, **options: object) -> int:
        descriptor = place(*arguments, **options)  # type: ignore[arg-type]
        monkeypatch.undo()
        path.unlink()
        return descriptor

    monkeypatch.setattr(os, "open", late)
    with locked(path) as stream:
        assert os.fstat(stream.fileno()).st_ino == path.stat().st_ino
        with pytest.raises(HeldElsewhereError), locked(path):
            raise AssertionError


def test_only_leftovers_of_named_files_are_cleared(tmp_path: Path) -> None:
    for name in (".a.csv.7.tmp", ".front-001.json.7.tmp", ".mine.csv.7.tmp", ".a.csv.x.tmp"):
        (tmp_path / name).write_text("half")
    clear_leftovers(tmp_path, ("a.csv", "front-*.json"))
    assert names(tmp_path) == {".mine.csv.7.tmp", ".a.csv.x.tmp"}


def test_temporary_folders_of_killed_processes_are_deleted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Those of processes that live, of another program, and links stay."""
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr(tempfile, "tempdir", None)
    dead = killed(tmp_path / "dead", "KIND")
    (dead / "section.geo").write_text("half")
    process, living = begun(tmp_path / "living", "KIND")
    number = dead.name.split("-")[1]
    unlocked = f"beamopt-{os.getpid()}-x"  # as it is at first
    foreign = ("beamopt-mine", f"beamopt-{number}", "tmp-1-x")
    others = [tmp_path / name for name in (unlocked, *foreign)]
    for other in others:
        other.mkdir()
    link, file = tmp_path / f"beamopt-{number}-link", tmp_path / f"beamopt-{number}-file"
    link.symlink_to(others[1])
    file.write_text("mine")
    with process, scratch_folder() as own:
        clear_scratch()
        assert not dead.exists()
        assert all(path.exists() for path in (living, own, link, file, *others))
        os.kill(process.pid, signal.SIGKILL)
    assert not own.exists()
    claim_and_begin(tmp_path / "next")
    assert not living.exists()


def test_a_folder_that_another_process_holds_by_its_lock_stays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As in another container, whose processes have numbers that say nothing here."""
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr(tempfile, "tempdir", None)
    process, living = begun(tmp_path / "living", "KIND")
    with process:
        monkeypatch.setattr("beamopt.storage.scratch._lives", lambda number: False)
        clear_scratch()
        assert living.exists()
        os.kill(process.pid, signal.SIGKILL)
    time.sleep(0.1)
    clear_scratch()
    assert not living.exists()
