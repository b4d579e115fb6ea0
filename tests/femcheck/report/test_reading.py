"""Folders of results read back; what is damaged is said in one line, by file and key."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from beamopt.base.errors import InputError
from beamopt.storage.writing import csv_text
from femcheck.report.content import read_table
from femcheck.report.folders import ContentKind, find_folders
from femcheck.report.other_runs import read_figure_run, read_search_run
from femcheck.report.page import report_page
from femcheck.report.solid_run import read_solid_run
from femcheck.report.wording import badge_of
from tests.femcheck.report.folders import change_json, copied, figure_folder


def test_a_check_is_read(checked: Path) -> None:
    run = read_solid_run(checked)
    found = run.combinations
    assert found is not None
    assert not run.is_prediction
    assert found.answered.all()
    assert found.loaded.sum() == 26
    away = np.linalg.norm(found.beam - found.solid, axis=1)
    np.testing.assert_allclose(found.difference, away, atol=2e-6)
    moved = found.displacement[found.loaded]
    np.testing.assert_allclose(found.share[found.loaded], away[found.loaded] / moved, atol=1e-5)
    assert run.seconds > 0


def test_a_prediction_is_read(predicted: Path) -> None:
    run = read_solid_run(predicted)
    found = run.combinations
    assert found is not None
    assert run.is_prediction
    missing = ~found.answered
    assert 0 < missing.sum() < 27
    assert all(np.isfinite(found.ends_at[missing]))
    row = int(np.flatnonzero(missing)[0])
    ended = found.endings[row]
    assert ended is not None
    assert ended.status.is_physical
    assert found.ending(row) == str(replace(ended, load=found.ends_at[row]))


def test_a_verdict_that_is_not_certain_has_a_badge_that_says_so(
    checked: Path, predicted: Path, tmp_path: Path
) -> None:
    """Meshes of two layers and of one do not agree on limits. An old folder does not say."""
    run = read_solid_run(predicted)
    assert not run.is_certain
    assert (run.summary.largest_ratio or 0) > 1.1
    sure = read_solid_run(checked)
    assert sure.is_certain
    folder = copied(checked, tmp_path / "unsure")
    change_json(folder / "summary.json", lambda data: data["verdict"].update(certain=False))
    unsure = read_solid_run(folder)
    assert not unsure.is_certain
    assert badge_of(unsure).text == f"{badge_of(sure).text}, uncertain"
    change_json(folder / "summary.json", lambda data: data["verdict"].pop("certain"))
    assert read_solid_run(folder).is_certain


def test_text_that_was_defused_is_shown_as_it_was(tmp_path: Path) -> None:
    texts = ("=1+1", "'-x", "-1.5", "@a")
    (tmp_path / "a.csv").write_text(csv_text("a,b,c,d", [texts]), encoding="utf-8")
    assert read_table(tmp_path / "a.csv").rows == (texts,)


def test_folders_are_found(checked: Path, predicted: Path, tmp_path: Path) -> None:
    several = tmp_path / "several"
    copied(checked, several / "b")
    figure_folder(several / "c")
    (several / "a").mkdir()
    (several / "README.md").write_text("nothing of ours")
    found = find_folders([several, predicted, predicted])
    assert [(one.kind, one.path.name) for one in found] == [
        (ContentKind.SOLID, "b"),
        (ContentKind.FIGURES, "c"),
        (ContentKind.SOLID, "predicted"),
    ]


@pytest.mark.parametrize("name", ["nowhere", "file", "empty"])
def test_other_things_are_refused(name: str, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    (tmp_path / "empty").mkdir()
    with pytest.raises(
        InputError, match=rf"{name}: no folder for a report; allowed: .*check\.json"
    ):
        report_page([tmp_path / name])


def cut(name: str, share: float = 0.5) -> Callable[[Path], None]:
    def change(folder: Path) -> None:
        data = (folder / name).read_bytes()
        (folder / name).write_bytes(data[: int(len(data) * share)])

    return change


def replaced(name: str, old: str, new: str) -> Callable[[Path], None]:
    def change(folder: Path) -> None:
        text = (folder / name).read_text()
        assert old in text
        (folder / name).write_text(text.replace(old, new, 1))

    return change


def removed(name: str) -> Callable[[Path], None]:
    return lambda folder: (folder / name).unlink()


def summary_with(change: Callable[[dict[str, Any]], Any]) -> Callable[[Path], None]:
    return lambda folder: change_json(folder / "summary.json", lambda data: change(data) and None)


DAMAGE: dict[str, tuple[Callable[[Path], None], str]] = {
    "summary cut": (cut("summary.json"), r"summary\.json: line"),
    "summary gone": (removed("summary.json"), r"summary\.json: no such file"),
    "no verdict": (summary_with(lambda d: d.pop("verdict")), r"verdict\.kind: must be given"),
    "kind": (
        summary_with(lambda d: d["verdict"].update(kind=3)),
        r"kind = 3: allowed: one of implementation, prediction",
    ),
    "unknown kind": (summary_with(lambda d: d["verdict"].update(kind="x")), r"one of implem"),
    "holds": (summary_with(lambda d: d["verdict"].update(holds="yes")), r"true or false"),
    "agree": (summary_with(lambda d: d["verdict"].update(agree=None)), r"agree: must be a number"),
    "chambers": (
        summary_with(lambda d: d["section"].update(chambers=1)),
        r"= 1: must be a list",
    ),
    "design cut": (cut("design.json"), r"design\.json"),
    "provenance": (replaced("provenance.json", '"machine"', '"engine"'), r"machine: must be given"),
    "table gone": (removed("table.csv"), r"table\.csv: no such file"),
    "table cut": (cut("table.csv"), r"table\.csv: (line \d+ = \d+: must hold 21 cells|rows = )"),
    "cell gone": (replaced("table.csv", ",converged", ""), r"line 2 = 20: must hold 21 cells"),
    "row gone": (
        lambda folder: (folder / "table.csv").write_text(
            "".join((folder / "table.csv").read_text().splitlines(True)[:-1])
        ),
        r"table\.csv: rows = 26: must hold 27 combinations",
    ),
    "status": (
        replaced("table.csv", ",solid.CONVERGED", ",solid.SOLVED"),
        r"combination 1, ended = .*: no status is called solid\.SOLVED",
    ),
    "no column": (replaced("table.csv", "beam_y", "beam_q"), r"table\.csv: beam_y: no column"),
    "no number": (replaced("table.csv", "0,0,20,", "0,0,20,x"), r"line 3, beam_x = 'x"),
    "infinite": (replaced("table.csv", "0,0,20,", "0,0,20,inf,"), r"table\.csv: line 3"),
    "pressure": (
        replaced("table.csv", "0,0,20,", "0,0,21,"),
        r"combination 2 = .*: must be at",
    ),
    "timing gone": (removed("timing.csv"), r"timing\.csv: no such file"),
    "mesh cut": (cut("deformed/20-0-0.vtu"), r"20-0-0\.vtu: no whole mesh"),
    "mesh gone": (removed("deformed/20-0-0.vtu"), r"20-0-0\.vtu: is missing"),
    "tags gone": (removed("mesh.vtu"), r"mesh\.vtu: is missing"),
    "no displacement": (
        replaced("deformed/20-0-0.vtu", 'Name="displacement_mm"', 'Name="displacement"'),
        r"20-0-0\.vtu: displacement_mm: must be given",
    ),
    "no tags": (replaced("mesh.vtu", 'Name="tag"', 'Name="gat"'), r"mesh\.vtu: tag: must be given"),
}


@pytest.mark.parametrize("damage", DAMAGE)
def test_damage_is_said_in_one_line(damage: str, checked: Path, tmp_path: Path) -> None:
    change, said = DAMAGE[damage]
    folder = copied(checked, tmp_path / "copy")
    change(folder)
    with pytest.raises(InputError, match=said) as raised:
        report_page([folder])
    assert "\n" not in str(raised.value)


def test_a_mesh_of_another_run_is_refused(checked: Path, predicted: Path, tmp_path: Path) -> None:
    folder = copied(checked, tmp_path / "copy")
    other = next((predicted / "deformed").iterdir())
    (folder / "deformed" / "20-20-20.vtu").write_bytes(other.read_bytes())
    with pytest.raises(InputError, match="is of another mesh than the files beside it"):
        report_page([folder])


def test_figure_folders_are_read(chart: Path, tmp_path: Path) -> None:
    run = read_figure_run(chart)
    assert run.verdict == "a is fastest"
    assert [figure.ratio for figure in run.figures] == [2.0]
    for svg in ("<svg", "<html></html>", "", "<svg><g></svg>"):
        folder = figure_folder(tmp_path / f"x{abs(hash(svg))}", svg=svg)
        with pytest.raises(InputError, match=r"chart\.svg"):
            report_page([folder])


def test_searches_are_read(tmp_path: Path) -> None:
    """A search of one generation, with what `beamopt optimize` writes."""
    from beamopt.scene.scene import load_scene
    from beamopt.search.optimize import optimize
    from beamopt.search.run_folder import RunFolder

    scene = load_scene("random-section", ["search.generations=1"])
    with RunFolder.open(tmp_path / "search", resume=False) as folder:
        folder.begin(scene, scene.load_target())
        folder.write_result(optimize(scene), figures=False)
    run = read_search_run(folder.path)
    assert run.name == "random-section, seed 0"
    assert run.seconds > 0
    assert "random-section, seed 0" in report_page([folder.path])
    change_json(folder.path / "summary.json", lambda data: data.pop("scene"))
    with pytest.raises(InputError, match=r"summary\.json: scene: must be given"):
        report_page([folder.path])


@pytest.mark.parametrize("name", ["pairs", "spiral"])
def test_searches_for_other_targets_are_read(name: str, tmp_path: Path) -> None:
    """What was asked for stands beside the results with a person's comments in it."""
    from beamopt.scene.scene import load_scene
    from beamopt.search.optimize import optimize

    scene = load_scene(name, ["search.generations=1", "search.population=4"])
    optimize(scene, tmp_path / name, figures=False)
    page = report_page([tmp_path / name])
    assert f"{name}, seed 0" in page
    assert ("paths.csv" in page) == (name == "spiral")
