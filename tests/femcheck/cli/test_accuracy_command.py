"""`femcheck run --accuracy` as a person meets it."""

import csv
import json
from pathlib import Path

import pytest

from femcheck.cli.accuracy import accuracy_of
from femcheck.cli.application import run
from tests.femcheck.check.small import design_of, three_circles
from tests.femcheck.made_up import MadeUp, powers

NEO = ["--law", "neo-hookean"]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    design_of(three_circles()).save(tmp_path / "disc.json")
    return tmp_path


def asked(*arguments: str) -> int:
    return run(["run", "disc.json", "--accuracy", *arguments])


@pytest.mark.parametrize(
    ("text", "value"), [("0.1mm", 0.1), ("0.1 mm", 0.1), (" 2 ", 2.0), ("1e-3mm", 1e-3)]
)
def test_lengths(text: str, value: float) -> None:
    assert accuracy_of(text) == value


def test_the_beam_answers_its_own_law(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert asked("0.1mm") == 0
    said = capsys.readouterr().out
    for words in ("rigid-section", "a closed form", "beam", "accuracy reached", "processor time"):
        assert words in said
    summary = json.loads((folder / "checks" / "disc" / "summary.json").read_text())
    assert summary["reached"]
    assert summary["estimate_source"] == "CLOSED_FORM"
    assert (summary["compared_with"], summary["worst_estimate_mm"]) == ([], None)
    rows = list(csv.DictReader((folder / "checks" / "disc" / "tips.csv").read_text().splitlines()))
    assert {(row["estimate_mm"], row["difference_mm"]) for row in rows} == {("", "")}
    assert "nothing was compared" in said
    assert "0 mm" not in said.replace("0.1 mm", "").replace(" [mm]", "")
    assert asked("0.1mm") == 2
    assert "--resume goes on" in capsys.readouterr().err
    assert asked("0.1mm", "--resume") == 0


def test_a_solid_that_is_near_enough(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with MadeUp(powers(1.0, 2)).instead() as made:
        assert asked("0.5mm", *NEO, "--agree", "100%") == 0
    said = capsys.readouterr().out
    assert "only a solid answers neo-hookean" in said
    assert f"wedge18 {made.asked[-1].layers} layers" in said
    summary = json.loads((folder / "checks" / "disc" / "summary.json").read_text())
    assert summary["estimate_source"] == "COARSER"
    assert len(summary["compared_with"]) == len(made.asked) - 1
    assert said.count("tried") >= len(made.asked)


@pytest.mark.parametrize(
    ("made", "code", "words"),
    [
        (MadeUp(powers(1e4, 2)), 3, "accuracy not reached: the finest model's estimate is larger"),
        (MadeUp(powers(1.0, 2), missing=lambda model: range(27)), 1, "no combination has a tip"),
        (MadeUp(powers(1.0, 2), missing=lambda model: [7]), 1, "accuracy reached"),
    ],
    ids=["not reached", "no tip", "one tip not to be held against the beam"],
)
def test_what_does_not_end_with_0(
    folder: Path, capsys: pytest.CaptureFixture[str], made: MadeUp, code: int, words: str
) -> None:
    """1 where the actuator has no tip at a combination, 3 where that is not known."""
    with made.instead():
        assert asked("0.5mm", *NEO, "--agree", "100%") == code
    assert words in capsys.readouterr().out


def test_far_from_the_beam_ends_with_1(folder: Path) -> None:
    """Though the accuracy is reached: all tips are 4 mm beside the beam's."""
    with MadeUp(lambda model: 4.0).instead():
        assert asked("0.5mm", *NEO) == 1
    summary = json.loads((folder / "checks" / "disc" / "summary.json").read_text())
    assert summary["reached"]


def test_too_dear_ends_with_3(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with MadeUp(powers(1e4, 2)).instead():
        assert asked("0.5mm", *NEO, "--budget", "0.001") == 3
    assert "a finer solid is expected to take too long" in capsys.readouterr().out


def test_a_scene_is_a_design_too(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Under loads the rod answers, and no solid does."""
    assert run(["run", "gravity", "--accuracy", "1mm", "--out", "rod"]) == 0
    assert "loads make it a boundary-value problem" in capsys.readouterr().out
    assert run(["run", "gravity", "--accuracy", "1mm", "--out", "solid", "--rung", "solid"]) == 3
    assert "no model of this law can be made" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["ten"], ["--accuracy", "ten", "a length above 0, as 0.1mm"]),
        (["0"], ["--accuracy", "above 0"]),
        (["-1mm"], ["--accuracy"]),
        (["nan"], ["--accuracy", "nan"]),
        (["inf"], ["--accuracy", "inf"]),
        (["0.1cm"], ["--accuracy", "0.1cm"]),
        (["1e-400"], ["--accuracy"]),
        (["0.1", "--rung", "foo"], ["--rung", "foo", "auto, beam, solid"]),
        (["0.1", "--rung", "beam", "--law", "gent"], ["--rung", "beam", "no gent", "a solid"]),
        (["0.1", "--layers", "4"], ["--layers", "4", "chosen by --accuracy"]),
        (["0.1", "--size", "2"], ["--size", "2", "chosen by --accuracy"]),
        (["0.1", "--element", "tet10"], ["--element", "tet10", "chosen by --accuracy"]),
        (["0.1", "--budget", "0"], ["--budget", "above 0"]),
        (["0.1", "--budget", "nan"], ["--budget", "above 0"]),
        (["0.1", "--law", "steel"], ["--law", "steel"]),
        (["0.1", "--nu", "0.4"], ["--nu", "is no material"]),
        (["0.1", "--seal", "-1"], ["--seal"]),
    ],
    ids=" ".join,
)
def test_bad_input(
    folder: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], words: list[str]
) -> None:
    """One line, exit code 2, nothing left behind."""
    assert asked(*arguments) == 2
    err = capsys.readouterr().err
    assert err.startswith("femcheck: ")
    assert err.count("\n") == 1
    for word in words:
        assert word in err
    assert [path.name for path in folder.iterdir()] == ["disc.json"]


@pytest.mark.parametrize("option", [["--rung", "solid"], ["--budget", "9"]], ids=" ".join)
def test_options_that_go_with_an_accuracy(
    folder: Path, capsys: pytest.CaptureFixture[str], option: list[str]
) -> None:
    assert run(["run", "disc.json", *option]) == 2
    assert "goes with --accuracy" in capsys.readouterr().err


def test_designs_that_are_missing(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["run", "nothing.json", "--accuracy", "0.1"]) == 2
    assert "no such design" in capsys.readouterr().err
    assert run(["run", "disc.json", "disc.json", "--accuracy", "0.1"]) == 2
    assert "a second design called disc" in capsys.readouterr().err
    assert [path.name for path in folder.iterdir()] == ["disc.json"]
