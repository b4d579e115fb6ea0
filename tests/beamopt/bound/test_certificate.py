"""Three bounds of a scene's target, on the command line and in files."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from beamopt.bound.certificate import BoundStatus, certificate, quick_certificate
from beamopt.bound.folder import bound_summary
from beamopt.cli.application import run
from beamopt.cli.bound import gap_text
from beamopt.plot.bound import bound_figure
from beamopt.plot.style import save_figure
from beamopt.scene.bundled import bundled_scenes
from beamopt.scene.scene import load_scene
from beamopt.search.optimize import optimize
from beamopt.target.aim import Aim
from beamopt.target.target import Target
from tests.validation.resume import content

SCENES = bundled_scenes()
DRAWN = SCENES["hand-drawn-section"].with_name("hand_drawn_section.json")
TABLE = SCENES["hand-drawn-workspace"].with_name("hand_drawn_workspace.csv")


@pytest.mark.parametrize("name", ["random-section", "hand-drawn-section", "sealed-section"])
def test_a_sections_workspace_is_bounded_by_nothing(name: str) -> None:
    scene = load_scene(name)
    found = certificate(scene, scene.load_target())
    assert found.status is BoundStatus.BOUNDED
    assert found.response is not None
    assert found.proven is not None
    assert found.ring is not None
    assert found.proven.loss <= found.response.loss < 1e-12
    assert found.ring.realisable
    assert set(found.seconds) == {"response", "proven", "ring"}


def test_the_drawn_workspace_is_bounded_as_worked_out_before() -> None:
    scene = load_scene("hand-drawn-workspace")
    said: list[tuple[str, str]] = []
    found = certificate(scene, scene.load_target(), lambda *what: said.append(what))
    assert found.response is not None
    assert found.proven is not None
    assert found.ring is not None
    assert found.response.loss == pytest.approx(65.58, abs=0.01)
    assert 0.999 * found.response.loss < found.proven.loss <= found.response.loss
    assert found.ring.realisable
    assert {part for part, _ in said} == {"proven", "ring"}


@pytest.mark.parametrize("name", ["two-segments", "tool-at-the-tip"])
def test_a_rod_that_is_no_arc_has_a_reason_instead(name: str) -> None:
    scene = load_scene(name)
    target = Target.of_workspace(load_scene("random-section").load_target().workspace)  # type: ignore[arg-type]
    found = certificate(scene, target)
    assert found.status is BoundStatus.NOT_AN_ARC
    assert found.response is None
    assert bound_summary(found, 1.0) == {
        "status": found.status.value,
        "ended": found.status.name,
    }
    assert gap_text(found, 1.0).startswith("no bound: ")


def test_a_target_without_rows_has_a_reason_instead() -> None:
    scene = load_scene("random-section")
    none, nothing = np.zeros((0, 3)), np.zeros(0)
    target = Target(Aim(none, none, nothing, none, nothing))
    assert quick_certificate(scene, target).status is BoundStatus.NO_ROWS


def test_rows_that_do_not_count_are_left_out() -> None:
    scene = load_scene("hand-drawn-workspace")
    target = scene.load_target()
    weights = np.ones(27)
    weights[5:9] = 0.0
    less = replace(target, aim=replace(target.aim, weights=weights))
    found, whole = quick_certificate(scene, less), quick_certificate(scene, target)
    assert found.wanted is not None
    assert found.response is not None
    assert whole.response is not None
    assert len(found.wanted.tips) == 23
    assert found.response.loss < whole.response.loss


def test_a_search_says_how_far_it_is_above(tmp_path: Path) -> None:
    scene = load_scene("hand-drawn-workspace", ["search.generations=2"])
    result = optimize(scene, tmp_path / "run", figures=False)
    summary = json.loads((tmp_path / "run" / "summary.json").read_text())["bound"]
    assert summary["L"] == pytest.approx(65.58, abs=0.01)
    assert summary["L"] + summary["L_above"] == pytest.approx(result.verdict.L, rel=1e-12)
    assert summary["kind"] == "numerical"
    assert summary["ended"] == result.bound.status.name
    assert "seconds" not in json.dumps(summary)
    assert "65.5846 mm² (numerical" in gap_text(result.bound, result.verdict.L)
    assert "(10 %)" in gap_text(result.bound, 1.1 * summary["L"])
    nothing_found = bound_summary(result.bound, float("inf"))
    assert "L_above" not in nothing_found


@pytest.mark.parametrize(
    ("subject", "said"),
    [
        ("random-section", "0 mm²"),
        (str(SCENES["hand-drawn-workspace"]), "65.5846 mm²"),
        (str(TABLE), "65.5846 mm²"),
        (str(DRAWN), "0 mm²"),
    ],
    ids=["name", "scene", "table", "design"],
)
def test_every_subject(subject: str, said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["bound", subject]) == 0
    printed = capsys.readouterr().out
    for word in ("response", "proven", "ring", "numerical", "starts end there"):
        assert word in printed
    assert said in printed
    assert ("worst node   2.683 mm at" in printed) == ("RMS distance" in printed) == ("65" in said)


def test_a_run_folder_is_its_scene(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Scene and target as the run keeps them, whatever happened to the files since."""
    monkeypatch.chdir(tmp_path)
    Path("table.csv").write_bytes(TABLE.read_bytes())
    scene = SCENES["hand-drawn-workspace"].read_text()
    assert TABLE.name in scene
    Path("mine.toml").write_text(scene.replace(TABLE.name, "table.csv"))
    tiny = [f"--set=search.{key}" for key in ("generations=0", "population=2")]
    assert run(["optimize", "mine.toml", "--out", "run", *tiny]) == 0
    Path("table.csv").unlink()
    capsys.readouterr()
    assert run(["bound", "run", "--work", "0.001"]) in (0, 3)
    assert "65.5846 mm²" in capsys.readouterr().out
    Path("empty").mkdir()
    assert run(["bound", "empty"]) == 2
    assert "no scene.toml" in capsys.readouterr().err


def test_keys_can_be_replaced_for_a_table(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["bound", str(TABLE), "--set", "actuator.length=120"]) == 0
    printed = capsys.readouterr().out
    assert "65.58" not in printed
    assert "note" in printed  # its tip without pressure is elsewhere


def test_a_rod_under_loads_is_said(capsys: pytest.CaptureFixture[str]) -> None:
    keys = ["--set", "loads.line_force=[50.0, 0.0, 0.0]", "--set", "rod.rung=loaded"]
    assert run(["bound", "hand-drawn-section", *keys, "--set", "rod.twist=stiff"]) == 3
    assert "no bound: the tips of this scene's rod" in capsys.readouterr().out


def test_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "bound"
    assert run(["bound", "hand-drawn-workspace", "--out", str(folder)]) == 0
    assert f"{folder}/ (bound.png" in capsys.readouterr().out.replace("\n", "")
    assert {path.name for path in folder.iterdir()} == {
        "bound.json",
        "bound.png",
        "bound.svg",
        "ideal.csv",
        "provenance.json",
        "timing.csv",
    }
    numbers = json.loads((folder / "bound.json").read_text())
    kinds = {part: numbers[part]["kind"] for part in ("response", "proven", "ring")}
    assert kinds == {"response": "numerical", "proven": "proven", "ring": "numerical"}
    header, *rows = (folder / "ideal.csv").read_text().splitlines()
    assert header == "p1,p2,p3,x,y,z,target_x,target_y,target_z,weight,distance_mm"
    table = np.array([row.split(",") for row in rows], dtype=float)
    assert (table[:, 10] ** 2).sum() == pytest.approx(numbers["response"]["L"], rel=1e-9)
    np.testing.assert_allclose(np.linalg.norm(table[:, 3:6] - table[:, 6:9], axis=1), table[:, 10])
    timing = (folder / "timing.csv").read_text().splitlines()
    assert [line.partition(",")[0] for line in timing] == ["what", "response", "proven", "ring"]


def test_the_same_numbers_again(tmp_path: Path) -> None:
    for name in ("a", "b"):
        assert run(["bound", str(TABLE), "--out", str(tmp_path / name)]) == 0
    assert content(tmp_path / "a") == content(tmp_path / "b")


def test_anothers_folder_is_left_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "mine.txt").write_text("precious")
    assert run(["bound", "random-section", "--out", str(tmp_path)]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (["nonsense"], "no such scene"),
        (["missing.csv"], "missing.csv"),
        (["missing.json"], "missing.json"),
        (["random-section", "--set", "actuator.length=0.01"], "0.1 … 100000 mm"),
        ([str(TABLE), "--set", "actuator.size=1"], "actuator.size"),
        ([str(DRAWN), "--set", "nonsense"], "section.key=value"),
        (["wrong.csv"], "must name"),
        (["wrong.json"], "wrong.json"),
    ],
)
def test_misuse_is_one_line(
    arguments: list[str],
    named: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("wrong.csv").write_text("a,b\n1,2\n")
    Path("wrong.json").write_text("{")
    assert run(["bound", *arguments, "--out", "out"]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert named in err
    assert not Path("out").exists()


def test_rows_at_any_pressures_are_drawn(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    tips = rng.normal(size=(5, 3)) * 20 + [0, 0, 100]
    figure = bound_figure(rng.uniform(0, 80, (5, 3)), tips, tips + 1, title="five points")
    save_figure(figure, tmp_path / "five.png")
    assert (tmp_path / "five.png").stat().st_size > 10_000
