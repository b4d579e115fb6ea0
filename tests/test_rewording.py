"""With every text of every status reworded, all goes on as before: files are of names and loads."""

import csv
import importlib
import json
import re
from collections.abc import Iterator
from contextlib import contextmanager
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from beamopt.base.errors import InputError
from beamopt.cli.refine import _check_ended
from beamopt.rod.ladder import Rung
from beamopt.rod.status import RodStatus
from beamopt.rod_map.cases import CaseKind as LoadKind
from beamopt.rod_map.cases import case_of
from beamopt.rod_map.journal import line_of, samples_in
from beamopt.rod_map.sampling import MethodSample, Sample
from beamopt.rod_map.verdict import MethodVerdict, Witness
from beamopt.scene.scene import load_scene
from beamopt.search.optimize import optimize
from beamopt.storage.line_journal import LineJournal
from beamopt.storage.old_wordings import OLD_STOP_REASONS
from femcheck.accuracy.folder import run_accuracy
from femcheck.chart.kept import read_chart
from femcheck.chart.lineup import mark_of
from femcheck.chart.measure import Measured, is_final, read, written
from femcheck.continuation.ended import FOUND, GROUPS, Ended
from femcheck.continuation.old_wordings import OLD_FAULTS, OLD_STATUSES, ended_of
from femcheck.continuation.outcome import Status
from femcheck.models.reply import Reply
from femcheck.models.solid import SolidModel
from femcheck.regression.baseline import read_baseline, write_baseline
from femcheck.regression.held import LADDER, is_late
from femcheck.regression.held_design import find_design
from femcheck.regression.measure import MeasuredPart as MeasuredRungs
from femcheck.regression.moved import compare
from femcheck.regression.regression import regress
from femcheck.report.folders import ContentKind as FolderKind
from femcheck.report.run_view import view_of
from femcheck.report.solid_run import read_solid_run
from femcheck.report.wording import meaning
from femcheck.solid.winding import Wound
from femcheck.stability.axes import AXES
from femcheck.stability.journal import ASKED, results_in
from tests.femcheck.check.small import here, quick_options, small_subject
from tests.femcheck.made_up import NEO, MadeUp, powers, question_of
from tests.femcheck.regression.small import held, saved
from tests.test_architecture import MODULES, ROOT, name_of

KEYS = {Wound, Rung, LoadKind, FolderKind}
"""Enums whose values are no texts for people but words of options and scenes."""
CUT_SHORT = {Status.TIME_OUT, Status.STOPPED, Status.WORK_LIMIT}
REPORTS = ROOT / "reports"
SOME = ["search.generations=1", "search.population=4"]


def texts() -> list[type[Enum]]:
    """Every enum of both packages whose values are texts."""
    for path in MODULES:
        importlib.import_module(name_of(path))
    found, waiting = [], list(Enum.__subclasses__())
    while waiting:
        kind = waiting.pop()
        waiting += kind.__subclasses__()
        own = kind.__module__.startswith(("beamopt.", "femcheck."))
        if own and kind not in KEYS and all(isinstance(one.value, str) for one in kind):
            found.append(kind)
    return found


@contextmanager
def reworded() -> Iterator[None]:
    """All texts are others, and none can be looked up."""
    before = {one: one.value for kind in texts() for one in kind}
    maps = {kind: dict(kind._value2member_map_) for kind in texts()}
    try:
        for one in before:
            one._value_ = f"so: {one.name[::-1]} at P = "  # with what was once looked for
        for kind in maps:
            kind._value2member_map_.clear()
        yield
    finally:
        for one, value in before.items():
            one._value_ = value
        for kind, known in maps.items():
            kind._value2member_map_.update(known)


def test_texts_are_reworded_and_stand_again() -> None:
    assert len(texts()) > 12
    with reworded():
        assert Status.TIME_OUT.value == "so: TUO_EMIT at P = "
        with pytest.raises(ValueError, match="time limit"):
            Status("time limit reached")
    assert Status("time limit reached") is Status.TIME_OUT


@pytest.mark.parametrize("group", GROUPS)
def test_every_status_has_a_key(group: str) -> None:
    for status in GROUPS[group]:
        assert Ended.of_key(Ended(status).key).status is status
        with reworded():
            assert Ended(status).key == f"{group}.{status.name}"
    with pytest.raises(ValueError, match=f"no status is called {group}.NONE"):
        Ended.of_key(f"{group}.NONE")


def test_old_texts_are_read() -> None:
    with reworded():
        for text, key in OLD_STATUSES.items():
            assert ended_of(text) == Ended.of_key(key)
            assert ended_of(f"{text} at P = 22.61 kPa") == Ended.of_key(key, 22.61)
        failed = ended_of("gmsh crashed: exit code 3")
    assert failed == Ended.of_key("mesh.CRASHED", None, "exit code 3")
    assert ended_of("solid.BUCKLED") == Ended(Status.BUCKLED)
    with pytest.raises(ValueError, match="no status is called"):
        ended_of("a text of nobody")


CHARTS = sorted(path.parent.name for path in (REPORTS / "chart").glob("*/journal.jsonl"))


def test_there_are_committed_charts() -> None:
    assert CHARTS


@pytest.mark.parametrize("folder", CHARTS)
def test_committed_charts_say_the_same(folder: str) -> None:
    before = read_chart(REPORTS / "chart" / folder)
    with reworded():
        after = read_chart(REPORTS / "chart" / folder)
    assert list(before.sentences()) == list(after.sentences())
    for one, other in zip(before.rows, after.rows, strict=True):
        assert one.measured.reply.endings == other.measured.reply.endings
        assert (one.error, one.missing, one.mark) == (other.error, other.missing, other.mark)


@pytest.mark.parametrize("status", Status)
def test_a_chart_that_goes_on_asks_again_for_what_was_interrupted(status: Status) -> None:
    """Also of what an older version wrote."""
    reply = Reply(np.full((1, 3), np.nan), (Ended(status, 10 / 3),))
    line = json.loads(json.dumps(written(Measured("a", "b", reply, 1.0))))
    with reworded():
        again = read(line)
        assert is_final(again, 1) == (status not in CUT_SHORT)
    assert again.reply.endings == reply.endings
    old = {text for text, key in OLD_STATUSES.items() if key == Ended(status).key}
    for text in old:
        line = {**line, "reasons": [f"{text} at P = 3.333 kPa"]}
        line.pop("endings", None)
        with reworded():
            assert is_final(read(line), 1) == is_final(again, 1)


def test_a_mark_of_a_figure_is_of_numbers() -> None:
    assert mark_of(SolidModel(layers=4, size=0.5, grading=8.0)) == "4 / 0.5"


def test_an_answer_to_an_accuracy_goes_on(tmp_path: Path) -> None:
    """Nothing is asked twice, and the same is reached."""
    made = MadeUp(powers(1.0, 2), missing=lambda model: [1])
    with made.instead():
        first = run_accuracy(question_of(NEO), 1.0, tmp_path / "a")
    asked = len(made.asked)
    with reworded(), made.instead():
        again = run_accuracy(question_of(NEO), 1.0, tmp_path / "a", resume=True)
        fresh = run_accuracy(question_of(NEO), 1.0, tmp_path / "b")
        summary = json.loads((tmp_path / "a" / "summary.json").read_text())
        rows = csv.DictReader((tmp_path / "a" / "tips.csv").read_text().splitlines())
        endings = [row["ended"] for row in rows]
    assert first.ending is again.ending is fresh.ending
    assert len(made.asked) == 2 * asked
    assert (summary["ended"], summary["reached"]) == (first.ending.name, True)
    assert endings == [FOUND.key, "solid.LIMIT_POINT", FOUND.key]


def test_committed_baselines_are_read() -> None:
    with reworded():
        limits = read_baseline(REPORTS / "baseline" / "round_chambers-sealed.json")
    (endings,) = (one.held for one in limits.held if one.quantity == "endings")
    assert list(endings.rows.values()) == [Ended(Status.LIMIT_POINT)]


def test_committed_faults_have_not_moved(tmp_path: Path) -> None:
    """Their rows were once called by texts."""
    names, rungs = ["random-section"], ["outline"]
    with reworded():
        found = regress(names, REPORTS / "baseline", ROOT / "meshes", rungs=rungs)
        assert found.holds
        assert found.rows == 2


def test_a_baseline_holds_whatever_its_statuses_are_called(tmp_path: Path) -> None:
    design = find_design(str(saved(tmp_path)), tmp_path)
    rows = {status.name: Ended(status, 3.0, "here") for status in Status}
    law = {"law": "a title", "tolerance": 0.0}
    (tmp_path / "held").mkdir()
    file = write_baseline(tmp_path / "held", design, (held(rows, "beam", **law),))
    with reworded():
        base = [entry.held for entry in read_baseline(file).held]
        now = MeasuredRungs((held(rows, "beam", **law | {"law": "another title"}),))
        assert compare("d", base, now) == []
        other = {name: Ended(Status.TIME_OUT) for name in rows}
        moved = compare("d", base, MeasuredRungs((held(other, "beam"),)))
        assert all(is_late(one.now) for one in moved)
    assert {one.row for one in moved} == set(rows) - {"TIME_OUT"}
    assert {entry.rung for entry in read_baseline(file).held} <= set(LADDER)


def test_a_report_says_the_same_of_a_folder(tmp_path: Path) -> None:
    """Of one that was written before texts were reworded, and of one without names."""
    from femcheck.check.check_design import check_design

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("femcheck.solved.picture.draw", lambda *scene: False)
        check_design(small_subject("disc"), tmp_path / "new", quick_options(), pool=here)
    view = view_of(read_solid_run(tmp_path / "new"), "a")
    with reworded():
        again = read_solid_run(tmp_path / "new")
        assert view_of(again, "a").meanings == view.meanings
    table = tmp_path / "new" / "table.csv"
    table.write_text("\n".join(line.rpartition(",")[0] for line in table.read_text().splitlines()))
    with reworded():
        assert view_of(read_solid_run(tmp_path / "new"), "a").meanings == view.meanings
    assert all(meaning(one) for one in (again.combinations.endings if again.combinations else ()))


def test_the_map_of_stability_is_read() -> None:
    journal = LineJournal(REPORTS / "stability" / "journal.jsonl", None, "map")
    assert journal.asked == ASKED
    before = results_in(journal, AXES)
    with reworded():
        after = results_in(journal, AXES)
    assert {key: one.ending for key, one in before.items()} == {
        key: one.ending for key, one in after.items()
    }
    assert len(before) > 400


def test_a_search_goes_on_in_the_same_bytes(tmp_path: Path) -> None:
    scene = load_scene("random-section", SOME)
    optimize(scene, tmp_path / "a", figures=False)
    journal = tmp_path / "a" / "journal.jsonl"
    whole, best = journal.read_bytes(), (tmp_path / "a" / "best.json").read_bytes()
    journal.write_bytes(b"".join(whole.splitlines(keepends=True)[:2]))
    with reworded():
        optimize(scene, tmp_path / "a", resume=True, figures=False)
    assert journal.read_bytes() == whole
    assert (tmp_path / "a" / "best.json").read_bytes() == best


@pytest.mark.parametrize("witness", Witness)
def test_the_map_of_rods_is_read(witness: Witness, tmp_path: Path) -> None:
    """Also by another wording than it was written with, and as earlier versions wrote it."""
    asked = {"seed": 0}
    rows = (
        MethodSample(case_of(0, 0), "modes", 4, MethodVerdict.RIGHT, RodStatus.BUCKLED, 0.5, 1.0),
    )
    sample = Sample(case_of(0, 0), witness, RodStatus.CONVERGED, 0.25, rows, 2.0)
    LineJournal(tmp_path / "a", asked, "map").add(line_of(sample))
    with reworded():
        (again,) = samples_in(LineJournal(tmp_path / "a", asked, "map")).values()
        LineJournal(tmp_path / "b", asked, "map").add(line_of(sample))
    assert (again.witness, again.truth) == (witness, RodStatus.CONVERGED)
    assert (again.rows[0].verdict, again.rows[0].status) == (MethodVerdict.RIGHT, RodStatus.BUCKLED)
    whole = (tmp_path / "a").read_text()
    assert (tmp_path / "b").read_text() == whole
    old = re.sub(r',"digest":"\w+"', "", whole.replace(witness.name, witness.name.lower()))
    (tmp_path / "a").write_text(old)
    assert samples_in(LineJournal(tmp_path / "a", asked, "map"))[0].witness is witness


@pytest.mark.parametrize("text", OLD_STOP_REASONS)
def test_only_a_search_that_ended_is_refined(text: str, tmp_path: Path) -> None:
    """By the name in its summary, or the text in an earlier one."""
    name = OLD_STOP_REASONS[text]
    summaries: list[dict[str, Any]] = [{"status": text}, {"status": "reworded", "ended": name}]
    for summary in summaries:
        (tmp_path / "summary.json").write_text(json.dumps(summary))
        with reworded():
            if name in ("SECONDS", "INTERRUPTED"):
                with pytest.raises(InputError, match="go on with it by"):
                    _check_ended(tmp_path)
            else:
                _check_ended(tmp_path)


def test_old_tables_name_what_there_is() -> None:
    from beamopt.outline.faults import FaultKind
    from beamopt.search.stopping import StopReason

    assert set(OLD_STOP_REASONS.values()) <= set(StopReason.__members__)
    assert set(OLD_FAULTS.values()) <= set(FaultKind.__members__)
