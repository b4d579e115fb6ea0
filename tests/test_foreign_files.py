"""Nothing is written over or deleted that the same command did not write, by any command."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

import beamopt.cli.application
import femcheck.cli.application
from beamopt.scene.bundled import bundled_scenes
from beamopt.storage.file_lock import locked
from beamopt.storage.result_folder import LOCK
from tests.femcheck.regression.small import small_design
from tests.validation.resume import everything

ROOT = Path(__file__).resolve().parents[1]
SCENES = next(iter(bundled_scenes().values())).parent
OPEN, SEALED = SCENES / "hand_drawn_section.json", SCENES / "sealed_section.json"
SMALL = "small.json"  # in the working directory

COMMANDS = {
    "optimize": ["optimize", "hand-drawn-section"],
    "refine": ["refine", str(OPEN), "--scene", "hand-drawn-section"],
    "study": ["study", "--iterations", "1"],
    "pareto": ["pareto", "random-section", "--objectives", "L,mass"],
    "bound": ["bound", "hand-drawn-workspace"],
    "chart of rods": ["chart", "gravity"],
    "map of rods": ["stability", "--samples", "1"],
    "export": ["export", str(OPEN), "--format", "svg"],
    "check": ["femcheck", "run", SMALL],
    "prediction": ["femcheck", "run", SMALL, "--law", "neo-hookean"],
    "accuracy": ["femcheck", "run", SMALL, "--accuracy", "1mm"],
    "chart": ["femcheck", "chart", SMALL],
    "map": ["femcheck", "stability"],
    "map again": ["femcheck", "stability", "--redraw"],
    "baseline": ["femcheck", "baseline", "hand_drawn_section"],
}
"""Every command that writes a folder."""

GO_ON = {"optimize", "study", "pareto", "map of rods", "check", "prediction"}
GO_ON |= {"accuracy", "chart", "map"}

FOREIGN = {
    "journal.jsonl": '{"mine": 1}',  # a line without an end
    **dict.fromkeys(("scene.toml", "chart.csv", "front.csv", "table.csv", "mesh.msh"), "mine\n"),
    **dict.fromkeys(("best.json", "check.json", "study.json", "export.json"), '{"my": "own"}'),
    **dict.fromkeys(("bound.json", "design.json", "front-000.json"), '{"my": "own"}'),
    **dict.fromkeys(("provenance.json", "timing.csv", "bound.png", "target.csv"), "mine"),
    ".front.csv.12.tmp": "mine",
}

ALONE = ("journal.jsonl", "scene.toml", "check.json", "study.json", "export.json", "bound.json")
ALONE += ("design.json", "provenance.json")


@pytest.fixture(autouse=True)
def place(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> None:
    """A working directory with a small design that has a solid."""
    folder = tmp_path_factory.mktemp("place")
    small_design(sealed=True).save(folder / SMALL)
    monkeypatch.chdir(folder)


def ends(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> tuple[int, str]:
    """Exit code, and what stands on standard error."""
    capsys.readouterr()
    if arguments[0] == "femcheck":
        code = femcheck.cli.application.run(arguments[1:])
    else:
        code = beamopt.cli.application.run(arguments)
    return code, capsys.readouterr().err


def refused(name: str, out: Path, capsys: pytest.CaptureFixture[str]) -> str:
    """The one line that a command ends with, gone on with where it can."""
    going_on = ["--resume"] if name in GO_ON else []
    code, said = ends([*COMMANDS[name], "--out", str(out), *going_on], capsys)
    lines = [line for line in said.splitlines() if not line.startswith("note: ")]
    assert code == 2, said
    assert len(lines) == 1, said
    return lines[0]


@pytest.mark.parametrize("name", COMMANDS)
def test_a_second_writer_is_refused(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("beamopt.storage.file_lock.PATIENCE", 0.0)
    if name == "map again":
        shutil.copy(ROOT / "reports" / "stability" / "journal.jsonl", tmp_path)
    with locked(tmp_path / LOCK):
        before = everything(tmp_path)
        said = refused(name, tmp_path, capsys)
        assert everything(tmp_path) == before
    assert str(tmp_path) in said
    assert "another process is writing" in said


@pytest.mark.parametrize("name", COMMANDS)
def test_another_s_folder_is_left_as_it_is(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """All files together, then some alone: none under any name is taken for the command's own."""
    folders = [FOREIGN, *({file: FOREIGN[file]} for file in ALONE)]
    for number, files in enumerate(folders):
        folder = tmp_path / str(number)
        folder.mkdir()
        for file, text in files.items():
            (folder / file).write_text(text)
        before = everything(folder)
        refused(name, folder, capsys)
        assert everything(folder) == before


@pytest.mark.parametrize("name", COMMANDS)
def test_nothing_is_followed_through_links(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder, other = tmp_path / "folder", tmp_path / "other"
    folder.mkdir()
    other.write_text("mine")
    for file in ("journal.jsonl", "best.json", "provenance.json", "cases", "runs"):
        (folder / file).symlink_to(other)
        refused(name, folder, capsys)
        assert (folder / file).is_symlink()
        (folder / file).unlink()
        assert other.read_text() == "mine"
    assert everything(folder) == {}


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_a_figure_of_show_is_drawn_again_and_no_other_file(
    ending: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / f"shown.{ending}"
    command = ["show", str(OPEN), "--out", str(out)]
    assert ends(command, capsys)[0] == 0
    drawn = out.read_bytes()
    assert ends(command, capsys)[0] == 0
    assert out.read_bytes() == drawn
    mine = tmp_path / f"mine.{ending}"
    mine.write_bytes(drawn.replace(b"beamopt show", b"somebody 1.2"))
    before = mine.read_bytes()
    command[-1] = str(mine)
    assert ends(command, capsys)[0] == 2
    assert mine.read_bytes() == before
    assert ends([*command, "--force"], capsys)[0] == 0
    assert mine.read_bytes() == drawn


def test_a_figure_of_show_is_not_written_through_a_link(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    (tmp_path / "shown.png").symlink_to(tmp_path / "mine.txt")
    command = ["show", str(OPEN), "--out", str(tmp_path / "shown.png"), "--force"]
    assert ends(command, capsys)[0] == 2
    assert (tmp_path / "mine.txt").read_text() == "mine"
