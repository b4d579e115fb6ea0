"""What a front's folder and its command say: nothing of the machine, how near the bound."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from beamopt.base.errors import InputError
from beamopt.cli.application import run
from beamopt.judge.judge import in_parts
from beamopt.pareto.find_front import find_front
from beamopt.pareto.search import FrontRecord
from beamopt.scene.bundled import bundled_scenes
from beamopt.scene.design import load_design
from beamopt.scene.scene import load_scene
from beamopt.storage.writing import write_changed
from tests.validation.resume import content

WANTED = "hand-drawn-workspace"
TABLE = bundled_scenes()[WANTED].with_name("hand_drawn_workspace.csv")
SMALL = ["--objectives", "L,mass", "--population", "16", "--generations", "1"]
NONE_MAY_BE_MADE = ["--set=making.chambers=[0,0,0]", "--set=making.chambers_rule='reject'"]


def test_a_front_says_how_far_it_is_above_the_bound(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "front"
    assert run(["pareto", WANTED, *SMALL, "--out", str(folder)]) == 0
    said = capsys.readouterr().out
    assert "65.5846 mm² (numerical, over all response matrices): L is" in said
    bound = json.loads((folder / "summary.json").read_text())["bound"]
    lowest = float((folder / "front.csv").read_text().splitlines()[1].split(",")[1])
    assert bound["L"] == pytest.approx(65.58, abs=0.01)
    assert bound["L"] + bound["L_above"] == pytest.approx(lowest, rel=1e-12)


def test_a_front_without_designs_names_the_files_that_are_there(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "front"
    arguments = ["pareto", WANTED, *SMALL, *NONE_MAY_BE_MADE, "--out", str(folder)]
    assert run(arguments) == 1
    said = capsys.readouterr().out
    assert "front.csv" in said
    assert "front-" not in said
    assert "above it" not in said
    assert "L_above" not in json.loads((folder / "summary.json").read_text())["bound"]


def test_a_front_keeps_its_targets_files_and_names_no_machine(tmp_path: Path) -> None:
    path = tmp_path / "path.csv"
    path.write_text("x,y,z\n0,0,100\n5,0,104\n")
    keys = ["search.generations=1", f"target.paths=['{path}']"]
    scene = load_scene(WANTED, keys)
    folder = tmp_path / "front"
    find_front(scene, ("L", "mass"), folder, population=16, figures=False)
    for file in folder.iterdir():
        assert str(tmp_path).encode() not in file.read_bytes(), file
        assert str(TABLE.parent).encode() not in file.read_bytes(), file
    assert (folder / "target-source.csv").read_bytes() == TABLE.read_bytes()
    assert (folder / "target-path-1.csv").read_bytes() == path.read_bytes()
    whole = content(folder)
    again = load_scene(str(folder / "scene.toml"))
    find_front(again, ("L", "mass"), folder, population=16, resume=True, figures=False)
    assert content(folder) == whole


@pytest.mark.parametrize(
    ("keys", "named"),
    [
        ([], None),
        (["stop.stall=5", "search.improved_share=0.2"], "stop.stall, search.improved_share"),
        (["stop.loss=5", "refine.finish=true"], "stop.loss, refine.finish"),
    ],
)
def test_keys_that_change_nothing_are_named(
    keys: list[str], named: str | None, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    sets = [f"--set={key}" for key in keys]
    assert run(["pareto", WANTED, *SMALL, *sets, "--out", str(tmp_path / "front")]) == 0
    notes = [line for line in capsys.readouterr().out.splitlines() if line.startswith("note: ")]
    assert notes == ([] if named is None else [f"note: a search for a front ignores {named}"])


def test_a_design_of_a_front_says_what_its_rules_added(tmp_path: Path) -> None:
    keys = ["search.generations=1", "making.chambers=[1,1,1]", "making.chambers_weight=50"]
    folder = tmp_path / "front"
    scene = load_scene(WANTED, keys)
    front = find_front(scene, ("L", "mass"), folder, population=16, figures=False)
    notes = load_design(folder / "front-000.json").notes
    assert notes["L"] + notes["R"] == front.values[0, 0]
    assert notes["R"] == front.designs[0].score.verdict.R > 0
    free = find_front(load_scene(WANTED, keys[:1]), ("L", "mass"), tmp_path / "free", population=16)
    assert front.designs
    assert free.designs
    assert "R" not in load_design(tmp_path / "free" / "front-000.json").notes


def test_only_designs_that_its_table_names_are_deleted(tmp_path: Path) -> None:
    """A person's copies beside them stay, whatever their number."""

    def front(generations: int) -> set[str]:
        scene = load_scene(WANTED, [f"search.generations={generations}"])
        find_front(scene, ("L", "mass"), tmp_path, population=16, resume=True, figures=False)
        return {file.name for file in tmp_path.glob("front-*.json")}

    before = front(0)
    mine = {"front-mine.json", "front-900.json", "front-1.json"}
    for name in mine:
        (tmp_path / name).write_text("mine")
    with (tmp_path / "front.csv").open("a") as table:  # named twice, or where no name stands
        table.write("../front-900.json.bak\n")
    after = front(4)
    assert mine < after
    assert before - after  # the front has other designs now
    assert {(tmp_path / name).read_text() for name in mine} == {"mine"}
    named = (tmp_path / "front.csv").read_text()
    assert all(name in named for name in after - mine)


def test_a_front_cut_while_it_is_written_leaves_no_design_that_its_table_does_not_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever was written last, and gone on with to a longer search."""

    def front(folder: Path, generations: int) -> None:
        scene = load_scene(WANTED, [f"search.generations={generations}"])
        find_front(scene, ("L", "mass"), folder, population=16, resume=True, figures=False)

    def writes(most: int) -> Callable[[Path, str], bool]:
        left = iter(range(most))

        def write(path: Path, text: str) -> bool:
            if next(left, None) is None:
                raise InterruptedError
            return write_changed(path, text)

        return write

    is_cut, most = True, 0
    while is_cut:
        folder = tmp_path / str(most)
        with monkeypatch.context() as patch:
            patch.setattr("beamopt.pareto.folder.write_changed", writes(most))
            try:
                front(folder, 0)
                is_cut = False
            except InterruptedError:
                most += 1
        front(folder, 4)  # whose front has fewer designs
        named = set(re.findall(r"front-\d+\.json", (folder / "front.csv").read_text()))
        assert {file.name for file in folder.glob("front-*.json")} == named
    assert most > 5


def test_two_processes_can_not_write_one_front(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("beamopt.storage.file_lock.PATIENCE", 0.1)
    scene = load_scene(WANTED, ["search.generations=1"])
    refused = []

    def again() -> None:
        find_front(scene, ("L", "mass"), tmp_path, population=16, resume=True, figures=False)

    def second(record: FrontRecord) -> None:
        with pytest.raises(InputError, match="another process is writing") as caught:
            again()
        refused.append(str(caught.value))

    find_front(scene, ("L", "mass"), tmp_path, population=16, callback=second, figures=False)
    assert len(refused) == 2
    whole = content(tmp_path)
    again()  # nobody holds it now
    assert content(tmp_path) == whole


def test_parts_are_put_together_in_order() -> None:
    scene = load_scene(WANTED)
    rng = np.random.default_rng(0)
    candidates = [scene.random_points(rng) for _ in range(7)]
    with ThreadPoolExecutor(3) as executor:
        digests = in_parts(lambda part: [one.digest for one in part], candidates, executor, 3)
    assert digests == [one.digest for one in candidates]
