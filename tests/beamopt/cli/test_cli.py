"""The command line as a person meets it: output, exit codes, one line for each mistake."""

import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from beamopt.cli.application import run
from beamopt.scene.bundled import bundled_scenes
from beamopt.scene.design import load_design
from beamopt.scene.scene import Scene, load_scene
from beamopt.search.optimize import optimize
from tests.validation.resume import command, content

SHORT = ("--set", "search.generations=2")
DRAWN = bundled_scenes()["hand-drawn-section"].with_name("hand_drawn_section.json")


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("package", ["beamopt", "femcheck"])
def test_a_package_runs_as_a_command(package: str) -> None:
    asked = [sys.executable, "-m", package, "--version"]
    done = subprocess.run(asked, capture_output=True, text=True, check=True)
    assert done.stdout.startswith(package)


def complaint(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    """What a bad call says: exit code 2, one line, nothing on standard output."""
    assert run(arguments) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("beamopt: ")
    assert err.count("\n") == 1
    return err


def test_optimize_says_what_it_found(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["optimize", "hand-drawn-section", "--seed", "3", *SHORT]) == 0
    said = capsys.readouterr().out
    for word in ("L ", "RMS distance", "K ", "T = L + K", "islands", "time", "files"):
        assert word in said
    assert "runs/hand-drawn-section-3/" in said
    assert (here / "runs" / "hand-drawn-section-3" / "best.json").exists()


def test_workers_and_resume(here: Path) -> None:
    start = ["optimize", "random-section", "--out", "run", "--workers", "2"]
    assert run([*start, *SHORT]) == 0
    assert run([*start, "--set", "search.generations=3", "--resume"]) == 0
    assert json.loads((here / "run" / "summary.json").read_text())["generations"] == 3


def test_tips_as_csv_have_all_digits(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["tips", str(DRAWN), "--csv"]) == 0
    header, *rows = capsys.readouterr().out.splitlines()
    assert header == "p1,p2,p3,x,y,z"
    table = np.array([row.split(",") for row in rows], dtype=float)
    space = load_design(DRAWN).workspace
    np.testing.assert_array_equal(table, np.hstack([space.pressures, space.tips]))


def test_tips_at_given_pressures(capsys: pytest.CaptureFixture[str]) -> None:
    given = ["--pressures", "10,0,0", "--pressures", "0,2.5,0"]
    assert run(["tips", str(DRAWN), "--csv", *given]) == 0
    rows = capsys.readouterr().out.splitlines()[1:]
    assert [row.split(",")[:3] for row in rows] == [["10.0", "0.0", "0.0"], ["0.0", "2.5", "0.0"]]


def test_tips_as_a_table(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["tips", str(DRAWN)]) == 0
    said = capsys.readouterr().out
    assert "p1 [kPa]" in said
    assert "x [mm]" in said
    assert "-31.566" in said


def test_show_draws_and_says_where(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["show", str(DRAWN), "--out", "drawn.svg"]) == 0
    assert (here / "drawn.svg").read_text().startswith("<?xml")
    said = capsys.readouterr().out
    assert "drawn.svg" in said
    assert "111" in said  # the section in the terminal
    assert "222" in said


def test_show_a_run_over_its_target(here: Path) -> None:
    optimize(load_scene("random-section", ["search.generations=1"]), here / "run", figures=False)
    before = content(here / "run")
    assert run(["show", "run"]) == 0
    assert (here / "run.png").read_bytes().startswith(b"\x89PNG")
    assert content(here / "run") == before


HOSTILE = {
    "deep.json": b"[" * 100_000,
    "deep.toml": b"a = " + b"[" * 100_000,
    "digits.json": b'{"schema": ' + b"1" * 5000 + b"}",
    "digits.toml": b"a = " + b"1" * 5000,
    "nul.toml": b'[target]\nkind = "section"\nfile = "a\\u0000b"',
    "cell.csv": b"p1,p2,p3,x,y,z\n" + b"1" * 200_000,
    "latin.toml": b"name = '\xe9'",
}


@pytest.mark.parametrize("name", list(HOSTILE))
def test_hostile_files(name: str, here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (here / name).write_bytes(HOSTILE[name])
    if name.endswith(".csv"):
        scene = f'[target]\nkind = "workspace"\nfile = "{name}"'
        (here / "scene.toml").write_text(scene)
    call = ["tips", name] if name.endswith(".json") else ["optimize", name]
    complaint(["optimize", "scene.toml"] if name.endswith(".csv") else call, capsys)
    assert not (here / "runs").exists()


def test_a_byte_order_mark_is_no_matter(here: Path) -> None:
    (here / "bom.json").write_bytes(b"\xef\xbb\xbf" + DRAWN.read_bytes())
    assert run(["tips", "bom.json"]) == 0


def test_version_and_help(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["--version"]) == 0
    assert capsys.readouterr().out.startswith("beamopt 0.")
    assert run([]) == 2
    out, err = capsys.readouterr()
    assert "optimize" in out
    assert err == ""


def test_tips_of_a_run(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    result = optimize(load_scene("random-section", ["search.generations=1"]), here / "run")
    capsys.readouterr()
    assert run(["tips", "run", "--csv"]) == 0
    last = capsys.readouterr().out.splitlines()[-1].split(",")
    assert [float(cell) for cell in last[3:]] == result.best.workspace.tips[-1].tolist()


def test_scenes_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["scenes"]) == 0
    said = capsys.readouterr().out
    assert all(name in said for name in bundled_scenes())


def test_init_writes_a_scene_that_runs(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["init", "mine.toml"]) == 0
    assert load_scene(here / "mine.toml") == Scene()
    assert run(["optimize", "mine.toml", *SHORT]) == 0
    capsys.readouterr()
    assert "exists already" in complaint(["init", "mine.toml"], capsys)


def test_init_from_a_bundled_scene_stands_on_its_own(here: Path) -> None:
    assert run(["init", "mine.toml", "--scene", "hand-drawn-workspace"]) == 0
    assert load_scene(here / "mine.toml").target.file == str(here / "hand_drawn_workspace.csv")
    assert str(here) not in (here / "mine.toml").read_text()


MISTAKES = [
    (["optimize", "random-section", "--set", "grid.raidal=3"], "--set: grid.raidal = 3"),
    (["optimize", "random-section", "--set", "search.generations=3\nfoo=1"], "--set"),
    (["optimize", "random-section", "--set", "search.seed=" + "9" * 5000], "search.seed"),
    (["optimize", "random-section", "--set", "a=" + "[" * 5000], "--set: a"),
    (["optimize", "random-section", "--set", "a" + ".a" * 3000 + "=1"], "at most 16 parts"),
    (["optimize", "nowhere.toml"], "no such scene; a path, or one of: gravity, hand-drawn-section"),
    (["optimize", "random-section", "--seed", "-1"], "--seed"),
    (["optimize", "random-section", "--workers", "0"], "--workers"),
    (["optimize", "random-section", "--set", "search.population=1"], "2 … 10000"),
    (["optimize", "random-section", "--set", "grid=3"], "grid"),
    (["optimize", "random-section", "--frobnicate"], "--frobnicate"),
    (["optimize"], "Missing argument"),
    (["frobnicate"], "frobnicate"),
    (["tips", "absent.json"], "absent.json"),
    (["tips", str(DRAWN), "--pressures", "1,2"], "three numbers"),
    (["tips", str(DRAWN), "--pressures", "1,2,-3"], "0 … 2000 kPa"),
    (["tips", str(DRAWN), "--pressures", "1,2,nan"], "three numbers"),
    (["show", "absent.json"], "absent.json"),
    (["show", str(DRAWN), "--out", "figure.gif"], ".png, .svg, .pdf"),
    (["show", str(DRAWN), "--out", "no/such/folder/f.png"], "no/such/folder: no such folder"),
    (["init", "x.toml", "--scene", "nope"], "random-section"),
    (["study", "--out", "s", "--iterations", "0"], "--iterations"),
    (["study", "--out", "s", "--set", "search.generations=many"], "search.generations"),
    (["study", "--out", "s", "--set", "search.mutation=direct"], "a study decides"),
    (["init", "no/such/x.toml"], "no/such"),
]


@pytest.mark.parametrize(("arguments", "named"), MISTAKES, ids=[" ".join(m[0]) for m in MISTAKES])
def test_mistakes(
    arguments: list[str], named: str, here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert named in complaint(arguments, capsys)
    assert list(here.iterdir()) == []


def test_a_folder_that_can_not_be_made(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (here / "file").write_text("not a folder")
    for out in ("file", "file/run"):
        said = complaint(["optimize", "random-section", "--out", out], capsys)
        assert said.startswith(f"beamopt: {out}: ")
    assert "file" in complaint(["study", "--out", "file/study"], capsys)


def _heeds_ctrl_c() -> None:
    """What a shell starts in the background ignores it, and so do all that it starts."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def test_ctrl_c_leaves_a_valid_run(here: Path) -> None:
    """A real interrupt to a real process; takes a few seconds to start it twice."""
    arguments = ["optimize", "random-section", "--out", "run", "--set", "search.generations=100000"]
    with subprocess.Popen(
        command(*arguments), stdout=subprocess.PIPE, text=True, preexec_fn=_heeds_ctrl_c
    ) as process:
        journal = here / "run" / "journal.jsonl"
        patience = time.monotonic() + 60
        while not (journal.exists() and journal.stat().st_size > 10_000):
            assert time.monotonic() < patience
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        try:
            said, _ = process.communicate(timeout=60)
        finally:
            process.kill()  # which a process that has ended does not notice
    assert process.returncode == 130
    assert "interrupted" in said
    assert "--resume" in said
    load_design(here / "run" / "best.json")


def test_the_command_line_starts_without_numerics() -> None:
    """`beamopt --help` loads no numba, numpy, matplotlib; nor anything of the solid check."""
    heavy = [
        "numba",
        "numpy",
        "scipy",
        "matplotlib",
        "pydantic",
        "gmsh",
        "skfem",
        "pyvista",
        "meshio",
        "femcheck",
    ]
    code = (
        "import sys; from beamopt.cli.application import run; run(['--help']);"
        f"print([name for name in {heavy} if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"
