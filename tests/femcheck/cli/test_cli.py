"""`femcheck run` as a person meets it: output, exit codes, one line for each mistake."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

import femcheck.cli.subjects
import femcheck.solved.picture
from femcheck.cli.application import run
from femcheck.continuation.direct import Pardiso
from tests.femcheck.check.small import Coarse, design_of, three_circles

NEO = ["disc.json", "--law", "neo-hookean"]
GENT = ["disc.json", "--law", "gent"]
OPEN = {"skin": 0, "wall": 0, "rounding": 0, "smallest_chamber": 0}
CHEAP = ["--element", "tet4", "--layers", "2", "--size", "9", "--workers", "1"]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(femcheck.solved.picture, "draw", lambda *scene: False)
    monkeypatch.setattr(femcheck.cli.subjects, "Subject", Coarse)
    design_of(three_circles()).save(tmp_path / "disc.json")
    stiff = {"shear_modulus": 150.0}
    design_of(three_circles(), actuator=stiff).save(tmp_path / "stiff.json")
    touching = {"supply": 1, "center": [12, 0], "radius": 4}
    design_of([touching, *three_circles()[1:]], seal=OPEN).save(tmp_path / "open.json")
    return tmp_path


def complaint(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    """What a bad call says: exit code 2, one line, nothing on standard output."""
    assert run(["run", *arguments]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("femcheck: ")
    assert err.count("\n") == 1
    return err


def test_agrees_or_not(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """0 within what was asked; on with the same cases, 1 when less is asked."""
    assert run(["run", "disc.json", *CHEAP, "--agree", "100%"]) == 0
    said = capsys.readouterr().out
    for word in ("disc", "section", "→ mesh", "unknowns", "implementation", "prediction", "files"):
        assert word in said
    assert "agrees: worst" in said
    assert (folder / "checks" / "disc" / "compare.csv").exists()
    before = json.loads((folder / "checks" / "disc" / "summary.json").read_text())
    assert run(["run", "disc.json", *CHEAP, "--agree", "0.0001", "--resume"]) == 1
    assert "differs: worst" in capsys.readouterr().out
    after = json.loads((folder / "checks" / "disc" / "summary.json").read_text())
    assert before["difference"] == after["difference"]
    assert (before["verdict"]["holds"], after["verdict"]["holds"]) == (True, False)


def test_a_failure_is_said_and_the_batch_goes_on(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """No mesh for either: both are reported, each in its folder, exit code 3."""
    other = folder / "found"
    other.mkdir()
    design_of(three_circles()[:2]).save(other / "best.json")
    crashing = folder / "crashing-gmsh"
    crashing.write_text("#!/bin/sh\nexit 3\n")
    crashing.chmod(0o755)
    assert run(["run", "disc.json", "found", *CHEAP, "--gmsh", str(crashing)]) == 3
    said = capsys.readouterr().out
    assert said.count("no answer: gmsh crashed: exit code 3") == 2
    for name in ("disc", "found"):
        text = json.loads((folder / "checks" / name / "summary.json").read_text())
        assert text["design"] == name
        assert not text["verdict"]["holds"]


def test_seal(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """An unsealed design is refused with the way out; the way out works and says what it moved."""
    said = complaint(["open.json", *CHEAP], capsys)
    assert "open.json" in said
    assert "--seal 1.0 seals a copy by a skin of 1 mm and says how far that moves" in said
    assert not (folder / "checks").exists()
    late = ["--seconds", "1e-9", "--out", "out"]
    assert run(["run", "open.json", *CHEAP, *late, "--seal", "1.0"]) == 3
    printed = capsys.readouterr().out
    assert "sealing moved the beam's tips by" in printed
    moved = json.loads((folder / "out" / "summary.json").read_text())["sealing_moved_mm"]
    assert moved["worst"] > moved["median"] > 0.01
    kept = json.loads((folder / "out" / "design.json").read_text())
    assert kept["seal"]["skin"] == 1.0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["missing.json"], ["missing.json", "no such design"]),
        (["disc.json", "disc.json"], ["disc.json", "a second design called disc"]),
        (["disc.json", "--agree", "nonsense"], ["--agree", "nonsense", "5% or 0.05"]),
        (["disc.json", "--agree", "0"], ["--agree", "above 0"]),
        (["disc.json", "--agree", "101%"], ["--agree", "at most 100%"]),
        (["disc.json", "--agree", "5%%"], ["--agree", "5%%"]),
        (["disc.json", "--gmsh", "no-such-gmsh"], ["--gmsh", "no-such-gmsh", "no such executable"]),
        (["disc.json", "--size", "1e-9"], ["--size", "1e-09", "0.1…10"]),
        (["disc.json", "--seal", "16"], ["--seal", "16", "leave room for chambers"]),
        (["disc.json", "--layers", "0"], ["--layers", "0", "2…64"]),
        (["disc.json", "--element", "hex8"], ["--element", "hex8", "wedge18"]),
        (["disc.json", "--law", "steel"], ["--law", "steel", "rigid-section"]),
        (["disc.json", "--solver", "mumps"], ["--solver", "mumps", "auto, pardiso, superlu"]),
        (["disc.json", "--size", "0"], ["--size", "0", "0.1…10"]),
        (["disc.json", "--size", "nan"], ["--size", "0.1…10"]),
        (["disc.json", "--seconds", "-1"], ["--seconds", "above 0"]),
        (["disc.json", "--gmsh-seconds", "0"], ["--gmsh-seconds", "above 0"]),
        (["disc.json", "--workers", "0"], ["--workers", "greater than or equal to 1"]),
        (["disc.json", "--seal", "-1"], ["--seal", "above 0"]),
        (["disc.json", "--nonsense"], ["--nonsense"]),
        (["disc.json", "--law", "foo"], ["--law", "foo", "rigid-section, neo-hookean, gent"]),
        (["disc.json", "--nu", "0.4"], ["--nu", "0.4", "rigid-section is no material"]),
        (["disc.json", "--wind", "outer"], ["--wind", "outer", "rigid-section is no material"]),
        (["disc.json", "--winding", "1e4"], ["--winding", "rigid-section is no material"]),
        (["disc.json", "--constant", "Jm=3"], ["--constant", "Jm=3", "is no material"]),
        ([*NEO, "--nu", "0.6"], ["--nu", "0.6", "0.5"]),
        ([*NEO, "--nu", "nan"], ["--nu", "nan"]),
        ([*NEO, "--nu", "-1"], ["--nu", "-1"]),
        ([*NEO, "--wind", "sideways"], ["--wind", "sideways", "chambers, outer, both"]),
        ([*NEO, "--winding", "1e4"], ["--winding", "--law wound or --wind"]),
        ([*NEO, "--wind", "outer", "--winding", "-1"], ["--winding", "-1", "N/m, above 0"]),
        ([*NEO, "--wind", "outer", "--winding", "nan"], ["--winding", "nan", "above 0"]),
        ([*NEO, "--wind", "outer", "--winding", "inf"], ["--winding", "inf", "above 0"]),
        ([*GENT, "--constant", "Jm"], ["--constant", "Jm", "NAME=NUMBER"]),
        ([*GENT, "--constant", "=3"], ["--constant", "=3", "NAME=NUMBER"]),
        ([*GENT, "--constant", "Jm=nan"], ["--constant", "Jm=nan", "NAME=NUMBER"]),
        ([*GENT, "--constant", "Jm=x"], ["--constant", "Jm=x", "NAME=NUMBER"]),
        ([*GENT, "--constant", "K=3"], ["--constant: K = 3", "gent takes Jm"]),
        ([*GENT, "--constant", "Jm=0"], ["--constant: Jm = 0", "above 0"]),
        ([*NEO, "--constant", "K=3"], ["--constant: K = 3", "neo-hookean takes no constants"]),
        ([*NEO, "--slenderness", "0"], ["--slenderness", "0", "H = 0.1 … 100000 mm, D = 30 mm"]),
        ([*NEO, "--slenderness", "-1"], ["--slenderness", "-1", "H/D"]),
        ([*NEO, "--slenderness", "nan"], ["--slenderness", "nan", "H/D"]),
        ([*NEO, "--slenderness", "1e9"], ["--slenderness", "H = 0.1 … 100000 mm"]),
        ([*NEO, "--element", "tet4"], ["--element", "tet4", "no stable pair", "wedge18"]),
        (["stiff.json", *NEO[1:]], ["actuator.shear_modulus", "150", "contradicts E = 300 kPa"]),
    ],
    ids=lambda value: " ".join(value[-2:]) if isinstance(value, list) else None,
)
def test_bad_input(
    folder: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], words: list[str]
) -> None:
    said = complaint(arguments, capsys)
    for word in words:
        assert word in said
    assert not (folder / "checks").exists()


def test_damaged_designs(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "broken.json").write_text('{"schema": "beamopt-design/1", ')
    assert "broken.json" in complaint(["broken.json"], capsys)
    (folder / "other.json").write_text('{"schema": "something/9"}')
    assert "this version reads beamopt-design/1" in complaint(["other.json"], capsys)
    (folder / "empty").mkdir()
    assert "best.json" in complaint(["empty"], capsys)


def test_a_folder_that_holds_something(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "out").mkdir()
    (folder / "out" / "notes.txt").write_text("mine")
    assert run(["run", "disc.json", "--out", "out", *CHEAP]) == 2
    said = capsys.readouterr().err
    assert "holds files already" in said
    assert said.count("\n") == 1


def test_pardiso_that_is_missing(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def missing(self: Pardiso) -> None:
        raise ImportError("pypardiso")

    monkeypatch.setattr(Pardiso, "__init__", missing)
    said = complaint(["disc.json", "--solver", "pardiso"], capsys)
    assert "not installed; auto or superlu" in said


def test_help_and_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["run", "--help"]) == 0
    said = capsys.readouterr().out
    for option in (
        *("--out", "--seal", "--agree", "--law", "--nu", "--constant", "--wind", "--winding"),
        *("--slenderness", "--workers", "--layers", "--size", "--element", "--solver"),
        *("--iterations", "--seconds", "--gmsh", "--gmsh-seconds", "--resume"),
    ):
        assert f"{option} " in said
    assert run(["--version"]) == 0
    assert capsys.readouterr().out.startswith("femcheck ")


def test_help_loads_no_heavy_library() -> None:
    code = (
        "import sys; from femcheck.cli.application import run; assert run(['run', '--help']) == 0;"
        "heavy = {'skfem', 'gmsh', 'pyvista', 'vtkmodules', 'meshio', 'pypardiso', 'matplotlib',"
        "'scipy', 'numba'}; print('loaded', sorted(heavy & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "loaded []"
