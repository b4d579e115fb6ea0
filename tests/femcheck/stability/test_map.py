"""A map is made, killed, gone on with and drawn again, and its files are the same."""

import json
from pathlib import Path

import pytest

import femcheck.stability.work
from beamopt.base.errors import InputError
from beamopt.base.processes import processes
from beamopt.storage.line_journal import LineJournal
from femcheck.stability.ending import MapEnding
from femcheck.stability.journal import ASKED, line_of, results_in
from femcheck.stability.solve import CellResult, TraceResult
from femcheck.stability.specimen import Specimen
from femcheck.stability.stability_map import FILES, redraw_map
from tests.femcheck.stability.small import (
    DEADLY,
    an_axis,
    axes_of,
    kept_files,
    make,
    told_cell,
    told_row,
)
from tests.journals import flipped

pytestmark = pytest.mark.usefixtures("told")


@pytest.fixture
def whole(tmp_path: Path) -> Path:
    make(tmp_path / "whole")
    return tmp_path / "whole"


def test_files(whole: Path) -> None:
    assert {file.name for file in whole.iterdir()} == {
        "journal.jsonl",
        *(name for name in FILES if not name.startswith("stability")),
    }
    cases = (whole / "cases.csv").read_text().splitlines()
    assert len(cases) == 1 + 5 * 3
    assert "seconds" not in cases[0]
    assert "other,13,4.0,no mesh," in "\n".join(cases)


def test_times_stand_in_one_file(whole: Path) -> None:
    head, *lines = (whole / "timing.csv").read_text().splitlines()
    assert head == "axis,column,task,seconds"
    assert len(lines) == 5 * 3 + 5 + 1
    assert "length,60,4 kPa,0.5" in lines
    assert "length,60,path on the finer mesh,0.0" in lines


def test_limits(whole: Path) -> None:
    """Row by row: found, on the finer mesh, in closed form."""
    head, *lines = (line.split(",") for line in (whole / "limits.csv").read_text().splitlines())
    rows = {line[1]: dict(zip(head, line, strict=True)) for line in lines}
    assert rows["60"]["limit_kPa"] == rows["60"]["finer_kPa"] == "6.0"
    assert rows["60"]["coarse_over_finer"] == "1.0"
    assert rows["60"]["snaps_kPa"] == "1.5"
    assert rows["90"]["exact_kPa"] == "10.0"
    assert rows["90"]["over_exact"] == "0.9"
    assert rows["130"]["limit_kPa"] == ""
    assert rows["130"]["status"] == "stable equilibrium"
    assert [rows[name]["ended"] for name in ("60", "130")] == ["LIMIT_POINT", "STABLE"]
    assert rows["60"]["finer_ended"] == "LIMIT_POINT"


def test_validity(whole: Path) -> None:
    """|0.2 − 0.02 P| is within 0.05 from 7.5 kPa on: to the end of 90 mm, and of 130 mm at 12."""
    lines = (whole / "validity.csv").read_text().splitlines()
    assert "length,60,nowhere,,," in lines
    assert "length,90,between,7.5,8.0,the end of the path" in lines
    assert "length,130,between,7.5,12.0,the end of the path" in lines


def test_two_processes(whole: Path, tmp_path: Path) -> None:
    make(tmp_path / "two", workers=2, pool=processes)
    assert kept_files(tmp_path / "two") == kept_files(whole)


@pytest.mark.parametrize("left", [0, 1, 40, 900, 2000, 3000])
def test_killed_anywhere(whole: Path, tmp_path: Path, left: int) -> None:
    """What a kill leaves of the journal, half lines included, is gone on with."""
    cut = tmp_path / "cut"
    cut.mkdir()
    (cut / "journal.jsonl").write_bytes((whole / "journal.jsonl").read_bytes()[:left])
    make(cut, resume=True)
    assert kept_files(cut) == kept_files(whole)
    redraw_map(cut, axes_of(), figures=False)  # and its journal is whole
    assert kept_files(cut) == kept_files(whole)


def test_nothing_is_solved_twice(whole: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(femcheck.stability.work, "solve_cell", None)
    monkeypatch.setattr(femcheck.stability.work, "trace_row", None)
    before = kept_files(whole), (whole / "journal.jsonl").read_bytes()
    make(whole, resume=True)
    assert (kept_files(whole), (whole / "journal.jsonl").read_bytes()) == before


def test_redrawn_without_solving(whole: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(femcheck.stability.work, "solve_cell", None)
    computed = json.loads((whole / "provenance.json").read_text())
    assert computed["workers"] == 1
    before = kept_files(whole)
    for name in before:
        (whole / name).unlink()
    redraw_map(whole, axes_of(), figures=False)
    assert kept_files(whole) == before
    assert json.loads((whole / "provenance.json").read_text()) == computed


def test_panel_by_panel(whole: Path, tmp_path: Path) -> None:
    parts = tmp_path / "parts"
    make(parts, wanted=["other"])
    assert "length" not in (parts / "cases.csv").read_text()
    make(parts, wanted=["length"], resume=True)
    assert kept_files(parts) == kept_files(whole)


def test_the_finer_path_is_on_the_finer_mesh(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    followed: list[tuple[int, float, int]] = []

    def seen(specimen: Specimen, pressures: tuple[float, ...]) -> TraceResult:
        followed.append((specimen.layers, specimen.size, len(pressures)))
        return told_row(specimen, pressures)

    monkeypatch.setattr(femcheck.stability.work, "trace_row", seen)
    make(tmp_path / "map", axes=axes_of(an_axis(lengths=(60.0, 90.0))))
    assert followed == [(2, 4.0, 3), (3, 2.0, 1), (2, 4.0, 3)]


def test_a_process_that_dies(tmp_path: Path) -> None:
    """The cell under which it dies is stopped, the others are solved; resuming tries it again."""
    axes = axes_of(an_axis(lengths=(60.0, DEADLY)))
    (found,) = make(tmp_path / "map", axes=axes, workers=2, pool=processes)
    first, second = found.rows
    assert [cell.ending for cell in first.cells if cell] == [
        MapEnding.STABLE,
        *2 * [MapEnding.LIMIT_POINT],
    ]
    assert [cell.ending for cell in second.cells if cell] == 3 * [MapEnding.STOPPED]
    assert second.trace is not None
    assert second.trace.critical == pytest.approx(6.6)


def test_what_was_stopped_is_tried_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stopped = CellResult(MapEnding.STOPPED)
    monkeypatch.setattr(femcheck.stability.work, "solve_cell", lambda *task: stopped)
    make(tmp_path / "map")
    monkeypatch.setattr(femcheck.stability.work, "solve_cell", told_cell)
    found = make(tmp_path / "map", resume=True)
    endings = {cell.ending for one in found for row in one.rows for _, cell in row.solved}
    assert endings == {MapEnding.STABLE, MapEnding.LIMIT_POINT, MapEnding.NO_MESH}


def test_another_question_is_refused(whole: Path) -> None:
    other = axes_of(an_axis(lengths=(61.0, 90.0, 130.0)))
    with pytest.raises(InputError, match=r"axis length.*another map"):
        make(whole, axes=other, resume=True)
    fewer = axes_of(an_axis(lengths=(60.0,)))
    with pytest.raises(InputError, match="another map"):
        redraw_map(whole, fewer)


@pytest.mark.parametrize(
    "text",
    [
        "rubbish\n",
        '{"schema": "beamopt-stability/1"}\n',
        '{"schema": "femcheck-stability/1"}\n[]\n',
    ],
)
def test_another_file_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / "journal.jsonl").write_text(text)
    with pytest.raises(InputError, match=r"journal\.jsonl"):
        make(tmp_path, resume=True)


def test_a_folder_that_is_in_use_is_refused(whole: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="--resume"):
        make(whole)
    with pytest.raises(InputError, match="no map to draw again"):
        redraw_map(tmp_path / "nowhere", axes_of())
    LineJournal(tmp_path / "journal.jsonl", ASKED, "map")
    with pytest.raises(InputError, match="holds nothing"):
        redraw_map(tmp_path, axes_of())


def test_a_line_says_all_there_is_to_know(tmp_path: Path) -> None:
    axes = axes_of()
    axis = axes["length"]
    specimen: Specimen = axis.columns[1].specimen
    results = {
        ("length", 1, -1): told_row(specimen, axis.pressures),
        ("length", 1, 0): told_cell(specimen, 4.0),
        ("length", 1, 2): told_cell(specimen, 12.0),
    }
    journal = LineJournal(tmp_path / "journal.jsonl", ASKED, "map")
    for key, result in results.items():
        journal.add(line_of(axis, key, result))
    path = tmp_path / "journal.jsonl"
    read = results_in(LineJournal(path, ASKED, "map"), axes)
    assert repr(read) == repr(results)  # not a number is not equal to itself
    for damaged in flipped(path.read_bytes()):
        path.write_bytes(damaged)
        with pytest.raises(InputError, match=r"journal\.jsonl: line [1-4]"):
            results_in(LineJournal(path, ASKED, "map"), axes)
