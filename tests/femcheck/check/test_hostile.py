"""Sections and processes that go wrong: an answer or a status, never a crash."""

import json
import multiprocessing
import os
from collections.abc import Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from beamopt.base.processes import InProcess
from beamopt.scene.bundled import bundled_scenes
from beamopt.scene.design import load_design
from beamopt.storage.result_folder import differences
from femcheck.check.check_design import check_design
from femcheck.check.checked import Checked
from femcheck.check.tables import verdict
from femcheck.continuation.outcome import Status
from femcheck.mesh.gmsh_section import Mesher, MeshProblem
from femcheck.solved.case import solve_case
from femcheck.solved.subject import Subject, UnsealedDesignError, check_sealed, sealed_copy
from tests.femcheck.check.small import (
    Coarse,
    design_of,
    here,
    kept_files,
    quick_options,
    small_subject,
    three_circles,
)

pytestmark = pytest.mark.usefixtures("undrawn")
Quick = tuple[Checked, Path]
RING = {"inner_radius": 4, "outer_radius": 15, "radial": 32, "angular": 120}


def checked(drawing: list[dict[str, Any]], folder: Path, **changes: Any) -> Checked:
    subject = Coarse("hostile", design_of(drawing, **changes))
    result = check_design(subject, folder, quick_options(), pool=here)
    said = json.loads((folder / "summary.json").read_text())
    assert said["verdict"]["text"] == verdict(result)
    assert (folder / "compare.csv").exists() == (result.failure is None)
    return result


def test_two_chambers_0_5_mm_apart(tmp_path: Path) -> None:
    seal = {"skin": 1.0, "wall": 0.3, "rounding": 0.3, "smallest_chamber": 1.0}
    drawing = [
        {"supply": 1, "center": [5.25, 0], "radius": 5.0},
        {"supply": 2, "center": [-5.25, 0], "radius": 5.0},
        {"supply": 3, "center": [0, 10.5], "radius": 2.0},
    ]
    result = checked(drawing, tmp_path / "thin", seal=seal)
    assert result.failure is None
    statuses = {one.status for one in result.results.values()}
    assert Status.CONVERGED in statuses
    assert statuses <= set(Status)


def test_an_island(tmp_path: Path) -> None:
    """A disc of material in the middle of a chamber, held by the ends alone."""
    points = [(0.0, 0.0, 0)]
    points += [(8 * np.cos(a), 8 * np.sin(a), 1) for a in np.radians(np.arange(0, 360, 60))]
    x, y, kind = ([one[k] for one in points] for k in range(3))
    data = small_subject().design.model_dump(by_alias=True, exclude_none=True)
    del data["drawing"]
    data["feature_points"] = {"x": x, "y": y, "type": kind}
    data["seal"] = {"skin": 2.0, "wall": 1.0, "islands": "keep"}
    subject = Coarse("island", type(small_subject().design).model_validate(data))
    assert subject.has_islands
    result = check_design(subject, tmp_path / "island", quick_options(), pool=here)
    assert result.failure is None
    assert len(result.results) == 4 * 27
    said = json.loads((tmp_path / "island" / "summary.json").read_text())
    assert said["section"]["islands"] == 1
    assert said["section"]["chambers"] == [1, 0, 0]


def test_material_in_two_pieces(tmp_path: Path) -> None:
    drawing = [{"supply": 1, "r": [8, 11], "phi": [0, 360]}]
    result = checked(drawing, tmp_path / "pieces", grid=RING)
    assert result.failure is not None
    assert result.failure.problem is MeshProblem.FATAL
    assert "2 separate pieces" in verdict(result)
    assert not result.holds


def test_no_chamber_for_a_supply(tmp_path: Path) -> None:
    result = checked(three_circles()[:2], tmp_path / "two")
    compared = result.comparison
    assert compared is not None
    assert compared.unanswered == 0
    assert np.isnan(compared.final.volume_ratios[:, 2]).all()
    assert not np.isnan(compared.final.volume_ratios[:, :2]).any()
    by_third = compared.final.tips.reshape(3, 3, 3, 3)
    # pressure in a supply without a chamber does nothing: levels of it differ by nothing
    np.testing.assert_allclose(by_third[:, :, 0], by_third[:, :, 2], atol=1e-5)


def test_no_chamber_at_all(tmp_path: Path) -> None:
    seal = {"smallest_chamber": 500.0}
    result = checked(three_circles(), tmp_path / "none", seal=seal)
    compared = result.comparison
    assert compared is not None
    assert compared.unanswered == 0
    np.testing.assert_allclose(compared.final.tips - [0, 0, 100], 0, atol=1e-9)
    assert not result.holds
    assert verdict(result) == "nothing to compare: no tip moves at any pressure"


def test_an_unsealed_one(tmp_path: Path) -> None:
    design = load_design(
        bundled_scenes()["hand-drawn-section"].with_name("hand_drawn_section.json")
    )
    open_one = design.model_copy(update={"drawing": [*design.drawing[:2]]})
    data = open_one.model_dump(by_alias=True, exclude_none=True)
    data["drawing"] = [{"supply": 1, "center": [24, 0], "radius": 4}]
    unsealed = type(design).model_validate(data)
    with pytest.raises(UnsealedDesignError, match=r"is not sealed: .*--seal 1\.0 seals a copy"):
        check_sealed("open", unsealed)
    result = check_design(Subject("open", unsealed), tmp_path / "open", quick_options(), pool=here)
    assert result.failure is not None
    assert result.failure.problem is MeshProblem.FATAL
    assert verdict(result).startswith("no answer: no solid can be made of the outline")
    sealed = sealed_copy("open", unsealed, 1.0)
    check_sealed("open", sealed.design)
    assert sealed.sealing_moved is not None
    assert sealed.sealing_moved.max() > 0.1


def test_no_gmsh(tmp_path: Path) -> None:
    options = quick_options(mesher=Mesher("no-such-gmsh"))
    result = check_design(small_subject(), tmp_path / "none", options, pool=here)
    assert result.failure is not None
    assert result.failure.problem is MeshProblem.NO_GMSH
    assert not (tmp_path / "none" / "compare.csv").exists()
    # once it is there the check goes on in the same folder
    again = check_design(
        small_subject(), tmp_path / "none", quick_options(seconds=1e-9), resume=True, pool=here
    )
    assert again.failure is None


def test_no_time(tmp_path: Path) -> None:
    """No case is solved: 27 statuses a solid, no number, and a verdict that says so."""
    folder = tmp_path / "late"
    result = check_design(small_subject(), folder, quick_options(seconds=1e-9), pool=here)
    assert {one.status for one in result.results.values()} == {Status.TIME_OUT}
    assert verdict(result) == "no answer in 26 of 26 cases: time limit reached"
    assert not result.holds
    for line in (folder / "compare.csv").read_text().splitlines()[1:]:
        assert line.endswith(",,,,,,,,,,time limit reached,solid.TIME_OUT")
    assert not list((folder / "deformed").iterdir())


class Dying(InProcess):
    """A pool of which the process dies under certain cases, as a pool of processes reports it."""

    def __init__(self, deadly: set[tuple[float, ...]], deaths: list[int]) -> None:
        self._deadly, self._deaths, self._broken = deadly, deaths, False

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        if self._broken:
            raise BrokenProcessPool("it is dead")
        if fn is solve_case and tuple(args[0].pressures.tolist()) in self._deadly:
            self._broken = True
            self._deaths.append(1)
            future: Future[Any] = Future()
            future.set_exception(BrokenProcessPool("it died"))
            return future
        return super().submit(fn, *args, **kwargs)


@pytest.mark.parametrize("workers", [1, 3])
def test_a_case_that_kills_its_process_is_the_only_one_lost(
    quick: Quick, tmp_path: Path, workers: int
) -> None:
    deaths: list[int] = []

    @contextmanager
    def pool(_: int) -> Iterator[Executor]:
        yield Dying({(20.0, 0.0, 40.0), (40.0, 40.0, 40.0)}, deaths)

    folder = tmp_path / "small"
    result = check_design(small_subject(), folder, quick_options(), workers=workers, pool=pool)
    lost = {key for key, one in result.results.items() if one.status is Status.STOPPED}
    assert {node for _, node in lost} == {(1, 0, 2), (2, 2, 2)}
    assert len(lost) == 4 * 2
    assert len(deaths) >= len(lost)
    assert verdict(result) == f"no answer in 2 of 26 cases: {Status.STOPPED.value}"
    whole = quick[0].comparison
    assert whole is not None
    assert result.comparison is not None
    answered = ~np.isnan(result.comparison.final.tips[:, 0])
    assert answered.sum() == 25
    np.testing.assert_allclose(
        result.comparison.final.tips[answered], whole.final.tips[answered], atol=1e-4
    )


def test_a_process_that_really_dies(quick: Quick, tmp_path: Path) -> None:
    """A worker ends at its first task, whatever that is; new ones finish, and all is there."""
    killed: list[int] = []

    @contextmanager
    def pool(workers: int) -> Iterator[Executor]:
        with ProcessPoolExecutor(workers, multiprocessing.get_context("spawn")) as executor:
            if len(killed) < 2:
                killed.append(1)
                executor.submit(os._exit, 1)
            yield executor

    folder = tmp_path / "small"
    result = check_design(small_subject(), folder, quick_options(), workers=1, pool=pool)
    assert len(killed) == 2
    assert len(result.results) == 4 * 27
    answered = sum(one.status is Status.CONVERGED for one in result.results.values())
    assert answered >= 4 * 27 - 2
    assert set(kept_files(folder)) <= set(kept_files(quick[1]))


def test_a_question_less_than_what_is_kept_is_another_one() -> None:
    """A constant that was given and is not given now."""
    kept = {"question": {"constants": {"Jm": 30.0}, "law": "gent"}}
    now = {"question": {"constants": {}, "law": "gent"}}
    assert list(differences(kept, now)) == [("question.constants.Jm", 30.0, None)]
    assert list(differences(now, kept)) == [("question.constants.Jm", None, 30.0)]
    assert not list(differences(kept, kept))
