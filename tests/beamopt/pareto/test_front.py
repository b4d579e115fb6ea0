"""Several objectives at once: what is on a front, and that it is the same however it was run."""

from __future__ import annotations

import json
import re
import shutil
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from beamopt.base.errors import InputError
from beamopt.cli.application import run
from beamopt.judge.judge import Judge
from beamopt.pareto.find_front import find_front
from beamopt.pareto.front import Front
from beamopt.pareto.journal import FrontJournal
from beamopt.pareto.scores import nondominated, scored
from beamopt.pareto.search import FrontRecord, FrontSearch
from beamopt.scene.design import load_design
from beamopt.scene.scene import Scene, load_scene
from beamopt.search.stopping import StopReason
from tests.journals import flipped, rewritten
from tests.validation.resume import content, everything

SCENE = load_scene("hand-drawn-section", ["search.generations=6"])
SMALL = 16


def front_of(*keys: str, objectives: tuple[str, ...] = ("L", "mass")) -> Front:
    scene = load_scene("hand-drawn-section", ["search.generations=6", *keys])
    return find_front(scene, objectives, population=SMALL)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("front") / "whole"
    find_front(SCENE, ("L", "mass"), folder, population=SMALL)
    return folder


def counting_judge(scene: Scene) -> Judge:
    judge = Judge.of_scene(scene, scene.load_target())
    return replace(judge, making=judge.making.counting())


OBJECTIVES = [("L", "mass"), ("L", "ratio"), ("L", "chambers"), ("L", "ratio", "mass", "chambers")]


@pytest.mark.parametrize("objectives", OBJECTIVES, ids=["-".join(names) for names in OBJECTIVES])
def test_no_design_of_a_front_beats_another(objectives: tuple[str, ...]) -> None:
    front = front_of(objectives=objectives)
    values = front.values
    assert front.status is StopReason.GENERATIONS
    assert len(nondominated(values)) == len(values) > 1
    beaten = (front.seen[:, None] >= values[None]).all(axis=2).any(axis=1)
    assert beaten.all()  # or equal to one of the front
    assert (np.diff(values[:, 0]) > 0).all() or len(objectives) > 2
    assert front.evaluations == SMALL * 7


def test_scores_are_those_of_the_designs() -> None:
    front = front_of(objectives=("L", "mass", "chambers"))
    judge = counting_judge(front.scene)
    again = scored(judge, [one.points for one in front.designs])
    assert again == [one.score for one in front.designs]
    for one in front.designs:
        section = front.scene.design_of(one.points).section
        assert one.score.chambers == section.pieces.chambers
        assert one.score.mass == pytest.approx(1070e-6 * float(section.moments.area) * 100)


def test_the_front_improves_on_the_initial_one() -> None:
    """It covers more below a corner that no design reaches: the hypervolume grows."""
    front = find_front(
        load_scene("hand-drawn-section", ["search.generations=25"]), ("L", "mass"), population=40
    )
    values = [record.values for record in front.history]
    corner = np.concatenate(values).max(axis=0) * 1.01
    covered = [covered_area(np.log(one), np.log(corner)) for one in values]
    assert (np.diff(covered) >= -1e-12).all()
    assert covered[-1] > 2.0 * covered[0]
    assert values[-1][:, 0].min() < 0.3 * values[0][:, 0].min()


def covered_area(values: np.ndarray, corner: np.ndarray) -> float:
    """Area between a front of two objectives and a corner beyond it."""
    area, height = 0.0, corner[1]
    for x, y in values[np.argsort(values[:, 0])]:
        area += max(corner[0] - x, 0) * max(height - y, 0)
        height = min(height, y)
    return float(area)


def test_a_front_folder_holds_what_a_person_keeps(tmp_path: Path) -> None:
    front = find_front(SCENE, ("L", "mass"), tmp_path / "front", population=SMALL)
    names = {path.name for path in (tmp_path / "front").iterdir()}
    designs = {name for name in names if re.fullmatch(r"front-\d{3}\.json", name)}
    assert names - designs == {
        "journal.jsonl", "scene.toml", "front.csv", "history.csv", "summary.json", "pareto.svg",
        "pareto.png", "provenance.json", "timing.csv", "target-source.json",
    }  # fmt: skip
    header, *rows = (tmp_path / "front" / "front.csv").read_text().splitlines()
    assert header == "index,L,K,R,ratio,mass_g,chambers_1,chambers_2,chambers_3,design"
    assert len(rows) == len(front.designs)
    assert {row.rpartition(",")[2] for row in rows} - {""} == designs
    for row, one in zip(rows, front.designs, strict=True):
        cells = row.split(",")
        assert float(cells[1]) == one.score.verdict.L
        if cells[-1]:
            design = load_design(tmp_path / "front" / cells[-1])
            assert design.section.pieces.chambers == one.score.chambers
    summary = json.loads((tmp_path / "front" / "summary.json").read_text())
    assert summary["front"] == len(rows)
    assert load_scene(tmp_path / "front" / "scene.toml").search == SCENE.search


@pytest.mark.parametrize("most", [5, 8])
def test_few_designs_are_kept_with_the_best_of_each_objective_and_the_knee(
    most: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    front = front_of(objectives=("L", "mass", "ratio"))
    monkeypatch.setattr("beamopt.pareto.front.MOST_DESIGNS", most)
    kept = front.worth_keeping()
    assert len(front.designs) > most
    assert len(kept) <= most
    assert {0, front.knee, *front.values.argmin(axis=0).tolist()} <= set(kept)


def test_the_same_seed_gives_the_same_bytes(whole: Path, tmp_path: Path) -> None:
    with ThreadPoolExecutor(2) as executor:
        find_front(
            SCENE, ("L", "mass"), tmp_path / "b", population=SMALL, executor=executor, workers=2
        )
    assert content(tmp_path / "b") == content(whole)
    other = load_scene("hand-drawn-section", ["search.generations=6", "search.seed=1"])
    find_front(other, ("L", "mass"), tmp_path / "c", population=SMALL, figures=False)
    assert content(tmp_path / "c")["front.csv"] != content(whole)["front.csv"]


@pytest.mark.parametrize("cut", [0, 30, 3000, 9000, -1, -300])
def test_killed_anywhere_it_ends_in_the_same_bytes(cut: int, whole: Path, tmp_path: Path) -> None:
    journal = (whole / "journal.jsonl").read_bytes()
    (tmp_path / "journal.jsonl").write_bytes(journal[:cut])
    find_front(SCENE, ("L", "mass"), tmp_path, population=SMALL, resume=True)
    assert content(tmp_path) == content(whole)


def test_interrupted_it_ends_with_what_it_has_and_goes_on(whole: Path, tmp_path: Path) -> None:
    def interrupt(record: FrontRecord) -> None:
        if record.index == 2:
            raise KeyboardInterrupt

    folder = tmp_path / "front"
    front = find_front(SCENE, ("L", "mass"), folder, population=SMALL, callback=interrupt)
    assert front.status is StopReason.INTERRUPTED
    assert json.loads((folder / "summary.json").read_text())["generations"] == 2
    assert len((folder / "front.csv").read_text().splitlines()) == 1 + len(front.designs)
    find_front(SCENE, ("L", "mass"), folder, population=SMALL, resume=True)
    assert content(folder) == content(whole)


def test_it_can_be_given_more_generations(whole: Path, tmp_path: Path) -> None:
    short = load_scene("hand-drawn-section", ["search.generations=2"])
    find_front(short, ("L", "mass"), tmp_path / "front", population=SMALL)
    find_front(SCENE, ("L", "mass"), tmp_path / "front", population=SMALL, resume=True)
    assert content(tmp_path / "front") == content(whole)


def test_every_changed_digit_is_noticed(whole: Path, tmp_path: Path) -> None:
    path, about = tmp_path / "journal.jsonl", (SCENE, ("L", "mass"), SMALL)
    content = b"".join((whole / "journal.jsonl").read_bytes().splitlines(keepends=True)[:2])
    for damaged in flipped(content):
        path.write_bytes(damaged)
        with pytest.raises(InputError, match=r"journal\.jsonl: line [12]"):
            FrontJournal(path, *about)
    path.write_bytes(content)
    assert FrontJournal(path, *about).last_generation == 0


def test_a_front_never_goes_backwards(whole: Path, tmp_path: Path) -> None:
    folder = Path(shutil.copytree(whole, tmp_path / "front"))
    before = everything(folder)
    fewer = load_scene("hand-drawn-section", ["search.generations=5"])
    with pytest.raises(InputError) as caught:
        find_front(fewer, ("L", "mass"), folder, population=SMALL, resume=True, figures=False)
    assert (caught.value.key, caught.value.value) == ("search.generations", 5)
    assert everything(folder) == before


def test_resuming_a_finished_front_changes_no_byte(whole: Path, tmp_path: Path) -> None:
    folder = Path(shutil.copytree(whole, tmp_path / "front"))
    before = everything(folder)
    front = find_front(SCENE, ("L", "mass"), folder, population=SMALL, resume=True)
    assert front.timing.judged == 0
    assert everything(folder) == before

    def interrupt(record: FrontRecord) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        find_front(SCENE, ("L", "mass"), folder, population=SMALL, resume=True, callback=interrupt)
    assert everything(folder) == before


def test_only_what_is_cut_off_is_judged_again(whole: Path, tmp_path: Path) -> None:
    lines = (whole / "journal.jsonl").read_text().splitlines(keepends=True)
    L = json.dumps(json.loads(lines[1])["judged"][3][1])
    (tmp_path / "journal.jsonl").write_text(lines[0] + rewritten(lines[1], L, "0.125"))
    front = find_front(SCENE, ("L", "mass"), tmp_path, population=SMALL, resume=True, figures=False)
    assert front.values[0, 0] == 0.125


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('"generation": 1', '"generation": 3'),
        ('"judged": [[', '"judged": ['),
        ('"judged": [["', '"judged": [["00'),
        ("[[", '[["00", 0], ['),
        (", 0.0, ", ", -1.0, "),
        (", 0.0, ", ", NaN, "),
    ],
)
def test_a_changed_line_is_named(old: str, new: str, whole: Path, tmp_path: Path) -> None:
    lines = (whole / "journal.jsonl").read_text().splitlines(keepends=True)
    assert old in lines[2]
    for line in (lines[2].replace(old, new, 1), rewritten(lines[2], old, new)):
        (tmp_path / "journal.jsonl").write_text("".join([*lines[:2], line, *lines[3:]]))
        with pytest.raises(InputError, match="line 3"):
            find_front(SCENE, ("L", "mass"), tmp_path, population=SMALL, resume=True, figures=False)


@pytest.mark.parametrize(
    ("objectives", "population", "keys"),
    [
        (("L", "ratio"), SMALL, []),
        (("L", "mass"), 20, []),
        (("L", "mass"), SMALL, ["search.seed=1"]),
        (("L", "mass"), SMALL, ["making.density=900"]),
    ],
)
def test_another_question_is_refused(
    objectives: tuple[str, ...], population: int, keys: list[str], whole: Path, tmp_path: Path
) -> None:
    (tmp_path / "journal.jsonl").write_bytes((whole / "journal.jsonl").read_bytes())
    scene = load_scene("hand-drawn-section", ["search.generations=6", *keys])
    with pytest.raises(InputError, match="another question"):
        find_front(scene, objectives, tmp_path, population=population, resume=True)


def test_what_may_not_be_made_is_on_no_front_but_leads_there() -> None:
    """Of rejected ones those with fewer chambers too many are selected, until there are others."""
    keys = ("making.chambers=[2,2,2]", "making.chambers_rule='reject'")
    front = front_of(*keys, "section.feature_points=60", "search.generations=20")
    assert sum(front.rejected.values()) > 3 * SMALL
    assert len(front.history[0].values) == 0
    assert front.designs
    assert all(max(one.score.chambers) <= 2 for one in front.designs)


@pytest.mark.parametrize("symmetry", ["mirror", "three-fold"])
def test_every_candidate_is_symmetric_where_the_scene_says_so(symmetry: str) -> None:
    keys = [f"making.symmetry='{symmetry}'", "search.mutation_probability=0.5"]
    scene = load_scene("hand-drawn-section", keys)
    images = scene.making.repair(scene.grid.build())
    assert images is not None
    search, judge = FrontSearch(scene, ("L", "mass"), SMALL), counting_judge(scene)
    for _ in range(4):
        candidates = search.ask()
        assert [images.symmetrised(p).digest for p in candidates] == [p.digest for p in candidates]
        assert len({p.digest for p in candidates}) == SMALL
        search.tell(scored(judge, candidates))


def test_weighted_rules_are_part_of_the_first_objective() -> None:
    front = front_of("making.chambers=[1,1,1]", "making.chambers_weight=50")
    verdicts = [one.score.verdict for one in front.designs]
    assert front.values[:, 0].tolist() == [verdict.L + verdict.R for verdict in verdicts]
    assert max(verdict.R for verdict in verdicts) > 0


def test_the_command(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    about = ["hand-drawn-section", "--objectives", "L,mass", "--population", "16"]
    assert run(["pareto", *about, "--generations", "2", "--seed", "3"]) == 0
    said = capsys.readouterr().out
    for word in ("front", "lowest L", "lowest mass", "(index 0)", "time", "files"):
        assert word in said
    folder = tmp_path / "fronts" / "hand-drawn-section-L-mass-3"
    assert (folder / "pareto.png").exists()
    again = ["--out", str(folder), "--generations", "3", "--seed", "3", "--resume"]
    assert run(["pareto", *about, *again]) == 0
    assert json.loads((folder / "summary.json").read_text())["generations"] == 3


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--objectives", "L"], "--objectives: 'L': L and one or more of"),
        (["--objectives", "L,mass", "--set", "making.mass=1"], "making.mass"),
    ],
)
def test_mistakes_are_one_line(
    arguments: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = ["--out", str(tmp_path / "front")]
    assert run(["pareto", "hand-drawn-section", *arguments, *out]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1
    assert not (tmp_path / "front").exists()


def test_without_pymoo_it_says_what_to_install(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    import sys

    for name in [name for name in sys.modules if name.partition(".")[0] == "pymoo"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "pymoo", None)
    out = str(tmp_path / "front")
    assert run(["pareto", "hand-drawn-section", "--objectives", "L,mass", "--out", out]) == 2
    said = "beamopt: pymoo is not installed: pip install 'beamopt[search]'\n"
    assert capsys.readouterr().err == said
    assert not (tmp_path / "front").exists()
