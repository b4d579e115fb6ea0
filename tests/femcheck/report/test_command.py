"""`femcheck report`."""

from pathlib import Path

import pytest

import femcheck.report.page
from femcheck.cli.application import run
from tests.femcheck.report.folders import figure_folder


def test_it_writes_a_page_and_says_how_large(
    chart: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "report.html"
    assert run(["report", str(chart), "--out", str(out), "--title", "A <title>"]) == 0
    assert f"{out}  0.0" in capsys.readouterr().out
    assert "<title>A &lt;title&gt;</title>" in out.read_text()
    assert run(["report", str(chart), "--out", str(out)]) == 0  # over one of ours
    assert "<title>chart</title>" in out.read_text()


def test_it_writes_over_no_other_file(
    chart: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "thesis.html"
    out.write_text("<!doctype html><p>years of work")
    assert run(["report", str(chart), "--out", str(out)]) == 2
    assert "was not written by femcheck report; --force" in capsys.readouterr().err
    assert out.read_text().endswith("years of work")
    assert run(["report", str(chart), "--out", str(out), "--force"]) == 0
    assert "years of work" not in out.read_text()


@pytest.mark.parametrize("out", ["notes", "folder.html", "missing/report.html"])
def test_bad_names_are_refused(
    out: str, chart: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "folder.html").mkdir()
    assert run(["report", str(chart), "--out", str(tmp_path / out)]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "--out" in said or Path(out).parts[0] in said


def test_a_damaged_folder_leaves_the_page_as_it_was(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder, out = figure_folder(tmp_path / "chart"), tmp_path / "report.html"
    assert run(["report", str(folder), "--out", str(out)]) == 0
    before = out.read_text()
    (folder / "provenance.json").write_text("{")
    assert run(["report", str(folder), "--out", str(out)]) == 2
    assert "provenance.json" in capsys.readouterr().err
    assert out.read_text() == before


def test_a_page_that_is_too_large_is_said_to_be(
    chart: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "report.html"
    assert run(["report", str(chart), "--out", str(out)]) == 0
    assert "above" not in capsys.readouterr().out
    with out.open() as stream:
        head = stream.read(500)
    monkeypatch.setattr(femcheck.report.page, "report_page", lambda *_: head + 8_000_000 * " ")
    assert run(["report", str(chart), "--out", str(out)]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[-1].startswith("note: above 8 MB")
    assert len(said) == 2
