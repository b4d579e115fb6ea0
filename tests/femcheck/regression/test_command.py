"""`femcheck baseline` and `femcheck regress` as a person meets them."""

import csv
import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import femcheck.regression.rods
from beamopt.base.arrays import FloatArray
from beamopt.base.errors import InputError
from beamopt.rod.response import LinearResponse
from femcheck.cli.application import run
from femcheck.continuation.ended import Ended
from femcheck.continuation.outcome import Status
from femcheck.models.reply import Reply
from femcheck.regression.baseline import read_baseline
from femcheck.regression.held import LADDER
from femcheck.regression.held_design import BUNDLED, find_design
from femcheck.regression.regression import hold_designs, regress, update_baseline
from tests.femcheck.regression.small import saved

ROOT = Path(__file__).resolve().parents[3]
HERE = ["--workers", "1"]
WRITE = ["baseline", "small.json", "--out", "kept", *HERE]
HOLD = ["regress", "--baseline", "kept", *HERE]

Change = Callable[[dict[str, Any]], object]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    saved(tmp_path)
    return tmp_path


def test_designs_by_the_names_of_other_commands(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A bundled scene, a scene file and a run folder; each is found again by its baseline."""
    sections = {"sections": LADDER[: LADDER.index("raster")]}
    monkeypatch.setattr("femcheck.regression.measure.PARTS", sections)
    assert "hand-drawn-section" not in BUNDLED
    saved(folder, "drawn")
    (folder / "mine.toml").write_text(
        'name = "mine"\n[target]\nkind = "section"\nfile = "drawn.json"\n'
    )
    (folder / "run").mkdir()
    saved(folder / "run", "best")
    names = ["hand-drawn-section", "mine.toml", "run"]
    assert run(["baseline", *names, "--out", "kept", *HERE]) == 0
    for given in ("hand-drawn-section", "mine", "run", "mine.toml"):
        assert run(["regress", given, "--baseline", "kept", *HERE]) == 0
    saved(folder, "drawn", pressures=[0, 10, 20])
    (folder / "mine.toml").write_text((folder / "mine.toml").read_text() + "[grid]\nradial = 4\n")
    assert run(["regress", "run", "--baseline", "kept", *HERE]) == 0
    saved(folder / "run", "best", pressures=[0, 10, 20])
    assert "is not the design" in complaint(["regress", "run", "--baseline", "kept", *HERE], capsys)


@pytest.fixture
def kept(folder: Path) -> Path:
    assert run(WRITE) == 0
    return folder / "kept" / "small.json"


def changed(file: Path, change: Change) -> None:
    data = json.loads(file.read_text())
    change(data)
    file.write_text(json.dumps(data))


def complaint(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    capsys.readouterr()
    assert run(arguments) == 2
    _, err = capsys.readouterr()
    assert err.count("\n") == 1
    return err


def test_what_was_written_holds(kept: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = kept.read_bytes()
    assert run(HOLD) == 0
    said = capsys.readouterr().out.splitlines()[-1]
    assert "of 1 designs" in said
    assert "nothing moved" in said
    assert run([*WRITE, "--force"]) == 0
    assert kept.read_bytes() == before
    assert (kept.parent / "provenance.json").exists()


def test_every_tolerance_has_its_source(kept: Path) -> None:
    found = [entry.held for entry in read_baseline(kept).held]
    assert [one.rung for one in found] == sorted((one.rung for one in found), key=LADDER.index)
    assert {one.rung for one in found} == {"section", "outline", "response", "raster", "beam"}
    for one in found:
        exact = one.source == "counts are exact"
        assert exact or one.source.startswith("rounding of a closed form: 1e-09 of ")
        assert (one.tolerance == 0) == exact
    tips = next(one for one in found if one.rung == "beam")
    assert tips.tolerance == pytest.approx(60e-9)
    assert len(tips.rows) == 27


def test_a_sign_in_the_code_is_named(
    kept: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    strains = LinearResponse.strains

    def wrong(self: LinearResponse, pressures: FloatArray) -> FloatArray:
        return strains(self, pressures) * np.array([1.0, 1.0, -1.0])

    monkeypatch.setattr(LinearResponse, "strains", wrong)
    assert run([*HOLD, "--out", "moved.csv"]) == 1
    out = capsys.readouterr().out
    for word in ("design", "held", "now", "moved", "tolerance", "small", "raster"):
        assert word in out
    assert "lowest rung that moved: raster " in out
    assert "(tolerance 6e-08)" in out
    with Path("moved.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert {row["rung"] for row in rows} == {"raster", "beam"}
    assert all(float(row["moved"]) > 1e-3 for row in rows)


def test_an_equilibrium_that_vanished_is_named(
    kept: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def lose(data: dict[str, Any]) -> None:
        tips = next(one for one in data["held"] if one["rung"] == "beam")
        tips["rows"]["0, 0, 20 kPa"] = "buckled"

    changed(kept, lose)
    assert run(HOLD) == 1
    out = capsys.readouterr().out
    assert "lowest rung that moved: beam of small: tips at 0, 0, 20 kPa: " in out
    assert "held: buckled" in out


def test_a_rung_that_breaks_is_named(
    kept: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def breaks(*_: object) -> Reply:
        raise ZeroDivisionError("by nothing")

    monkeypatch.setattr(femcheck.regression.rods.RodOnOutline, "reply", breaks)
    assert run(HOLD) == 1
    out = capsys.readouterr().out
    assert "lowest rung that moved: beam of small: tips at 0, 0, 0 kPa: " in out
    assert "ZeroDivisionError: by nothing" in out


def test_rods_under_loads_are_held_by_two_methods(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    loads = {"mount_z": [1.0, 0.0, 0.0], "mount_x": [0.0, 0.0, -1.0], "density": 3000.0}
    saved(folder, loads=loads)
    assert run(WRITE) == 0
    found = {one.rung: one.held for one in read_baseline(folder / "kept" / "small.json").held}
    assert {"loads", "torsion", "rod under load", "rod, modes", "rod, elements"} <= set(found)
    assert "own estimate" in found["rod, modes"].source
    assert "from 32 and 64 elements" in found["rod, elements"].source
    assert 0 < found["rod, modes"].tolerance < found["rod, elements"].tolerance < 0.01
    assert run(HOLD) == 0


def test_rungs_that_contradict_each_other_are_not_written(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    saved(folder, loads={"density": 3000.0, "mount_z": [1.0, 0.0, 0.0], "mount_x": [0.0, 1.0, 0.0]})
    honest = femcheck.regression.rods.RodByMethod.reply

    def shifted(self: Any, question: Any, workers: int = 0) -> Reply:
        reply = honest(self, question, workers)
        return Reply(reply.tips + (self.method == "elements"), reply.endings, errors=reply.errors)

    monkeypatch.setattr(femcheck.regression.rods.RodByMethod, "reply", shifted)
    assert run(WRITE) == 1
    assert "small: rod, modes and rod, elements: tips at " in capsys.readouterr().out
    assert not (folder / "kept" / "small.json").exists()


def test_a_baseline_is_not_written_over(kept: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = kept.read_bytes()
    assert "small.json: there already; --force" in complaint(WRITE, capsys)
    assert kept.read_bytes() == before


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda data: data.update(schema="femcheck-baseline/2"), "this version reads"),
        (lambda data: data["held"][0].pop("tolerance"), "held[0].tolerance: must be given"),
        (lambda data: data["held"][0].update(rung="roof"), "held[0].rung = 'roof': one of section"),
        (lambda data: data["held"][0].update(tolerance=-1), "allowed: at least 0"),
        (lambda data: data["held"][0]["rows"].update(material=[True]), "must be a number"),
        (lambda data: data["design"].update(digest="0"), "not the design that this was written of"),
    ],
)
def test_a_damaged_baseline_is_one_line(
    kept: Path, change: Change, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    changed(kept, change)
    found = complaint(HOLD, capsys)
    assert "kept/small.json" in found
    assert said in found


def test_half_a_baseline_is_one_line(kept: Path, capsys: pytest.CaptureFixture[str]) -> None:
    kept.write_bytes(kept.read_bytes()[:-100])
    assert "kept/small.json" in complaint(HOLD, capsys)


def test_a_design_that_changed_is_no_result_that_moved(
    kept: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    saved(Path(), wall_elements=2)
    assert "small is not the design that this was written of" in complaint(HOLD, capsys)
    saved(Path(), notes={"seen": "today"})
    assert run(HOLD) == 0


def test_what_is_not_there_is_one_line(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert "kept: no baseline here" in complaint(HOLD, capsys)
    assert "small.json: no baseline" in complaint([*HOLD, "small.json"], capsys)
    assert "nothing: no such design" in complaint(["baseline", "nothing"], capsys)
    twice = ["baseline", "small.json", "./small.json", "--out", "kept"]
    assert "twice" in complaint(twice, capsys)


def test_the_committed_baseline_of_one_design_holds(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(ROOT)
    committed = ["--baseline", "reports/baseline", "--meshes", "meshes"]
    assert run(["regress", "two-segments", "gravity", *committed, *HERE]) == 0
    assert "of 2 designs" in capsys.readouterr().out


def test_a_rung_that_is_not_held_is_refused(kept: Path) -> None:
    assert regress(["small"], kept.parent, kept.parent, rungs=["beam"]).rungs == 1
    for rungs in (["torsion"], ["beam", "solid, wound"], ["beams"]):
        with pytest.raises(InputError, match=rf"{rungs[-1]}.*what is held: section, outline, "):
            regress(["small"], kept.parent, kept.parent, rungs=rungs)


@pytest.mark.parametrize(
    "name",
    ["gravity", "gripper.v2", "\x01\x7f", "\U0001f642 mm³", "\\u00e4"],
    ids=["a bundled one's", "with a point", "control", "beyond", "an escape"],
)
def test_designs_by_any_name(folder: Path, name: str, capsys: pytest.CaptureFixture[str]) -> None:
    file = str(saved(folder, name).relative_to(folder))
    assert run(["baseline", file, "--out", "kept", *HERE]) == 0
    text = (folder / "kept" / f"{name}.json").read_text(encoding="utf-8")
    assert "mm³" in text  # people read it
    assert json.loads(text)["name"] == name
    assert run(HOLD) == 0
    assert run([*HOLD, file]) == 0
    assert run([*HOLD, name]) == 0
    saved(folder, name, pressures=[0, 20, 50])
    assert "not the design that this was written of" in complaint([*HOLD, name], capsys)


def test_run_folders_are_told_apart(folder: Path) -> None:
    """By the scene and seed of their search; by the folder where there is none."""
    for name, notes in (("x", {}), ("y", {"scene": "sealed-section", "seed": 3})):
        (folder / "runs" / name).mkdir(parents=True)
        saved(folder / "runs" / name, "best", notes=notes)
    assert run(["baseline", "runs/x", "runs/y", "--out", "kept", *HERE]) == 0
    names = {file.name for file in (folder / "kept").glob("*.json")}
    assert names == {"provenance.json", "x.json", "sealed-section-3.json"}
    for given in ([], ["runs/x", "runs/y"], ["x", "sealed-section-3"]):
        assert run([*HOLD, *given]) == 0


def test_a_lost_baseline_of_the_package_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(ROOT)
    shutil.copytree(ROOT / "reports" / "baseline", tmp_path / "kept")
    assert {f"{name}.json" for name in BUNDLED} < {f.name for f in (tmp_path / "kept").iterdir()}
    (tmp_path / "kept" / "gravity.json").unlink()
    (tmp_path / "kept" / "pre-curved.json").unlink()
    there = ["regress", "--baseline", str(tmp_path / "kept"), "--meshes", "meshes", *HERE]
    assert "kept: no baseline of gravity, pre-curved: " in complaint(there, capsys)
    assert run([*there, "two-segments"]) == 0


def test_a_time_limit_is_no_move(
    kept: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    honest = femcheck.regression.rods.RodOnOutline.reply

    def late(self: Any, question: Any, workers: int = 0) -> Reply:
        reply = honest(self, question, workers)
        tips, endings = reply.tips.copy(), list(reply.endings)
        tips[3], endings[3] = np.nan, Ended(Status.TIME_OUT, 3.0)
        return Reply(tips, tuple(endings))

    monkeypatch.setattr(femcheck.regression.rods.RodOnOutline, "reply", late)
    capsys.readouterr()
    assert run([*HOLD, "--out", "moved.csv"]) == 3
    out = capsys.readouterr().out
    assert "rows: 0 moved" in out
    assert "1 not compared, time limit reached" in out
    assert "  beam of small: tips at 0, 20, 0 kPa" in out
    assert "lowest rung that moved" not in out
    assert "time limit reached" in Path("moved.csv").read_text()


def test_a_table_of_what_moved_is_written_anew_and_no_other_file(
    kept: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for _ in range(2):
        assert run([*HOLD, "--out", "moved.csv"]) == 0
    table = Path("moved.csv").read_text()
    Path("mine.csv").write_text("my,own\n1,2\n")
    assert "mine.csv" in complaint([*HOLD, "--out", "mine.csv"], capsys)
    assert Path("mine.csv").read_text() == "my,own\n1,2\n"
    assert run([*HOLD, "--out", "mine.csv", "--force"]) == 0
    assert Path("mine.csv").read_text() == table


def test_defaults_are_in_the_project(folder: Path) -> None:
    assert run(["baseline", "small.json", *HERE]) == 0
    assert {path.name for path in folder.iterdir()} == {"small.json", "baselines"}
    assert {path.name for path in (folder / "baselines").iterdir()} == {
        "small.json",
        "provenance.json",
    }
    assert run(["regress", *HERE]) == 0


def test_another_s_files_are_left_alone(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A run folder as `--out`, a design in the place of a baseline."""
    run_folder = folder / "run"
    run_folder.mkdir()
    for name in ("best.json", "provenance.json", "small.json"):
        (run_folder / name).write_text('{"mine": 1}')
    for force in ([], ["--force"]):
        complaint(["baseline", "small.json", "--out", "run", *HERE, *force], capsys)
    assert {path.read_text() for path in run_folder.iterdir()} == {'{"mine": 1}'}
    assert run(WRITE) == 0
    saved(folder / "kept", "other")
    saved(folder, "other")
    before = (folder / "kept" / "other.json").read_bytes()
    line = complaint(["baseline", "other.json", "--out", "kept", *HERE], capsys)
    assert "kept/other.json" in line
    assert "--force" in line
    assert (folder / "kept" / "other.json").read_bytes() == before


def test_an_update_in_a_test_does_not_write_over_a_design(folder: Path) -> None:
    (folder / "tests").mkdir()
    other = saved(folder / "tests", "other")
    before = other.read_bytes()
    design = find_design(str(saved(folder, "other")), folder / "tests")
    with pytest.raises(InputError):
        update_baseline(design, folder / "tests")
    assert other.read_bytes() == before
    assert {path.name for path in (folder / "tests").iterdir()} == {"other.json"}


@pytest.mark.parametrize("text", ["my mesh", "$MeshFormat\n2.2 0 8\n"])
def test_another_s_mesh_is_left_alone(
    folder: Path, monkeypatch: pytest.MonkeyPatch, text: str
) -> None:
    """One in the place of a section mesh, as of a program that shares the folder."""
    design = find_design(str(saved(folder, sealed=True)), folder)
    design.mesh.write_text(text)
    monkeypatch.setattr("femcheck.regression.regression.make_section", lambda design: None)
    monkeypatch.setattr("femcheck.regression.regression.measure_all", lambda *_, **__: None)
    assert design.has_solid
    for update in (
        lambda: hold_designs([str(folder / "small.json")], folder / "kept", folder),
        lambda: update_baseline(design, folder / "kept"),
    ):
        with pytest.raises(InputError) as caught:
            update()
        assert caught.value.where == str(design.mesh)
        assert design.mesh.read_text() == text
