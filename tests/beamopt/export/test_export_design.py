"""`beamopt export`: the folder, what is refused, and that nothing is half done."""

import inspect
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from beamopt.base.errors import InputError
from beamopt.cli.application import run
from beamopt.export import export_design as export_run
from beamopt.export.export_design import FILES, FORMATS, ExportOptions, export_design
from beamopt.export.step import is_installed
from beamopt.outline.build import build_outline
from beamopt.outline.faults import summaries
from beamopt.scene.actuator import RodRules
from beamopt.scene.design import load_design
from beamopt.scene.seal_keys import Seal
from tests.beamopt.export.samples import SAMPLES, SEALED, drawn, random_section

LIGHT = ExportOptions(formats=("stl", "svg"))
COMMAND = "import sys; from beamopt.cli.application import run; sys.exit(run(sys.argv[1:]))"
ALWAYS = {"export.json", "provenance.json"}


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def complaint(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    """What a bad call says: exit code 2, one line, nothing on standard output."""
    assert run(arguments) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("beamopt: ")
    assert err.count("\n") == 1
    return err


def names_in(folder: Path) -> set[str]:
    return {item.name for item in folder.iterdir()}


def test_all_files_of_a_design(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["export", str(SEALED)]) == 0
    folder = here / "sealed_section-export"
    assert names_in(folder) == ALWAYS | set(FILES)
    said = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in said] == [f"sealed_section-export/{f}" for f in FILES]
    record = json.loads((folder / "export.json").read_text())
    assert [entry["name"] for entry in record["files"]] == list(FILES)
    for entry in record["files"]:
        assert (folder / entry["name"]).stat().st_size == entry["bytes"]
    outline = load_design(SEALED).outline
    areas, moments = record["area_mm2"], outline.moments
    assert areas["supplies"] == pytest.approx(moments.chamber_areas.tolist())
    assert areas["material_straight_edges"] == pytest.approx(moments.area)
    assert areas["material"] == pytest.approx(moments.area, rel=1e-9)  # with true circles
    volumes = {part["name"]: part["volume_ml"] for part in record["solids"]}
    assert volumes["body"] == pytest.approx(areas["material"] * 100 / 1000)
    assert record["sagitta_mm"] == pytest.approx(0.04)
    assert record["faults"] == []


def test_a_run_is_its_best_design(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (here / "run").mkdir()
    SAMPLES["open"]().save(here / "run" / "best.json")
    assert run(["export", "run", "--format", "svg", "--out", "out"]) == 0
    assert names_in(here / "out") == ALWAYS | {"section.svg"}
    said = capsys.readouterr()
    (line,) = said.out.splitlines()
    notes = said.err.splitlines()
    assert all(note.startswith("note: ") for note in notes)
    found = summaries(SAMPLES["open"]().findings)
    assert notes[1:] == [f"note: {one}" for one in found]
    assert any("a chamber is open (" in note for note in notes)
    assert line.startswith("out/section.svg  ")
    assert json.loads((here / "out" / "export.json").read_text())["design"] == "run"


def test_what_the_files_leave_out_is_said(here: Path) -> None:
    """A straight body of one section is not the actuator of segments, or of a curved mould."""
    segments = ({"share": 0.5}, {"share": 0.5, "turned": 60.0})
    rules = RodRules.model_validate({"segments": segments, "rest_curvature": (0.01, 0.0, 0.0)})
    design = load_design(SEALED).model_copy(update={"rod": rules})
    notes = export_design(design, "a", here / "out", ExportOptions(("svg",))).notes
    assert notes[0] == "one of 2 segments' sections, extruded over the whole length"
    assert "curved" in notes[1]
    assert json.loads((here / "out" / "export.json").read_text())["notes"] == list(notes)


def test_a_skin_or_wall_thinner_than_asked_is_said(here: Path) -> None:
    """Edges take a little off; finer ones do not, and then nothing is said."""
    design = random_section(3, skin=1.5)
    records, notes = [], []
    for tolerance in (None, 5e-4):
        options = ExportOptions(("svg",), tolerance=tolerance)
        notes.append(export_design(design, "a", here / f"{tolerance}", options).notes)
        records.append(json.loads((here / f"{tolerance}" / "export.json").read_text()))
    for record in records:
        assert record["asked_skin_mm"] == design.seal.skin == 1.5
        assert record["asked_wall_mm"] == design.seal.wall
    coarse, fine = records
    assert coarse["least_skin_mm"] < 0.995 * 1.5
    assert any(f"{coarse['least_skin_mm']:.3f} mm" in note for note in notes[0])
    assert fine["least_skin_mm"] == pytest.approx(1.5, abs=2e-3)
    assert not notes[1]


def test_the_tolerance_of_edges(here: Path) -> None:
    design = load_design(SEALED)
    sizes = []
    for tolerance in (0.2, None, 0.002):
        folder = here / f"{tolerance}"
        done = export_design(design, "a", folder, ExportOptions(("stl",), tolerance=tolerance))
        sizes.append(dict(done.files)["body.stl"])
    assert sizes[0] < sizes[1] < sizes[2]
    assert inspect.signature(build_outline).parameters["sagitta"].default is None


def test_the_same_bytes_in_every_process(here: Path) -> None:
    """Clocks, counters, and the order of sets must not show."""
    for seed in ("1", "4"):  # whose sets are ordered differently
        subprocess.run(
            [sys.executable, "-c", COMMAND, "export", str(SEALED), "--out", seed],
            check=True,
            env=os.environ | {"PYTHONHASHSEED": seed},
            capture_output=True,
        )
    for file in (*FILES, "export.json"):
        assert (here / "1" / file).read_bytes() == (here / "4" / file).read_bytes(), file


def test_what_is_not_its_own_is_left_alone(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mine = here / "mine"
    mine.mkdir()
    (mine / "body.stl").write_text("dear to me")
    line = complaint(["export", str(SEALED), "--out", "mine", "--format", "stl"], capsys)
    assert "mine: holds files but no export.json" in line
    assert (mine / "body.stl").read_text() == "dear to me"
    export_design(load_design(SEALED), "another", here / "taken", LIGHT)
    line = complaint(["export", str(SEALED), "--out", "taken", "--format", "stl"], capsys)
    assert "design = 'another'" in line
    assert "name another folder" in line
    (here / "file").write_text("")
    assert "file exists" in complaint(["export", str(SEALED), "--out", "file"], capsys)


def test_an_export_of_its_own_is_replaced(here: Path) -> None:
    design = load_design(SEALED)
    export_design(design, "a", here / "out", LIGHT)
    before = (here / "out" / "section.svg").read_bytes()
    (here / "out" / ".body.stl.123.tmp").write_text("what a kill left")
    (here / "out" / "notes.txt").write_text("mine")
    export_design(design, "a", here / "out", ExportOptions(formats=("svg",)))
    assert names_in(here / "out") == ALWAYS | {"section.svg", "notes.txt"}
    assert (here / "out" / "section.svg").read_bytes() == before


def test_an_interrupted_export_leaves_whole_files(
    here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    written: list[str] = []
    real = export_run.write_atomic

    def interrupted(path: Path, content: str | bytes) -> None:
        if len(written) == 2:
            monkeypatch.setattr(os, "fsync", lambda _: (_ for _ in ()).throw(KeyboardInterrupt))
        written.append(path.name)
        real(path, content)

    monkeypatch.setattr(export_run, "write_atomic", interrupted)
    design, out = load_design(SEALED), here / "out"
    with pytest.raises(KeyboardInterrupt):
        export_design(design, "a", out, LIGHT)
    assert names_in(out) == {"export.json", "body.stl"}
    monkeypatch.undo()
    monkeypatch.chdir(here)
    whole = (out / "body.stl").read_bytes()
    export_design(design, "a", out, LIGHT)
    assert names_in(out) == ALWAYS | {"body.stl", "cores.stl", "section.svg"}
    assert (out / "body.stl").read_bytes() == whole


def test_a_package_that_does_not_load_stops_only_what_was_asked_for_by_name(
    here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Installed, but without a library of the system, say: nothing is written by half."""
    monkeypatch.setattr("beamopt.export.step.KERNEL", Path("no such file.py"))
    with pytest.raises(InputError) as raised:
        export_design(load_design(SEALED), "a", here / "out", ExportOptions(formats=FORMATS))
    assert raised.value.key == "gmsh"
    assert not (here / "out").exists()
    made = export_design(load_design(SEALED), "a", here / "out")
    assert any(note.startswith("step is left out: ") for note in made.notes)
    others = {name for name, form in FILES.items() if form != "step"}
    assert names_in(here / "out") == {*others, "export.json", "provenance.json"}


@pytest.mark.parametrize(
    ("package", "form", "extra"), [("gmsh", "step", "fem"), ("ezdxf", "dxf", "export")]
)
def test_what_is_missing_is_named(
    package: str,
    form: str,
    extra: str,
    here: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    line = complaint(["export", str(SEALED), "--format", ",".join(FORMATS)], capsys)
    assert f"needs {package}: pip install 'beamopt[{extra}]', or leave {form} out" in line
    assert list(here.iterdir()) == []
    assert run(["export", str(SEALED), "--out", "out"]) == 0  # what can be written is
    said = capsys.readouterr().err.splitlines()
    assert f"note: {form} is left out: needs {package}: pip install 'beamopt[{extra}]'" in said
    other = {"step": "ezdxf", "dxf": "gmsh"}[form]
    can = [one for one in FORMATS if one != form and (one in ("stl", "svg") or is_installed(other))]
    written = {name for name, one in FILES.items() if one in can}
    assert names_in(here / "out") == {*written, "export.json", "provenance.json"}


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--format", "pdf"], "--format: 'pdf': any of step,stl,svg,dxf"),
        (["--format", ""], "--format"),
        (["--format", "stl", "--cap", "-1"], "--cap: '-1': 0 … 1000 mm"),
        (["--format", "stl", "--cap", "nan"], "--cap: 'nan'"),
        (["--format", "stl", "--tolerance", "0"], "--tolerance: '0'"),
        (["--format", "stl", "--tolerance", "nan"], "--tolerance: 'nan'"),
    ],
)
def test_misuse_is_one_line(
    arguments: list[str], said: str, here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert said in complaint(["export", str(SEALED), *arguments], capsys)
    assert list(here.iterdir()) == []


def test_polygons_that_touch_are_refused(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Two circles of one supply that meet in a point: no solid has such an edge."""
    touching = [{"supply": 1, "center": [17.0, y], "radius": 3.0} for y in (0.0, 6.0)]
    drawn(touching, Seal()).save(here / "touching.json")
    line = complaint(["export", "touching.json", "--format", "svg"], capsys)
    assert "no solid can be made of it: polygons of supply 1 touch" in line
    assert names_in(here) == {"touching.json"}


def test_nothing_heavy_is_loaded_for_the_command_line() -> None:
    code = "import sys, beamopt.cli.export; print({'gmsh', 'ezdxf', 'shapely'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"
