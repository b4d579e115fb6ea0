"""A prediction by `femcheck run`: what is printed, and the exit codes."""

import json
import shutil
from pathlib import Path

import pytest

import femcheck.cli.subjects
import femcheck.prediction.predict_design
import femcheck.solved.picture
from femcheck.cli.application import run
from femcheck.prediction.prediction import Prediction
from femcheck.prediction.verdict import advice, verdict
from tests.femcheck.check.small import Coarse
from tests.femcheck.prediction.small import soft_subject

pytestmark = pytest.mark.usefixtures("undrawn")
Done = tuple[Prediction, Path]
CHEAP = ["--law", "neo-hookean", "--layers", "2", "--size", "9", "--workers", "1"]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(femcheck.cli.subjects, "Subject", Coarse)
    return tmp_path


def resumed(done: Done, folder: Path, *more: str) -> int:
    """A run that goes on with what was predicted elsewhere: the same question by options."""
    found, kept = done
    found.subject.design.save(folder / "soft.json")
    shutil.copytree(kept, folder / "out")
    return run(["run", "soft.json", "--out", "out", "--resume", *CHEAP, *more])


def test_without_a_stable_workspace_it_ends_with_1(
    limited: Done, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert resumed(limited, folder) == 1
    printed = capsys.readouterr().out
    found, _ = limited
    lines = [" ".join(line.split()) for line in printed.splitlines()]
    assert f"prediction {verdict(found)}" in lines
    assert advice(found) in lines
    assert printed.count("limit point at P = ") >= 19
    for word in ("material", "neo-hookean", "μ/2", "H/D = 3.33", "standard mesh", "coarse mesh"):
        assert word in printed
    assert "nan" not in printed


def test_with_a_stable_workspace_it_is_the_beam_that_decides(
    calm: Done, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """0 where the beam is near enough to what was asked, else 1."""
    assert resumed(calm, folder, "--agree", "100%") == 0
    assert "the beam holds" in capsys.readouterr().out
    again = ["run", "soft.json", "--out", "out", "--resume", *CHEAP, "--agree", "5%"]
    assert run(again) == 1
    assert "the beam can not be trusted" in capsys.readouterr().out
    said = json.loads((folder / "out" / "summary.json").read_text())
    assert said["verdict"]["holds"] is False


def test_no_time_is_no_crash(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    soft_subject().design.save(folder / "soft.json")
    late = ["--seconds", "1e-9", "--wind", "chambers", "--slenderness", "2", "--nu", "0.4"]
    assert run(["run", "soft.json", *CHEAP, *late]) == 3
    printed = capsys.readouterr().out
    assert "time limit reached" in printed
    assert "H = 60 mm, H/D = 2" in printed
    assert "chambers, 100000 N/m" in printed
    assert "displacements" in printed
    kept = json.loads((folder / "checks" / "soft" / "design.json").read_text())
    assert kept["actuator"]["length"] == 60


def test_another_question_in_the_same_folder_is_one_line(
    limited: Done, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert resumed(limited, folder, "--nu", "0.49") == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert "question.poisson_ratio = 0.5" in err
    assert "now asked for: 0.49" in err


def test_a_check_and_a_prediction_do_not_share_a_folder(
    limited: Done, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert resumed(limited, folder, "--law", "rigid-section") == 2
    err = capsys.readouterr().err
    assert err.count("\n") == 1
    assert "neo-hookean" in err
