"""Searches for pairs and along trajectories: their folders, figures, resuming, and `reach`."""

import csv
import json
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from beamopt.base.errors import InputError
from beamopt.cli.application import run
from beamopt.judge.judge import Judge
from beamopt.scene.bundled import bundled_scenes
from beamopt.scene.design import load_design
from beamopt.scene.scene import Scene, load_scene
from beamopt.search.optimize import optimize
from beamopt.target.aim import Aim
from tests.validation.resume import content

SCENES = bundled_scenes()
SPIRAL = SCENES["spiral"].with_name("spiral.csv")
DRAWN = SCENES["hand-drawn-section"].with_name("hand_drawn_section.json")
SHORT = ("search.generations=3", "search.population=8")
KINDS = {
    "pairs": (),
    "spiral": (),
    "hand-drawn-workspace": (f'target.paths=["{SPIRAL}"]',),
    "two-segments": ('target.paths=["short.csv"]', "target.path_step=40"),
}


def scene_of(name: str, *more: str) -> Scene:
    return load_scene(name, [*SHORT, *KINDS[name], *more])


def rows_of(file: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(file.read_text().splitlines()))


@pytest.mark.parametrize("name", KINDS)
def test_searches_go_on_and_do_not_depend_on_workers(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On arcs and chains: stopped and gone on with, and by two threads, the same bytes."""
    short = tmp_path / "short.csv"
    short.write_text("x,y,z\n0,0,105\n-9,-9,108\n60,0,108\n")
    if name == "two-segments":
        monkeypatch.setitem(KINDS, name, (f'target.paths=["{short}"]', "target.path_step=40"))
    optimize(scene_of(name), tmp_path / "whole", figures=False)
    optimize(scene_of(name, "search.generations=1"), tmp_path / "run", figures=False)
    with ThreadPoolExecutor(2) as executor:
        again = optimize(
            scene_of(name), tmp_path / "run", resume=True, executor=executor, workers=2,
            figures=False,
        )  # fmt: skip
    assert content(tmp_path / "run") == content(tmp_path / "whole")
    kept = load_scene(tmp_path / "run" / "scene.toml")
    repeated = optimize(kept, tmp_path / "again", figures=False)
    assert repeated.best.json() == again.best.json()
    assert content(tmp_path / "again") == content(tmp_path / "whole")


def test_a_run_for_pairs(tmp_path: Path) -> None:
    """Rows of the aim in tips.csv, with distances and angles that make up L; target.csv is read."""
    result = optimize(scene_of("pairs"), tmp_path / "run")
    aim = result.target.aim
    rows = rows_of(tmp_path / "run" / "tips.csv")
    assert len(rows) == len(aim) == 12
    apart = np.array([float(row["distance_mm"]) for row in rows])
    turned = np.radians([float(row["turned_degrees"] or 0) for row in rows])
    loss = aim.weights @ apart**2 + aim.direction_weights @ (2 * np.sin(turned / 2)) ** 2
    assert loss == pytest.approx(result.verdict.L, rel=1e-12)
    assert result.outline_loss == pytest.approx(result.verdict.L, rel=1e-12)
    summary = json.loads((tmp_path / "run" / "summary.json").read_text())
    rms = (result.verdict.L / aim.weights.sum()) ** 0.5
    assert summary["best"]["rms_distance"] == pytest.approx(rms)
    names = {path.name for path in (tmp_path / "run").iterdir()}
    assert {"best.svg", "target.csv", "target-source.csv"} <= names
    assert "paths.csv" not in names
    written = f'target.file="{tmp_path / "run" / "target.csv"}"'
    again = load_scene("pairs", [written]).load_target().aim
    np.testing.assert_allclose(again.directions, aim.directions, rtol=0, atol=1e-15)
    assert run(["show", str(tmp_path / "run"), "--out", str(tmp_path / "shown.svg")]) == 0


def test_a_run_along_a_spiral(tmp_path: Path) -> None:
    """paths.csv: pressures in the box, whose tips are where they say, and L."""
    result = optimize(scene_of("spiral"), tmp_path / "run")
    rows = rows_of(tmp_path / "run" / "paths.csv")
    table = np.array([[float(cell) for cell in row.values()] for row in rows])
    assert len(table) == len(result.target.aim.paths)
    assert table[:, 1].tolist() == list(range(1, len(table) + 1))
    pressures, reached = table[:, 5:8], table[:, 8:11]
    assert pressures.min() >= 0
    assert pressures.max() <= 100
    np.testing.assert_allclose(result.best.tips(pressures), reached, rtol=0, atol=1e-10)
    np.testing.assert_allclose(table[:, 2:5], result.target.aim.paths)
    assert (table[:, 11] ** 2).sum() == pytest.approx(result.verdict.L, rel=1e-9, abs=1e-12)
    summary = json.loads((tmp_path / "run" / "summary.json").read_text())
    assert summary["paths"]["samples"] == len(table)
    assert summary["paths"]["largest_distance"] == pytest.approx(table[:, 11].max())
    names = {path.name for path in (tmp_path / "run").iterdir()}
    assert {"best.png", "target-path-1.csv"} <= names
    assert not {"target.csv", "tips.csv"} & names
    assert run(["show", str(tmp_path / "run"), "--out", str(tmp_path / "shown.png")]) == 0


def test_a_changed_path_does_not_go_on(tmp_path: Path) -> None:
    path = tmp_path / "mine.csv"
    path.write_text(SPIRAL.read_text())
    scene = load_scene("spiral", [*SHORT, f'target.paths=["{path}"]'])
    optimize(scene, tmp_path / "run", figures=False)
    path.write_text("x,y,z\n0,0,100\n0,0,110\n")
    with pytest.raises(InputError, match=r"target-path-1\.csv: differs"):
        optimize(scene, tmp_path / "run", resume=True)
    other = load_scene("spiral", [*SHORT, f'target.paths=["{SPIRAL}", "{SPIRAL}"]'])
    with pytest.raises(InputError, match=r"target\.paths"):
        optimize(other, tmp_path / "run", resume=True)


def test_a_loaded_rod_follows_a_path() -> None:
    """Under gravity: the inner problem by differences; settled rows give the same loss.

    Buys that a verdict under loads is that of the pressures that are reported.
    """
    keys = [f'target.paths=["{SPIRAL}"]', 'target.kind="paths"', "target.path_step=60"]
    scene = load_scene("spiral", [*keys, "loads.density=1070", "rod.rung=loaded"])
    target = scene.load_target()
    judge = Judge.of_scene(scene, target)
    points = scene.random_points(np.random.default_rng([1]))
    (verdict,) = judge([points])
    design = scene.design_of(points)
    settled = judge.settled(design.values)
    own = design.climb.model.tips(design.values, settled.pressures).positions
    assert pytest.approx(float(settled.loss(own)), rel=1e-6, abs=1e-6) == verdict.L


def test_figures_of_targets_without_a_workspace() -> None:
    """A dot a row, a line a direction, the trajectory and what is reached of it."""
    from beamopt.plot.figures import design_figure

    design = load_design(DRAWN)
    for name in ("pairs", "spiral"):
        target = load_scene(name).load_target()
        above = design_figure(design, target).axes[1]
        labels = above.get_legend_handles_labels()[1]
        assert ("target" in labels) == (name == "pairs")
        assert ("reached" in labels) == (name == "spiral")


def test_studies_draw_any_target() -> None:
    from beamopt.plot.study import case_figure

    for name in ("pairs", "spiral"):
        figure = case_figure(load_scene(name).load_target(), [("best", load_design(DRAWN))])
        assert len(figure.axes) == 5


def test_reach_prints_pressures(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Exit code 0 where all is reached, 1 with one line where not; CSV with all digits."""
    assert run(["reach", str(DRAWN), str(SPIRAL), "--csv"]) == 0
    rows = list(csv.DictReader(capsys.readouterr().out.splitlines()))
    design = load_design(DRAWN)
    pressures = np.array([[float(row[f"p{k}"]) for k in (1, 2, 3)] for row in rows])
    points = np.array([[float(row[name]) for name in "xyz"] for row in rows])
    np.testing.assert_allclose(design.tips(pressures), points, rtol=0, atol=1e-6)
    path = tmp_path / "path.csv"
    path.write_text("x,y,z\n0,0,100\n0,0,95\n")
    assert run(["reach", str(DRAWN), str(path)]) == 1
    said = capsys.readouterr()
    assert "reached" in said.out
    assert "outside by 5 mm" in said.out
    assert said.err == "beamopt: 1 of 2 points are not reached within 0.1 mm at 0 … 100 kPa\n"
    assert run(["reach", str(DRAWN), str(path), "--tolerance", "5.1"]) == 0
    capsys.readouterr()
    for call, named in (
        (["--tolerance", "nan"], "--tolerance"),
        (["--step", "0"], "--step"),
        (["--step", "1e-9"], "samples at path_step"),
    ):
        assert run(["reach", str(DRAWN), str(path), *call]) == 2
        assert named in capsys.readouterr().err


@pytest.mark.parametrize("name", ["pairs", "spiral"])
def test_init_brings_the_tables_along(name: str, tmp_path: Path) -> None:
    mine = tmp_path / "mine.toml"
    assert run(["init", str(mine), "--scene", name]) == 0
    chosen = load_scene(mine).target
    assert [Path(file).parent for file in chosen.files] == [tmp_path]
    bundled = load_scene(name).load_target().aim
    np.testing.assert_array_equal(load_scene(mine).load_target().aim.tips, bundled.tips)
    np.testing.assert_array_equal(load_scene(mine).load_target().aim.paths, bundled.paths)
    assert run(["init", str(tmp_path / "other.toml"), "--scene", name]) == 2


def test_an_aim_is_checked() -> None:
    none, nothing = np.zeros((0, 3)), np.zeros(0)
    with pytest.raises(ValueError, match="paths"):
        Aim(none, none, nothing, none, nothing, np.zeros((2, 2)))
    with pytest.raises(ValueError, match="path_weight"):
        Aim(none, none, nothing, none, nothing, np.zeros((2, 3)), -1.0)
    with pytest.raises(ValueError, match="squares"):
        Aim(none, none, nothing, none, nothing, np.zeros((2, 3))).loss(none)
