"""What the bound's command takes, says and leaves behind, beyond a scene's own target."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from beamopt.bound.folder import KIND
from beamopt.bound.ring import RingMoments
from beamopt.bound.ring_bound import ring_bound
from beamopt.cli.application import run
from beamopt.scene.bundled import bundled_scenes
from beamopt.storage.result_folder import LOCK
from tests.beamopt.bound.cases import GRID, YOUNG, wanted

TABLE = bundled_scenes()["hand-drawn-workspace"].with_name("hand_drawn_workspace.csv")
HEADER = "p1,p2,p3,x,y,z"
PAIRS = [
    (0, 0, 0, 0, 0, 100),
    (30, 0, 0, 0, 6, 103),
    (0, 45, 10, 7, -5, 104),
    (20, 20, 60, 5, 8, 108),
]


def table(path: Path, rows: list[tuple[float, ...]], header: str = HEADER) -> str:
    path.write_text("\n".join([header, *(",".join(map(str, row)) for row in rows)]) + "\n")
    return str(path)


def workspace_rows() -> list[tuple[float, ...]]:
    lines = [line for line in TABLE.read_text().splitlines() if line and line[0].isdigit()]
    return [tuple(float(cell) for cell in line.split(",")) for line in lines]


def bound_of(subject: str, out: Path, *keys: str, code: int = 0) -> dict[str, object]:
    assert run(["bound", subject, "--out", str(out), *(f"--set={key}" for key in keys)]) == code
    found: dict[str, object] = json.loads((out / "bound.json").read_text())
    return found


def test_pairs_at_any_pressures_are_taken(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert bound_of(table(tmp_path / "a.csv", PAIRS), tmp_path / "a")["rows"] == 4
    assert "not the 27 combinations of 0, 50, 100 kPa" in capsys.readouterr().out


def test_a_table_of_points_that_is_wrong_is_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    in_metres = [(*row[:3], *(value / 1000 for value in row[3:])) for row in PAIRS]
    assert run(["bound", table(tmp_path / "a.csv", in_metres)]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert "are they mm?" in err


@pytest.mark.parametrize(
    ("rows", "keys", "length", "source"),
    [
        (PAIRS, (), 100.0, "rest"),
        (PAIRS[1:], (), 100.0, "default"),
        (PAIRS[1:], ("actuator.length=90",), 90.0, "asked"),
        (PAIRS, ("actuator.length=90",), 90.0, "asked"),
        ([(0, 0, 0, 0, 0, 2), *PAIRS[1:]], (), 100.0, "default"),  # no actuator is that short
        (PAIRS, ("rod.rest_curvature=[0.01, 0, 0]",), 100.0, "default"),
    ],
)
def test_the_length_is_that_of_the_tip_without_pressure(
    tmp_path: Path, rows: list[tuple[float, ...]], keys: tuple[str, ...], length: float, source: str
) -> None:
    assumed = bound_of(table(tmp_path / "a.csv", rows), tmp_path / "a", *keys)["assumed"]
    assert isinstance(assumed, dict)
    assert (assumed["length_mm"], assumed["length_from"]) == (length, source)


def test_a_bound_scales_with_its_table(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Everything 0.58 times as large, also its frame moved: L is 0.58² of it."""
    rows = workspace_rows()
    small = [(*row[:3], *(0.58 * value for value in row[3:])) for row in rows]
    moved = [(*row[:3], row[3] + 7, row[4] - 2, row[5] + 30) for row in small]
    of_100 = bound_of(table(tmp_path / "a.csv", rows), tmp_path / "a")
    of_58 = bound_of(table(tmp_path / "b.csv", small), tmp_path / "b")
    said = capsys.readouterr().out
    assert "length 58 mm (the table's tip without pressure)" in " ".join(said.split())
    assert "no section can move" not in said
    base = "target.base_origin=[7.0, -2.0, 30.0]"
    elsewhere = bound_of(table(tmp_path / "c.csv", moved), tmp_path / "c", base)
    for found in (of_58, elsewhere):
        assert found["response"]["L"] == pytest.approx(0.58**2 * of_100["response"]["L"], rel=1e-6)  # type: ignore[index]


def test_a_length_that_the_table_contradicts_is_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bound_of(table(tmp_path / "a.csv", PAIRS), tmp_path / "a", "actuator.length=58")
    said = " ".join(capsys.readouterr().out.split())
    assert "is (0, 0, 100) mm, which no section can move from (0, 0, 58)" in said


def test_weights_and_repeated_rows_count(tmp_path: Path) -> None:
    rows = workspace_rows()
    weighed = [(*row, 0 if k == 3 else 1) for k, row in enumerate(rows)]
    weighted = table(tmp_path / "w.csv", weighed, HEADER + ",weight")
    assert bound_of(weighted, tmp_path / "w")["rows"] == 26
    assert bound_of(table(tmp_path / "r.csv", [*rows, rows[4]]), tmp_path / "r")["rows"] == 28


def test_a_workspace_stays_one_at_its_own_levels(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = [tuple(0.8 * p for p in row[:3]) + row[3:] for row in workspace_rows()]
    at_80 = table(tmp_path / "a.csv", rows)
    bound_of(at_80, tmp_path / "a", "pressures.levels=[0,40,80]")
    assert "combinations" not in capsys.readouterr().out
    bound_of(at_80, tmp_path / "b")
    assert "combinations" in capsys.readouterr().out


def test_the_kind_that_is_asked_for_decides(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    few = table(tmp_path / "a.csv", PAIRS)
    assert run(["bound", few, "--set", "target.kind=workspace"]) == 2
    assert "1 of 27 pressure combinations" in capsys.readouterr().err
    assert bound_of(str(TABLE), tmp_path / "b", "target.kind=points")["rows"] == 27


def test_rows_without_pressure_say_nothing_of_a_response(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    at_rest = table(tmp_path / "zero.csv", [(0, 0, 0, 1, 0, 100)])
    found = bound_of(at_rest, tmp_path / "zero")
    response, ring = found["response"], found["ring"]
    assert isinstance(response, dict)
    assert isinstance(ring, dict)
    assert response["L"] == ring["L"] == ring["attained"] == pytest.approx(1.0)
    assert ring["realisable"]
    assert "Traceback" not in capsys.readouterr().err


def test_a_ring_says_how_many_elements_it_was_cut_into(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    ring = bound_of("hand-drawn-workspace", tmp_path / "a")["ring"]
    assert isinstance(ring, dict)
    assert ring["elements"] == [64, 180]
    assert "numerical, on 64 × 180 elements: " in capsys.readouterr().out


def test_its_own_folder_is_written_anew(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    few, out = table(tmp_path / "few.csv", PAIRS), tmp_path / "out"
    before = bound_of(few, out)
    table(tmp_path / "few.csv", PAIRS[1:])
    (out / ".bound.json.123.tmp").write_text("half")
    (out / "bound.png").write_bytes(b"")
    after = bound_of(few, out)
    assert (before["rows"], after["rows"]) == (4, 3)
    assert (out / "bound.png").stat().st_size > 10_000
    assert not list(out.glob(".*"))
    loaded = ("loads.line_force=[50.0, 0.0, 0.0]", "rod.rung=loaded", "rod.twist=stiff")
    bound_of(few, out, *loaded, code=3)
    assert not list(out.glob("bound.[ps]*")) + list(out.glob("ideal.csv"))  # there is no bound now
    capsys.readouterr()
    kept = (out / "bound.json").read_bytes()
    assert run(["bound", "random-section", "--out", str(out)]) == 2
    said = capsys.readouterr().err
    assert "few" in said
    assert "name another folder" in said
    assert (out / "bound.json").read_bytes() == kept


def test_what_a_kill_left_is_gone_on_with(tmp_path: Path) -> None:
    few, out = table(tmp_path / "few.csv", PAIRS), tmp_path / "out"
    bound_of(few, out)
    (out / "bound.json").unlink()
    (out / LOCK).write_text(KIND.name)
    assert bound_of(few, out)["rows"] == 4


def test_a_refused_folder_is_not_offered_to_be_resumed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "mine.txt").write_text("precious")
    assert run(["bound", "random-section", "--out", str(tmp_path)]) == 2
    said = capsys.readouterr().err
    assert "--resume" not in said
    assert "bound.json" in said


def test_a_rod_at_rest_can_not_be_moved() -> None:
    rest = wanted(np.zeros((3, 3)), 1.0, pressures=np.zeros((2, 3)), rest=(0.01, 0.0))
    ring = RingMoments.of(GRID)
    found = ring_bound(rest, ring, YOUNG, rest.loss_of(np.zeros((3, 3))))
    assert found.realisable
    assert found.elements == ring.shape == (32, 90)
    assert found.inner > 0.1
