"""Refining designs and runs: files, command line, the same bytes again."""

import csv
import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import beamopt
from beamopt.base.errors import InputError
from beamopt.cli.application import run
from beamopt.judge.judge import Judge
from beamopt.outline.faults import summaries
from beamopt.refine.folder import REFINEMENT_FILES, EarlierRefinement
from beamopt.refine.refine import RefineStatus
from beamopt.refine.refine_design import refine_design
from beamopt.refine.truth import View, judged_on
from beamopt.scene.design import load_design
from beamopt.scene.scene import load_scene
from beamopt.search.optimize import optimize
from beamopt.search.result import Optimisation
from beamopt.search.stopping import StopReason
from beamopt.storage.result_folder import design_file
from tests.validation.resume import content, everything

KEYS = ("grid.radial=32", "grid.angular=90", "section.feature_points=30")
SHORT = ("search.generations=3", "refine.rounds=2", "refine.flips=4000")
SETTINGS = [f"--set={key}" for key in (*KEYS, *SHORT)]


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Optimisation]:
    folder = tmp_path_factory.mktemp("run") / "finished"
    scene = load_scene("hand-drawn-workspace", [*KEYS, *SHORT, "refine.finish=true"])
    return folder, optimize(scene, folder)


def test_a_search_that_ends_by_refining_keeps_both_designs(finished) -> None:
    folder, result = finished
    found = result.refinement
    assert found is not None
    assert found.refined.status is RefineStatus.REFINED
    held = {path.name for path in folder.iterdir()}
    assert set(REFINEMENT_FILES) - {"refined_paths.csv"} <= held
    best, refined = load_design(folder / "best.json"), load_design(folder / "refined.json")
    aim = result.target.aim
    assert float(aim.loss(best.workspace.tips)) == pytest.approx(result.verdict.L)
    assert float(aim.loss(refined.workspace.tips)) == pytest.approx(found.refined.after.L)
    assert refined.notes["refined_from"] == {"L": result.verdict.L, "K": result.verdict.K}
    assert found.refined.after.L < result.verdict.L
    assert found.refined.after.K <= result.verdict.K
    assert design_file(folder).name == "refined.json"


def test_what_a_refinement_says_of_itself(finished) -> None:
    folder, result = finished
    found = result.refinement
    assert found is not None
    said = json.loads((folder / "summary.json").read_text())["refinement"]
    assert said["ended"] == RefineStatus.REFINED.name
    assert said["before"]["L"] == result.verdict.L
    assert said["after"]["L"] == found.refined.after.L
    weight = result.scene.search.neighbour_weight
    assert said["after"]["neighbour_ratio"] == found.refined.after.K / weight
    assert "seconds" not in json.dumps(said)
    stages = list(csv.DictReader((folder / "refinement.csv").read_text().splitlines()))
    assert [row["stage"] for row in stages[:3]] == [
        "start",
        "annealing of types",
        "descent of positions",
    ]
    assert int(stages[-1]["evaluations"]) == said["evaluations"] == found.refined.evaluations
    assert "refinement," in (folder / "timing.csv").read_text()
    distances = list(csv.DictReader((folder / "refined_tips.csv").read_text().splitlines()))
    total = sum(float(row["distance_mm"]) ** 2 for row in distances)
    assert total == pytest.approx(found.refined.after.L)


def test_refining_a_run_afterwards_gives_the_same_bytes(finished, tmp_path: Path) -> None:
    folder = tmp_path / "run"
    assert run(["optimize", "hand-drawn-workspace", "--out", str(folder), *SETTINGS]) == 0
    assert not (folder / "refined.json").exists()
    assert design_file(folder).name == "best.json"
    assert run(["refine", str(folder)]) == 0
    assert content(folder) == content(finished[0])


def test_refine_as_an_option_is_the_key_of_the_scene(finished, tmp_path: Path) -> None:
    folder = tmp_path / "run"
    words = ["optimize", "hand-drawn-workspace", "--out", str(folder), "--refine", *SETTINGS]
    assert run(words) == 0
    assert content(folder) == content(finished[0])


def test_a_design_file_is_refined_for_a_scene(
    finished, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out, design = tmp_path / "out", finished[0] / "best.json"
    words = ["refine", str(design), "--scene", "hand-drawn-workspace", "--out", str(out)]
    assert run([*words, *SETTINGS]) == 0
    said = capsys.readouterr().out
    assert "refined L" in said
    assert "bound" in said
    scene = load_scene("hand-drawn-workspace", [*KEYS, *SHORT])
    again = refine_design(load_design(design), scene)
    assert load_design(out / "refined.json").json() == again.design.json()
    assert {"summary.json", "timing.csv", "provenance.json"} <= {p.name for p in out.iterdir()}
    assert run([*words, *SETTINGS]) == 2  # what is there stays


def test_interrupted_refining_leaves_the_search_and_can_be_gone_on_with(
    finished, tmp_path: Path
) -> None:
    scene = load_scene("hand-drawn-workspace", [*KEYS, *SHORT, "refine.finish=true"])

    def interrupt(record: object) -> None:
        raise KeyboardInterrupt

    folder = tmp_path / "run"
    cut = optimize(scene, folder, refining=interrupt)
    assert cut.refinement is None
    assert "interrupted" in cut.status.value
    assert not (folder / "refined.json").exists()
    optimize(scene, folder, resume=True)
    assert content(folder) == content(finished[0])


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["refine", "best.json"], "--scene: must name a scene"),
        (["refine", "nothing.json", "--scene", "random-section"], "nothing.json"),
        (["refine", "drawn.json", "--scene", "hand-drawn-section"], "drawing"),
        (["refine", "run", "--scene", "random-section"], "goes with a design file"),
        (["refine", "run", "--set", "search.seed=3"], r"a key of [refine]"),
        (["refine", "run", "--set", "refine.rounds=0"], "refine.rounds"),
        (["refine", "."], "no run folder"),
    ],
)
def test_misuse_is_one_line(
    words: list[str],
    said: str,
    finished,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "run").symlink_to(finished[0])
    (tmp_path / "best.json").write_bytes((finished[0] / "best.json").read_bytes())
    drawn = Path(beamopt.__file__).parent / "scenes" / "hand_drawn_section.json"
    (tmp_path / "drawn.json").write_bytes(drawn.read_bytes())
    before = content(finished[0])
    assert run(words) == 2
    complaint = capsys.readouterr().err
    assert said in complaint
    assert complaint.count("\n") == 1
    assert content(finished[0]) == before


def test_a_drawing_has_no_points_to_refine() -> None:
    scene = load_scene("hand-drawn-section")
    design = load_design(str(scene.target.file))
    with pytest.raises(InputError, match="drawn chambers have none to move"):
        refine_design(design, scene)


def test_a_search_that_goes_on_sets_aside_what_was_refined_of_an_earlier_best(
    tmp_path: Path,
) -> None:
    folder, keys = tmp_path / "run", [*KEYS, *SHORT]
    optimize(load_scene("hand-drawn-workspace", [*keys, "refine.finish=true"]), folder)
    assert design_file(folder).name == "refined.json"
    refined = {name: one for name, one in content(folder).items() if name in REFINEMENT_FILES}
    assert set(refined) == set(REFINEMENT_FILES) - {"refined_paths.csv"}
    longer = load_scene("hand-drawn-workspace", [*keys, "search.generations=5"])
    result = optimize(longer, folder, resume=True, figures=False)
    assert result.there is EarlierRefinement.SET_ASIDE
    assert not {path.name for path in folder.iterdir()} & set(REFINEMENT_FILES)
    assert content(folder / "earlier-refinement-1") == refined
    assert design_file(folder).name == "best.json"
    assert not load_scene(folder / "scene.toml").refine.finish
    assert "refinement" not in json.loads((folder / "summary.json").read_text())


def test_a_refinement_of_an_earlier_best_is_set_aside_where_the_new_one_is_refined_too(
    tmp_path: Path,
) -> None:
    folder, keys = tmp_path / "run", [*KEYS, *SHORT, "refine.finish=true"]
    optimize(load_scene("hand-drawn-workspace", keys), folder, figures=False)
    refined = {name: one for name, one in content(folder).items() if name in REFINEMENT_FILES}
    longer = load_scene("hand-drawn-workspace", [*keys, "search.generations=5"])
    result = optimize(longer, folder, resume=True, figures=False)
    assert result.there is EarlierRefinement.SET_ASIDE
    assert content(folder / "earlier-refinement-1") == refined
    assert design_file(folder).name == "refined.json"
    assert result.refinement is not None
    assert load_design(folder / "refined.json").json() == result.refinement.design.json()


@pytest.mark.parametrize("asked", [(), ("--refine",)], ids=["search", "search and refining"])
def test_resuming_a_finished_run_changes_no_byte(
    asked: tuple[str, ...], finished, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Whether refining is asked for again or not."""
    folder = Path(shutil.copytree(finished[0], tmp_path / "run"))
    before = everything(folder)
    words = ["optimize", "hand-drawn-workspace", "--out", str(folder), "--resume", *asked]
    assert run([*words, *SETTINGS]) == 0
    assert everything(folder) == before
    said, notes = capsys.readouterr()
    assert (EarlierRefinement.STAYS.value in said) is (not asked)
    findings = summaries(load_design(design_file(folder)).findings)
    assert findings != summaries(load_design(folder / "best.json").findings)
    assert notes.splitlines() == [f"note: {line}" for line in findings]
    assert run(["refine", str(folder)]) == 0
    assert everything(folder) == before


def test_a_worse_refinement_takes_no_better_ones_place(
    finished, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = Path(shutil.copytree(finished[0], tmp_path / "run"))
    before = everything(folder)
    less = ("refine.rounds=1", "refine.flips=0", "refine.steps=0", "refine.finish=true")
    scene = load_scene(folder / "scene.toml", less)
    result = optimize(scene, folder, resume=True)
    assert result.there is EarlierRefinement.BETTER
    assert everything(folder) == before
    findings = summaries(load_design(design_file(folder)).findings)
    assert result.refinement is not None
    assert findings != summaries(result.refinement.design.findings)
    assert run(["refine", str(folder), *(f"--set={key}" for key in less[:3])]) == 0
    assert capsys.readouterr().err.splitlines() == [f"note: {line}" for line in findings]


def test_a_better_refinement_takes_the_place_with_its_settings(tmp_path: Path) -> None:
    keys = [*KEYS, "search.generations=3", "refine.finish=true"]
    less = ("refine.rounds=1", "refine.flips=0", "refine.steps=2")
    folder = tmp_path / "run"
    first = optimize(load_scene("hand-drawn-workspace", [*keys, *less]), folder, figures=False)
    more = load_scene("hand-drawn-workspace", [*keys, "refine.rounds=2", "refine.flips=4000"])
    second = optimize(more, folder, resume=True, figures=False)
    assert second.there is EarlierRefinement.REPLACED
    assert first.refinement is not None
    assert second.refinement is not None
    assert second.refinement.refined.after.L < first.refinement.refined.after.L
    assert load_scene(folder / "scene.toml").refine == more.refine
    optimize(more, tmp_path / "whole", figures=False)
    assert content(folder) == content(tmp_path / "whole")


def test_refining_that_is_cut_leaves_a_finished_run_as_it_was(finished, tmp_path: Path) -> None:
    folder = Path(shutil.copytree(finished[0], tmp_path / "run"))
    before = everything(folder)

    def interrupt(record: object) -> None:
        raise KeyboardInterrupt

    scene = load_scene(folder / "scene.toml", ["refine.flips=100"])
    assert optimize(scene, folder, resume=True, refining=interrupt).status is StopReason.INTERRUPTED
    assert everything(folder) == before


def test_a_search_that_was_stopped_is_not_gone_on_with(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "run"
    words = ["optimize", "hand-drawn-workspace", "--out", str(folder), *SETTINGS]
    assert run([*words, "--set=stop.seconds=0.0"]) == 0
    before = content(folder)
    assert run(["refine", str(folder)]) == 2
    said = capsys.readouterr().err
    assert "the time allowed is used up" in said
    assert "--resume" in said
    assert content(folder) == before


def test_without_a_weight_the_ratio_is_still_told() -> None:
    scene = load_scene("random-section", [*KEYS, *SHORT, "search.neighbour_weight=0.0"])
    design = scene.design_of(scene.random_points(np.random.default_rng(3)))
    found = refine_design(design, scene).refined
    assert found.ratio_before > 0
    assert found.ratio > 0
    assert found.after.L <= found.before.L


@pytest.mark.parametrize("rounds", ["refine.rounds=2", "refine.flips=0"])
def test_a_design_is_made_as_symmetric_as_the_scene_asks(rounds: str) -> None:
    keys = [*KEYS, *SHORT, 'making.symmetry="mirror"', "refine.steps=0", rounds]
    scene = load_scene("random-section", keys)
    lopsided = scene.design_of(scene.random_points(np.random.default_rng(3)))
    found = refine_design(lopsided, scene)
    symmetry = scene.making.repair(scene.grid.build())
    assert symmetry is not None
    points = found.refined.points
    assert points.digest == symmetry.symmetrised(points).digest


def test_chambers_are_counted_on_the_outline_where_that_counts() -> None:
    keys = ["seal.skin=1.0", "seal.wall=0.9", "making.chambers=[9, 9, 9]", *KEYS]
    scene = load_scene("random-section", keys)
    judge = Judge.of_scene(scene, scene.load_target())
    differ = 0
    for seed in range(12):
        points = scene.random_points(np.random.default_rng(seed))
        outline = scene.design_of(points).outline
        counts = [sum(one.supply == k for one in outline.chambers) for k in (1, 2, 3)]
        raster = judge.measured([points]).chambers[0].tolist()
        differ += counts != raster
        tight = replace(judge, making=replace(judge.making, chambers=tuple(counts), rejects=True))
        assert judged_on(tight, View.OUTLINE)(points).found
        fewer = tuple(max(count - 1, 0) for count in counts)
        tight = replace(judge, making=replace(judge.making, chambers=fewer, rejects=True))
        assert judged_on(tight, View.OUTLINE)(points).found == (counts == list(fewer))
    assert differ > 0


def test_a_refined_design_says_how_it_follows_trajectories_and_what_rules_weigh(
    tmp_path: Path,
) -> None:
    keys = [*KEYS, *SHORT, "refine.finish=true", "refine.rounds=1", "making.mass_weight=1.0"]
    result = optimize(load_scene("spiral", keys), tmp_path / "run", figures=False)
    found = result.refinement
    assert found is not None
    rows = list(csv.DictReader((tmp_path / "run" / "refined_paths.csv").read_text().splitlines()))
    squares = sum(float(row["distance_mm"]) ** 2 for row in rows)
    assert squares == pytest.approx(found.refined.after.L)
    said = json.loads((tmp_path / "run" / "summary.json").read_text())["refinement"]
    assert said["after"]["R"] == found.refined.after.R > 0
    assert said["faults"] == [str(fault) for fault in found.design.findings]
