"""The same bytes for any number of workers and after any interruption of a prediction."""

import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import Executor, Future
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from beamopt.base.errors import InputError
from beamopt.base.processes import InProcess, processes
from femcheck.continuation.outcome import Status
from femcheck.prediction.answer import Answer
from femcheck.prediction.kept import ray_file, read_ray, write_ray
from femcheck.prediction.prediction import Prediction
from femcheck.prediction.ray_trace import RayResult, trace_ray
from femcheck.solid.winding import Wound
from tests.clocks import busy, run_away
from tests.femcheck.check.small import kept_files
from tests.femcheck.prediction.small import predict, soft_subject
from tests.kills import survives

pytestmark = pytest.mark.usefixtures("undrawn")
Done = tuple[Prediction, Path]


@pytest.fixture
def copied(limited: Done, tmp_path: Path) -> Path:
    return Path(shutil.copytree(limited[1], tmp_path / "soft"))


def without(folder: Path, *names: str) -> list[Path]:
    """The files of cases, taken away."""
    files = [folder / "cases" / f"{name}.npz" for name in names]
    for file in files:
        file.unlink()
    return files


SOME = ("standard-50_100_0", "coarse-100_100_100", "coarse-0_0_100", "coarse-100_0_0")


def test_two_workers_and_one(limited: Done, copied: Path) -> None:
    """Two processes that begin with an empty desk, on rays that were traced one after another."""
    without(copied, *SOME)
    predict(copied, workers=2, resume=True, pool=processes)
    assert kept_files(copied) == kept_files(limited[1])


def test_lost_and_damaged_rays_are_traced_again(limited: Done, copied: Path) -> None:
    first, second, third, fourth = (copied / "cases" / f"{name}.npz" for name in SOME)
    first.unlink()
    second.write_bytes(second.read_bytes()[:700])
    third.write_bytes(b"rubbish" * 100)
    np.savez(fourth, digest=np.array("of another mesh"))
    for name in ("compare.csv", "limits.csv", "summary.json", "mesh.vtu"):
        (copied / name).unlink()
    before = {file: file.stat().st_mtime_ns for file in (copied / "cases").iterdir()}
    predict(copied, resume=True)
    after = {file: file.stat().st_mtime_ns for file in (copied / "cases").iterdir()}
    assert {file for file in after if after[file] != before.get(file)} == {
        first,
        second,
        third,
        fourth,
    }
    assert kept_files(copied) == kept_files(limited[1])


def test_a_finished_prediction_traces_nothing_again(limited: Done, copied: Path) -> None:
    before = {file.name: file.stat().st_mtime_ns for file in (copied / "cases").iterdir()}
    predict(copied, resume=True)
    assert before == {file.name: file.stat().st_mtime_ns for file in (copied / "cases").iterdir()}
    assert kept_files(copied) == kept_files(limited[1])


def test_a_ray_in_another_s_file_is_traced_again(limited: Done, copied: Path) -> None:
    """Of one mesh and law: each file says which question it answers; its name proves nothing."""
    here, there = (copied / "cases" / f"{name}.npz" for name in SOME[1:3])
    there.write_bytes(here.read_bytes())
    predict(copied, resume=True)
    assert kept_files(copied) == kept_files(limited[1])


def test_killed_in_the_middle(limited: Done, copied: Path) -> None:
    """A process killed while it traces, once the first of some rays is there."""
    names = (*SOME, "coarse-0_100_0", "standard-0_0_100")
    lost = without(copied, *names)
    code = (
        "import sys, femcheck.solved.picture, femcheck.prediction.predict_design as run;"
        "femcheck.solved.picture.draw = lambda *scene: False;"
        "run.save_figure = lambda *figure: None;"
        "from pathlib import Path; from tests.femcheck.prediction.small import predict;"
        "predict(Path(sys.argv[1]), resume=True)"
    )
    process = subprocess.Popen([sys.executable, "-c", code, str(copied)])
    deadline = time.monotonic() + 60
    while not any(file.exists() for file in lost) and time.monotonic() < deadline:
        time.sleep(0.01)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    assert 0 < sum(file.exists() for file in lost) < len(lost)
    predict(copied, resume=True)
    assert kept_files(copied) == kept_files(limited[1])


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs a system that forks")
def test_killed_before_any_change_of_a_file(
    calm: Done, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """From the last rays on: meshes and tables, and what was half written of them."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))

    def begin(folder: Path) -> None:
        shutil.copytree(calm[1], folder)
        for file in sorted((folder / "cases").iterdir())[-3:]:
            file.unlink()

    def work(folder: Path) -> None:
        predict(folder, soft_subject(levels=[0, 1, 2]), resume=True, agree=1.0)

    survives(work, tmp_path, kills=4, begin=begin)
    assert kept_files(tmp_path / "whole") == kept_files(calm[1])
    assert not list(tmp_path.glob("beamopt-*"))


class Dying(InProcess):
    """A pool whose process dies under certain rays, as a pool of processes reports it."""

    def __init__(self, deadly: set[tuple[float, ...]]) -> None:
        self._deadly, self._broken = deadly, False

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        if self._broken:
            raise BrokenProcessPool("it is dead")
        if fn is trace_ray and args[0].ray.direction in self._deadly:
            self._broken = True
            future: Future[Any] = Future()
            future.set_exception(BrokenProcessPool("it died"))
            return future
        return super().submit(fn, *args, **kwargs)


@pytest.mark.parametrize("workers", [1, 3])
def test_a_ray_that_kills_its_process_is_the_only_one_lost(
    limited: Done, copied: Path, workers: int
) -> None:
    """STOPPED, in the tables too; what goes on from there tries it again and ends in the same."""

    @contextmanager
    def pool(_: int) -> Iterator[Executor]:
        yield Dying({(0.5, 1.0, 0.0)})

    without(copied, *SOME)
    found = predict(copied, workers=workers, resume=True, pool=pool)
    lost = [key for key, one in found.results.items() if one.status is Status.STOPPED]
    assert [(mesh, found.rays[number].direction) for mesh, number in lost] == [
        ("standard", (0.5, 1.0, 0.0))
    ]
    assert not found.holds
    row = found.subject.pressures.tolist().index([20.0, 40.0, 0.0])
    assert found.status(row) is Status.STOPPED
    assert ",its process ended before it was solved," in (copied / "compare.csv").read_text()
    predict(copied, resume=True)
    assert kept_files(copied) == kept_files(limited[1])


def test_beside_busy_processes(calm: Done, tmp_path: Path) -> None:
    """The same bytes on a machine with other work as on a quiet one."""
    with busy():
        predict(tmp_path / "soft", soft_subject(levels=[0, 1, 2]), agree=1.0)
    assert kept_files(tmp_path / "soft") == kept_files(calm[1])


def test_no_clock_has_a_say(limited: Done, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Limit points that a busy machine would not come to in time, if time counted."""
    run_away(monkeypatch)
    predict(tmp_path / "soft")
    assert kept_files(tmp_path / "soft") == undrawn_files(limited[1])


def test_what_a_work_limit_ended_is_followed_again_with_more(calm: Done, tmp_path: Path) -> None:
    folder, subject = tmp_path / "soft", soft_subject(levels=[0, 1, 2])
    few = predict(folder, subject, agree=1.0, iterations=2)
    assert {one.status for one in few.results.values()} == {Status.WORK_LIMIT}
    assert few.not_computed == 26
    before = {file.name: file.stat().st_mtime_ns for file in (folder / "cases").iterdir()}
    predict(folder, subject, resume=True, agree=1.0, iterations=2)
    assert before == {file.name: file.stat().st_mtime_ns for file in (folder / "cases").iterdir()}
    predict(folder, subject, resume=True, agree=1.0)
    assert kept_files(folder) == kept_files(calm[1])


def test_no_time(limited: Done, tmp_path: Path) -> None:
    """27 statuses, no number; with time the same folder ends in the same bytes."""
    folder = tmp_path / "soft"
    found = predict(folder, seconds=1e-9)
    assert {one.status for one in found.results.values()} == {Status.TIME_OUT}
    assert found.unanswered == 26
    assert not found.holds
    lines = (folder / "compare.csv").read_text().splitlines()[1:]
    assert sum(",time limit reached," in line for line in lines) == 26 + 4 * 2
    # the cases that had time enough in another folder are taken for what they are
    for file in (limited[1] / "cases").iterdir():
        shutil.copy(file, folder / "cases" / file.name)
    (folder / "cases" / "coarse-0_0_100.npz").unlink()
    predict(folder, resume=True)
    assert kept_files(folder) == undrawn_files(limited[1])


def undrawn_files(folder: Path) -> dict[str, bytes]:
    """What a prediction writes where no figure is drawn."""
    figures = {f"{name}.{kind}" for name in ("paths", "axis") for kind in ("png", "svg")}
    return {name: data for name, data in kept_files(folder).items() if name not in figures}


@pytest.mark.parametrize(
    "changes",
    [
        {"law": "gent"},
        {"poisson_ratio": 0.49},
        {"law": "gent", "constants": {"Jm": 30.0}},
        {"wound": Wound.CHAMBERS},
        {"layers": 3},
        {"element": "tet10"},
    ],
    ids=str,
)
def test_another_question_is_refused(copied: Path, changes: dict[str, Any]) -> None:
    before = kept_files(copied)
    with pytest.raises(InputError, match=r"check\.json: question") as refusal:
        predict(copied, resume=True, **changes)
    assert "\n" not in str(refusal.value)
    assert kept_files(copied) == before


def test_another_design_is_refused(copied: Path) -> None:
    with pytest.raises(InputError, match=r"design\.json: differs from the design asked for now"):
        predict(copied, soft_subject(levels=[0, 20, 41]), resume=True)
    with pytest.raises(InputError, match=r"check\.json: design"):
        predict(copied, soft_subject("another"), resume=True)


def test_not_resumed_over_what_is_there(copied: Path) -> None:
    with pytest.raises(InputError, match="holds files already; --resume"):
        predict(copied)


# files of rays


def same(one: RayResult, other: RayResult) -> bool:
    return all(
        _equal(getattr(one, part.name), getattr(other, part.name)) for part in fields(RayResult)
    )


def _equal(one: Any, other: Any) -> bool:
    if isinstance(one, tuple):
        return len(one) == len(other) and all(map(_equal, one, other))
    if isinstance(one, Answer):
        return isinstance(other, Answer) and all(
            _equal(getattr(one, part.name), getattr(other, part.name)) for part in fields(Answer)
        )
    if isinstance(one, np.ndarray | float):
        return np.array_equal(one, other, equal_nan=True)
    return bool(one == other)


def test_a_ray_survives_its_file_and_no_other_question(limited: Done, tmp_path: Path) -> None:
    found, _ = limited
    file = ray_file(tmp_path, "standard", "100_0_0")
    for result in (
        found.result(0),
        RayResult(
            Status.BUCKLED,
            7.5,
            (None,),
            None,
            np.ones((2, 8)),
            growth=1.5,
            snaps=(0.5, 2.0),
            mode_at=np.arange(3.0),
            mode_share=0.01,
        ),
        RayResult(Status.STOPPED, 0.0, (None, None), None, np.empty((0, 8))),
    ):
        write_ray(file, result, "this question")
        read = read_ray(file, "this question")
        assert read is not None
        assert same(read, result)
        assert read.is_local == result.is_local
        assert read_ray(file, "that question") is None
    assert read_ray(tmp_path / "none.npz", "this question") is None


def test_a_ray_file_with_bits_turned_over(limited: Done, tmp_path: Path) -> None:
    """Read as it was, or not at all: nothing else, no exception."""
    result = limited[0].result(0)
    file = ray_file(tmp_path, "standard", "100_0_0")
    write_ray(file, result, "question")
    good, rng, lost = file.read_bytes(), np.random.default_rng(2), 0
    headers = good.index(b"PK\x01\x02")
    for case in range(200):
        changed = bytearray(good)
        # half of them in the directory at the end, where headers stand
        place = rng.integers(headers, len(good)) if case % 2 else rng.integers(len(good))
        changed[place] ^= 1 << rng.integers(8)
        file.write_bytes(changed)
        read = read_ray(file, "question")
        lost += read is None
        assert read is None or same(read, result)
    assert lost > 60
