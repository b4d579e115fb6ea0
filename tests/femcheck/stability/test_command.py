"""`femcheck stability` as a person meets it."""

from pathlib import Path

import pytest

import femcheck.cli.stability
from beamopt.base.processes import in_process
from femcheck.cli.application import run
from femcheck.stability.stability_map import run_map
from tests.femcheck.stability.small import axes_of, kept_files


@pytest.fixture
def folder(told: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    def here(*given: object, **asked: object) -> object:
        return run_map(*given, pool=in_process, **asked)  # type: ignore[arg-type]

    monkeypatch.setattr(femcheck.cli.stability, "AXES", axes_of())
    monkeypatch.setattr(femcheck.cli.stability, "run_map", here)
    return tmp_path / "map"


def test_made_and_drawn_again(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["stability", "--out", str(folder), "--workers", "1"]) == 0
    said = capsys.readouterr().out
    assert "1 at once, OMP_NUM_THREADS=" in said
    assert "21 of 21 tasks, 0.0 min left" in said
    assert "15 cells say what the line says, 0 the opposite" in said
    before = kept_files(folder)
    assert "stability.svg" in before
    assert run(["stability", "--out", str(folder), "--redraw"]) == 0
    assert run(["stability", "--out", str(folder), "--resume"]) == 0
    assert kept_files(folder) == before


def test_one_panel(folder: Path) -> None:
    assert run(["stability", "--out", str(folder), "--axis", "other"]) == 0
    assert "length" not in (folder / "cases.csv").read_text()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--axis", "colour"], "--axis: 'colour': one of length, other"),
        (["--axis", "other", "--redraw"], "--axis: 'other': --redraw draws all that is there"),
        (["--redraw"], "journal.jsonl: no such file: there is no map to draw again"),
        (["--workers", "0"], "Invalid value"),
    ],
)
def test_mistakes(
    folder: Path, arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["stability", "--out", str(folder), *arguments]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("femcheck: ")
    assert said in err
    assert err.count("\n") == 1


def test_a_folder_in_use(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder.mkdir()
    (folder / "mine.txt").write_text("mine")
    assert run(["stability", "--out", str(folder)]) == 2
    assert "holds files already" in capsys.readouterr().err
    assert run(["stability", "--out", str(folder), "--resume"]) == 2
    assert "no journal.jsonl" in capsys.readouterr().err
