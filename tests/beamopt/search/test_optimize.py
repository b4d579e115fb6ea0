import json
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from beamopt.base.errors import InputError
from beamopt.cli.application import run
from beamopt.scene.design import load_design
from beamopt.scene.scene import Scene, load_scene
from beamopt.search.algorithm import Generation
from beamopt.search.optimize import optimize
from beamopt.search.stopping import StopReason
from beamopt.storage.file_lock import locked
from beamopt.storage.result_folder import LOCK
from beamopt.storage.timing import read_times
from tests.validation.resume import UNLIKE, content, everything

SCENE = load_scene("hand-drawn-section", ["search.generations=5"])
STUCK = ("search.crossover_probability=0", "search.mutation_probability=0")


def test_a_run_folder_holds_what_a_person_keeps(tmp_path: Path) -> None:
    result = optimize(SCENE, tmp_path / "run")
    names = {path.name for path in (tmp_path / "run").iterdir()}
    assert names == {
        "scene.toml",
        "target-source.json",
        "target.csv",
        "journal.jsonl",
        "best.json",
        "final.json",
        "tips.csv",
        "history.csv",
        "summary.json",
        "best.svg",
        "best.png",
        "convergence.svg",
        "convergence.png",
        "timing.csv",
        "provenance.json",
    }
    best = load_design(tmp_path / "run" / "best.json")
    assert best.section.pieces == result.best.section.pieces
    assert load_scene(tmp_path / "run" / "scene.toml").search == SCENE.search
    summary = json.loads((tmp_path / "run" / "summary.json").read_text())
    assert summary["best"]["L"] == result.verdict.L
    rows = (tmp_path / "run" / "tips.csv").read_text().splitlines()[1:]
    away = [float(row.rpartition(",")[2]) for row in rows]
    assert sum(d * d for d in away) == pytest.approx(result.verdict.L, rel=1e-12)
    assert result.rms_distance == pytest.approx((result.verdict.L / 27) ** 0.5)


def test_the_run_of_a_run_is_the_same(tmp_path: Path) -> None:
    """A run folder's own scene, with the target that is kept there, gives the same search."""
    first = optimize(SCENE, tmp_path / "a", figures=False)
    again = optimize(load_scene(tmp_path / "a" / "scene.toml"), tmp_path / "b", figures=False)
    assert again.best.json() == first.best.json()
    assert content(tmp_path / "a") == content(tmp_path / "b")


def test_memory_and_folder_agree_for_any_executor(tmp_path: Path) -> None:
    plain = optimize(SCENE)
    with ThreadPoolExecutor(2) as executor:
        kept = optimize(SCENE, tmp_path / "run", executor=executor, workers=2, figures=False)
    assert list(plain.history) == list(kept.history)


def interrupted_at(index: int, folder: Path) -> StopReason:
    def interrupt(record: Generation) -> None:
        if record.index == index:
            raise KeyboardInterrupt

    return optimize(SCENE, folder, resume=True, callback=interrupt).status


def test_interrupted_runs_are_valid_and_go_on(tmp_path: Path) -> None:
    optimize(SCENE, tmp_path / "whole")
    assert interrupted_at(2, tmp_path / "run") is StopReason.INTERRUPTED
    halfway = json.loads((tmp_path / "run" / "summary.json").read_text())
    assert halfway["status"] == StopReason.INTERRUPTED.value
    assert halfway["generations"] == 2
    load_design(tmp_path / "run" / "best.json")
    optimize(SCENE, tmp_path / "run", resume=True)
    assert content(tmp_path / "run") == content(tmp_path / "whole")


def test_a_run_from_before_there_were_seals_goes_on(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    optimize(SCENE, folder, figures=False)
    before = content(folder)
    lines = (folder / "scene.toml").read_text().splitlines()
    first = lines.index("[seal]")
    (folder / "scene.toml").write_text("\n".join(lines[:first] + lines[first + 6 :]) + "\n")
    assert "islands" not in (folder / "scene.toml").read_text()
    optimize(SCENE, folder, resume=True, figures=False)
    assert content(folder) == before


def test_a_sealed_search_goes_on_and_keeps_its_seal(tmp_path: Path) -> None:
    short = load_scene("sealed-section", ["search.generations=1", "search.population=6"])
    scene = load_scene("sealed-section", ["search.generations=3", "search.population=6"])
    optimize(scene, tmp_path / "whole", figures=False)
    optimize(short, tmp_path / "run", figures=False)
    optimize(scene, tmp_path / "run", resume=True, figures=False)
    assert content(tmp_path / "run") == content(tmp_path / "whole")
    best = load_design(tmp_path / "run" / "best.json")
    assert best.seal == scene.seal
    assert not best.section.labels[[0, -1]].any()
    other = load_scene("sealed-section", ["seal.rounding=0", "search.population=6"])
    with pytest.raises(InputError, match=r"seal\.rounding = 0\.5"):
        optimize(other, tmp_path / "run", resume=True)


def test_a_run_can_be_made_longer(tmp_path: Path) -> None:
    longer = load_scene("hand-drawn-section", ["search.generations=8"])
    optimize(SCENE, tmp_path / "run", figures=False)
    optimize(longer, tmp_path / "run", resume=True, figures=False)
    optimize(longer, tmp_path / "whole", figures=False)
    assert content(tmp_path / "run") == content(tmp_path / "whole")


def test_a_finished_run_is_not_searched_again(tmp_path: Path) -> None:
    optimize(SCENE, tmp_path / "run", figures=False)
    before = content(tmp_path / "run")
    optimize(SCENE, tmp_path / "run", resume=True, figures=False)
    assert content(tmp_path / "run") == before


@pytest.mark.parametrize(
    ("less", "key", "value"),
    [
        (["search.generations=4"], "search.generations", 4),
        (["search.generations=0"], "search.generations", 0),
        (["stop.evaluations=60"], "stop.evaluations", 60),
        (["stop.loss=1e9"], "stop.loss", 1e9),
        (["stop.stall=1"], "stop.stall", 1),
    ],
)
def test_a_run_never_goes_backwards(
    less: list[str], key: str, value: float, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    five = [f"--set={one}" for one in ("search.generations=5", *(STUCK if "stall" in key else ()))]
    words = ["optimize", "hand-drawn-section", "--out", str(tmp_path / "run")]
    assert run([*words, *five]) == 0
    before = everything(tmp_path / "run")
    capsys.readouterr()
    assert run([*words, "--resume", *five, *(f"--set={one}" for one in less)]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert f"{key} = {value}" in said
    assert "the search there ended after generation 5" in said
    assert everything(tmp_path / "run") == before


def test_a_longer_run_that_stops_for_the_same_reason_changes_nothing(tmp_path: Path) -> None:
    keys = ["search.generations=5", "stop.evaluations=60"]
    first = optimize(load_scene("hand-drawn-section", keys), tmp_path / "run", figures=False)
    assert first.status is StopReason.EVALUATIONS
    before = everything(tmp_path / "run")
    optimize(load_scene("hand-drawn-section", keys), tmp_path / "run", resume=True, figures=False)
    assert everything(tmp_path / "run") == before


def test_reading_the_journal_is_no_search_to_be_cut(tmp_path: Path) -> None:
    optimize(SCENE, tmp_path / "run", figures=False)
    before = everything(tmp_path / "run")
    with pytest.raises(KeyboardInterrupt):
        interrupted_at(2, tmp_path / "run")
    assert everything(tmp_path / "run") == before


def test_times_are_of_sections_judged_and_not_of_compiling(tmp_path: Path) -> None:
    result = optimize(SCENE, tmp_path / "run", figures=False)
    times = read_times(tmp_path / "run" / "timing.csv")
    assert set(times) == {"search", "evaluation", "compilation"}
    assert result.timing.judged == result.evaluations == 110
    assert times["evaluation"] == pytest.approx(times["search"] / 110)
    longer = load_scene("hand-drawn-section", ["search.generations=7"])
    more = optimize(longer, tmp_path / "run", resume=True, figures=False)
    assert more.timing.judged == 36
    times = read_times(tmp_path / "run" / "timing.csv")
    assert times["evaluation"] == pytest.approx(times["search"] / 36)


def test_what_is_missing_of_a_finished_run_is_written_again(tmp_path: Path) -> None:
    optimize(SCENE, tmp_path / "run")
    before = everything(tmp_path / "run")
    for name in ("best.png", "tips.csv", "summary.json"):
        (tmp_path / "run" / name).unlink()
    optimize(SCENE, tmp_path / "run", resume=True)
    after = everything(tmp_path / "run")
    assert {name for name in before if before[name] != after[name]} <= UNLIKE
    assert read_times(tmp_path / "run" / "timing.csv")["evaluation"] > 0


def test_leftovers_of_a_kill_are_cleared_away(tmp_path: Path) -> None:
    optimize(SCENE, tmp_path / "run", figures=False)
    (tmp_path / "run" / ".best.json.123.tmp").write_text("half")
    optimize(SCENE, tmp_path / "run", resume=True, figures=False)
    assert not (tmp_path / "run" / ".best.json.123.tmp").exists()


@pytest.mark.parametrize(
    ("overrides", "named"),
    [
        (["search.seed=1"], "search.seed = 0"),
        (["grid.stop=350"], "grid.stop = 360"),
        (["grid.radial=64"], "grid.radial = 128"),
        (["search.mutation=weighted"], "search.mutation = 'direct'"),
        (["seal.skin=1"], "seal.skin = 0"),
    ],
)
def test_another_scene_does_not_go_on(overrides: list[str], named: str, tmp_path: Path) -> None:
    optimize(SCENE, tmp_path / "run", figures=False)
    before = content(tmp_path / "run")
    with pytest.raises(InputError) as caught:
        optimize(load_scene("hand-drawn-section", overrides), tmp_path / "run", resume=True)
    assert named in str(caught.value)
    assert content(tmp_path / "run") == before


def test_a_changed_target_file_does_not_go_on(tmp_path: Path) -> None:
    source = tmp_path / "drawn.json"
    source.write_bytes(Path(str(SCENE.target.file)).read_bytes())
    scene = SCENE.model_copy(
        update={"target": SCENE.target.model_copy(update={"file": str(source)})}
    )
    optimize(scene, tmp_path / "run", figures=False)
    source.write_text(source.read_text().replace("-38", "-37"))
    with pytest.raises(InputError, match="differs from the file"):
        optimize(scene, tmp_path / "run", resume=True)


def test_folders_with_something_else_are_left_alone(tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("precious")
    for resume in (False, True):
        with pytest.raises(InputError, match="holds files"):
            optimize(SCENE, tmp_path, resume=resume)
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]


@pytest.mark.parametrize(
    ("overrides", "reason", "generations"),
    [
        (["search.generations=3"], StopReason.GENERATIONS, 3),
        (["search.generations=0"], StopReason.GENERATIONS, 0),
        (["stop.evaluations=55"], StopReason.EVALUATIONS, 1),
        (["stop.evaluations=56"], StopReason.EVALUATIONS, 2),
        (["stop.seconds=0"], StopReason.SECONDS, 0),
        (["stop.loss=1e9"], StopReason.LOSS, 0),
        (["stop.stall=2", *STUCK], StopReason.STALL, 2),
    ],
)
def test_reasons_to_stop(overrides: list[str], reason: StopReason, generations: int) -> None:
    result = optimize(load_scene("random-section", overrides))
    assert result.status is reason
    assert result.last.index == generations


def test_a_sector_and_few_points_can_be_searched() -> None:
    keys = ["grid.start=10", "grid.stop=200", "section.feature_points=4", "search.generations=15"]
    ranged = [*keys, "search.recombination=range", "search.mutation=weighted"]
    result = optimize(load_scene("random-section", ranged))
    assert result.last.index == 15
    assert isinstance(result.scene, Scene)


def test_nothing_but_air_is_a_result_that_says_so(tmp_path: Path) -> None:
    keys = ["section.feature_points=1", "section.material_probability=0", "search.generations=2"]
    result = optimize(load_scene("hand-drawn-section", keys), tmp_path / "run")
    assert result.status is StopReason.NOTHING
    summary = json.loads((tmp_path / "run" / "summary.json").read_text())
    assert summary["status"] == "no candidate could be judged"
    assert summary["best"]["status"] == "the section has no material"
    assert (summary["ended"], summary["best"]["ended"]) == ("NOTHING", "NO_MATERIAL")
    assert not (tmp_path / "run" / "best.json").exists()
    with pytest.raises(InputError, match="no material"):
        optimize(load_scene("random-section", keys))


def test_another_processs_files_are_not_touched(tmp_path: Path) -> None:
    """Only who holds the folder's lock writes, and only our own leftovers are cleared away."""
    optimize(SCENE, tmp_path / "run", figures=False)
    for name in (".best.json.12.tmp", ".notes.tmp", ".mine.txt.1.tmp"):
        (tmp_path / "run" / name).write_text("x")
    with locked(tmp_path / "run" / LOCK), pytest.raises(InputError, match="another process"):
        optimize(SCENE, tmp_path / "run", resume=True, figures=False)
    assert (tmp_path / "run" / ".best.json.12.tmp").exists()
    optimize(SCENE, tmp_path / "run", resume=True, figures=False)
    held = {path.name for path in (tmp_path / "run").iterdir()}
    assert ".best.json.12.tmp" not in held
    assert {".notes.tmp", ".mine.txt.1.tmp"} <= held


def test_a_time_budget_goes_on_where_the_last_one_ended(tmp_path: Path) -> None:
    """What is on record is taken whole, however little time there is for more."""
    optimize(SCENE, tmp_path / "run", figures=False)
    keys = ["search.generations=50", "stop.seconds=0"]
    result = optimize(
        load_scene("hand-drawn-section", keys), tmp_path / "run", resume=True, figures=False
    )
    assert result.status is StopReason.SECONDS
    assert result.last.index == 6
