"""The same bytes for any number of workers and after any interruption."""

import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from beamopt.base.errors import InputError
from beamopt.base.processes import processes
from beamopt.storage.result_folder import LOCK
from femcheck.check.check_design import check_design
from femcheck.check.checked import Checked
from femcheck.check.kept import case_file, read_case, write_case
from femcheck.continuation.outcome import Status
from femcheck.continuation.shape import Shapes
from femcheck.solved.folder import KIND
from tests.clocks import busy, run_away
from tests.femcheck.check.small import here, kept_files, quick_options, small_options, small_subject
from tests.kills import survives

pytestmark = pytest.mark.usefixtures("undrawn")
Done = tuple[Checked, Path]


def again(folder: Path, resume: bool = True, **changes: object) -> Checked:
    return check_design(small_subject(), folder, quick_options(**changes), resume=resume, pool=here)


@pytest.fixture
def copied(quick: Done, tmp_path: Path) -> Path:
    return Path(shutil.copytree(quick[1], tmp_path / "small"))


def test_two_workers(quick: Done, tmp_path: Path) -> None:
    """Two processes, cases in another order: what is known earlier must not matter."""
    folder = tmp_path / "small"
    check_design(small_subject(), folder, quick_options(), workers=2, pool=processes)
    assert kept_files(folder) == kept_files(quick[1])


def test_beside_busy_processes(quick: Done, tmp_path: Path) -> None:
    """The same bytes on a machine with other work as on a quiet one."""
    with busy():
        again(tmp_path / "small", resume=False)
    assert kept_files(tmp_path / "small") == kept_files(quick[1])


def test_no_clock_has_a_say(quick: Done, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run_away(monkeypatch)
    again(tmp_path / "small", resume=False)
    assert kept_files(tmp_path / "small") == kept_files(quick[1])


def test_what_a_clock_ended_is_tried_again(quick: Done, tmp_path: Path) -> None:
    folder = tmp_path / "small"
    late = again(folder, resume=False, seconds=1e-9)
    assert {one.status for one in late.results.values()} == {Status.TIME_OUT}
    again(folder)
    assert kept_files(folder) == kept_files(quick[1])


@pytest.mark.parametrize("iterations", [2, 3])
def test_what_a_work_limit_ended_is_solved_again_with_more(
    done: Done, tmp_path: Path, iterations: int
) -> None:
    """And so is what builds on it: with that missing it began elsewhere than it does now."""
    folder = tmp_path / "small"

    def limited(resume: bool = True, **changes: Any) -> Checked:
        options = small_options(**changes)
        return check_design(small_subject(), folder, options, resume=resume, pool=here)

    def written() -> dict[str, int]:
        return {file.name: file.stat().st_mtime_ns for file in (folder / "cases").iterdir()}

    few = limited(resume=False, iterations=iterations)
    assert {one.status for one in few.results.values()} == {Status.CONVERGED, Status.WORK_LIMIT}
    spent = [one.outcome.statistics.iterations for one in few.results.values()]
    assert max(spent) == iterations
    assert few.comparison is not None
    assert few.comparison.final.iterations.max() <= 2 * iterations
    limited()
    assert kept_files(folder) == kept_files(done[1])
    # who asks for less work later keeps what is there
    before = written()
    limited(iterations=iterations)
    assert written() == before
    assert kept_files(folder) == kept_files(done[1])


def test_what_ends_at_the_same_work_limit_is_not_solved_again(tmp_path: Path) -> None:
    folder = tmp_path / "small"
    options = small_options(iterations=1)
    few = check_design(small_subject(), folder, options, pool=here)
    ended = [case_file(folder / "cases", key) for key, one in few.results.items()
             if one.status is Status.WORK_LIMIT]  # fmt: skip
    before = [file.stat().st_mtime_ns for file in ended]
    assert before
    check_design(small_subject(), folder, options, resume=True, pool=here)
    assert [file.stat().st_mtime_ns for file in ended] == before


@pytest.mark.parametrize(
    "lost",
    ["*-c10000-*", "*-?1?.npz", "standard-c2500-000.npz"],
)
def test_resumed_without_some_cases(quick: Done, copied: Path, lost: str) -> None:
    files = list((copied / "cases").glob(lost))
    assert files
    for file in files:
        file.unlink()
    for name in ("compare.csv", "summary.json", "mesh.vtu"):
        (copied / name).unlink()
    again(copied)
    assert all(file.exists() for file in files)
    assert kept_files(copied) == kept_files(quick[1])


def test_corrupt_cases_are_solved_again(quick: Done, copied: Path) -> None:
    cases = sorted((copied / "cases").glob("coarse-c2500-*.npz"))
    cases[0].write_bytes(b"")
    cases[1].write_bytes(b"rubbish" * 100)
    cases[2].write_bytes(cases[2].read_bytes()[:700])
    cases[3].write_bytes(cases[4].read_bytes()[::-1])
    np.savez(cases[5], digest=np.array("of another mesh"))
    (copied / "cases" / ".coarse-c2500-000.npz.4711.tmp").write_bytes(b"half")
    again(copied)
    assert kept_files(copied) == kept_files(quick[1])
    assert not list((copied / "cases").glob(".*"))


def test_a_kept_case_survives_its_file_and_no_other_mesh(quick: Done, tmp_path: Path) -> None:
    checked, _ = quick
    stage, node = checked.stages[2], (1, 0, 2)
    solid, key = stage.solid, (stage.name, node)
    result, shapes = checked.results[key], Shapes(solid.body())
    write_case(tmp_path, key, result, solid.digest)
    read = read_case(tmp_path, key, shapes, solid.digest)
    assert read is not None
    assert read.shape is not None
    assert read.outcome.state is not None
    assert result.outcome.state is not None
    np.testing.assert_array_equal(read.shape, result.shape)
    np.testing.assert_array_equal(read.outcome.state.x, result.outcome.state.x)
    assert read.outcome.statistics == result.outcome.statistics
    assert read.strain_energy == result.strain_energy
    assert read_case(tmp_path, key, shapes, checked.stages[0].solid.digest) is None
    assert read_case(tmp_path, (stage.name, (0, 0, 0)), shapes, solid.digest) is None


def test_a_case_file_with_bits_turned_over(quick: Done, tmp_path: Path) -> None:
    """Read as it was, or not at all: nothing else, no exception."""
    checked, _ = quick
    stage = checked.stages[2]
    key, digest = (stage.name, (1, 1, 1)), stage.solid.digest
    shapes, result = Shapes(stage.solid.body()), checked.results[key]
    write_case(tmp_path, key, result, digest)
    file, rng, lost = case_file(tmp_path, key), np.random.default_rng(2), 0
    good = file.read_bytes()
    assert result.outcome.state is not None
    headers = good.index(b"PK\x01\x02")
    for case in range(300):
        changed = bytearray(good)
        # half of them in the directory at the end, where headers stand
        place = rng.integers(headers, len(good)) if case % 2 else rng.integers(len(good))
        changed[place] ^= 1 << rng.integers(8)
        file.write_bytes(changed)
        read = read_case(tmp_path, key, shapes, digest)
        lost += read is None
        if read is not None:
            assert read.outcome.state is not None
            np.testing.assert_array_equal(read.outcome.state.x, result.outcome.state.x)
            assert read.status is Status.CONVERGED
    assert lost > 100


def test_killed_in_the_middle(quick: Done, tmp_path: Path) -> None:
    """A process killed once some cases are there, resumed in this one."""
    folder = tmp_path / "small"
    code = (
        "import sys, femcheck.solved.picture; femcheck.solved.picture.draw = lambda *scene: False;"
        "from pathlib import Path; from femcheck.check.check_design import check_design;"
        "from tests.femcheck.check.small import here, quick_options, small_subject;"
        "check_design(small_subject(), Path(sys.argv[1]), quick_options(), pool=here)"
    )
    process = subprocess.Popen([sys.executable, "-c", code, str(folder)])
    cases = folder / "cases"
    deadline = time.monotonic() + 60
    while len(list(cases.glob("*.npz"))) < 30 and time.monotonic() < deadline:
        time.sleep(0.02)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    assert 30 <= len(list(cases.glob("*.npz"))) < 4 * 27
    assert not (folder / "compare.csv").exists()
    again(folder)
    assert kept_files(folder) == kept_files(quick[1])


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs a system that forks")
def test_killed_before_any_change_of_a_file(
    quick: Done, tmp_path: Path, undrawn: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """From the last cases on: meshes and tables, and what was half written of them."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))

    def begin(folder: Path) -> None:
        shutil.copytree(quick[1], folder)
        for file in sorted((folder / "cases").iterdir())[-3:]:
            file.unlink()

    survives(again, tmp_path, kills=4, begin=begin)
    assert kept_files(tmp_path / "whole") == kept_files(quick[1])
    assert not list(tmp_path.glob("beamopt-*"))


def test_killed_before_there_was_a_marker(tmp_path: Path) -> None:
    folder = tmp_path / "small"
    (folder / "cases").mkdir(parents=True)
    (folder / LOCK).write_text(KIND.name)
    small_subject().design.save(folder / "design.json")
    checked = again(folder, seconds=1e-9)
    assert checked.comparison is not None


def test_a_finished_check_solves_nothing_again(quick: Done, copied: Path) -> None:
    before = {file.name: file.stat().st_mtime_ns for file in (copied / "cases").iterdir()}
    again(copied)
    assert before == {file.name: file.stat().st_mtime_ns for file in (copied / "cases").iterdir()}
    assert kept_files(copied) == kept_files(quick[1])


def test_not_resumed_over_what_is_there(copied: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="holds files already; --resume"):
        again(copied, resume=False)
    other = tmp_path / "other"
    other.mkdir()
    (other / "notes.txt").write_text("mine")
    with pytest.raises(InputError, match="nothing to go on with"):
        again(other)


@pytest.mark.parametrize(
    "changes", [{"layers": 3}, {"penalties": (1000.0, 2000.0)}, {"element": "tet10"}]
)
def test_another_question_is_refused(copied: Path, changes: dict[str, object]) -> None:
    with pytest.raises(InputError, match=r"check\.json: question"):
        again(copied, **changes)


def test_another_design_is_refused(copied: Path) -> None:
    other = small_subject(pressures=[0, 20, 41])
    with pytest.raises(InputError, match=r"design\.json: differs from the design asked for now"):
        check_design(other, copied, quick_options(), resume=True, pool=here)
    with pytest.raises(InputError, match=r"check\.json: design"):
        check_design(small_subject("another"), copied, quick_options(), resume=True, pool=here)
