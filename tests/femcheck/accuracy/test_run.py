"""Answers as folders: files, going on, and what is refused."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from beamopt.base.errors import InputError
from beamopt.scene.named import named_design
from femcheck.accuracy.ending import Ending, beam_difference
from femcheck.accuracy.folder import FILES as WRITTEN
from femcheck.accuracy.folder import JOURNAL, run_accuracy
from femcheck.models.question import Question
from femcheck.prediction.options import PredictionOptions
from tests.femcheck.made_up import AT, DESIGN, NEO, RIGID, MadeUp, powers, question_of
from tests.validation.resume import everything

FILES = {JOURNAL, *WRITTEN}


def content(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def rows(file: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(file.read_text(encoding="utf-8").splitlines()))


def test_what_an_answer_leaves(tmp_path: Path) -> None:
    made = MadeUp(powers(1.0, 2), missing=lambda model: [1])
    with made.instead():
        found = run_accuracy(question_of(NEO), 1.0, tmp_path / "a")
    assert found.ending is Ending.REACHED
    assert {path.name for path in (tmp_path / "a").iterdir()} == FILES
    tips = rows(tmp_path / "a" / "tips.csv")
    assert [float(tips[0][name]) for name in ("p1", "p2", "p3")] == AT[0].tolist()
    assert found.reply is not None
    np.testing.assert_allclose(
        [float(tips[0][name]) for name in "xyz"], found.reply.tips[0], atol=1e-6
    )
    assert float(tips[0]["estimate_mm"]) == pytest.approx(found.estimate[0], abs=1e-6)
    error = made.off(made.asked[-1])
    assert float(tips[0]["difference_mm"]) == pytest.approx(error, abs=2e-6)
    own = DESIGN.tips(AT)[0]
    beam = [float(tips[0][f"beam_{name}"]) for name in "xyz"]
    np.testing.assert_allclose(beam, own, atol=1e-6)
    assert (tips[1]["x"], tips[1]["estimate_mm"], tips[1]["difference_mm"]) == ("", "", "")
    assert tips[1]["status"] == "limit point at P = 3 kPa"
    tried = rows(tmp_path / "a" / "tried.csv")
    assert [row["unknowns"] for row in tried] == [str(1000 * m.layers) for m in made.asked]
    assert {(row["found"], row["of"]) for row in tried} == {("2", "3")}
    times = rows(tmp_path / "a" / "timing.csv")
    assert [float(row["value"]) for row in times] == [m.layers for m in made.asked]
    said = json.loads((tmp_path / "a" / "summary.json").read_text())
    assert said["reached"] is True
    assert said["ending"] == "accuracy reached"
    assert said["chosen"] == f"{tried[-1]['model']}"
    assert said["accuracy_mm"] == 1.0
    assert said["worst_estimate_mm"] == pytest.approx(found.worst, rel=1e-3)
    again = Question.of("again", named_design(str(tmp_path / "a" / "design.json"))[1], NEO, AT)
    assert again.design.json() == DESIGN.json()


def test_it_goes_on_asks_nothing_twice_and_ends_in_the_same_files(tmp_path: Path) -> None:
    with MadeUp(powers(10.0, 2)).instead() as whole:
        run_accuracy(question_of(NEO), 0.5, tmp_path / "whole")
    lines = (tmp_path / "whole" / "journal.jsonl").read_bytes().splitlines(keepends=True)
    assert len(lines) == 1 + len(whole.asked)
    for kept, torn in ((len(lines), b""), (3, b""), (2, lines[2][:50]), (1, b"")):
        folder = tmp_path / f"{kept}-{len(torn)}"
        folder.mkdir()
        (folder / "journal.jsonl").write_bytes(b"".join(lines[:kept]) + torn)
        with MadeUp(powers(10.0, 2)).instead() as rest:
            run_accuracy(question_of(NEO), 0.5, folder, resume=True)
        assert rest.asked == whole.asked[kept - 1 :]
        assert content(folder) == content(tmp_path / "whole")


def test_what_was_too_dear_goes_on_with_more_time(tmp_path: Path) -> None:
    with MadeUp(powers(10.0, 2)).instead() as first:
        found = run_accuracy(question_of(NEO), 0.05, tmp_path / "a", most_seconds=8.0)
    assert found.ending is Ending.TOO_DEAR
    with MadeUp(powers(10.0, 2)).instead() as second:
        found = run_accuracy(question_of(NEO), 0.5, tmp_path / "b")
        more = run_accuracy(question_of(NEO), 0.05, tmp_path / "a", resume=True)
    assert more.ending in (Ending.REACHED, Ending.NOT_REACHED)
    assert not set(first.asked) & set(second.asked[len(found.tried) :])


def test_less_time_takes_nothing_back(tmp_path: Path) -> None:
    with MadeUp(powers(10.0, 2)).instead():
        whole = run_accuracy(question_of(NEO), 0.05, tmp_path / "a")
    before = everything(tmp_path / "a")
    with MadeUp(powers(10.0, 2)).instead() as rest:
        again = run_accuracy(question_of(NEO), 0.05, tmp_path / "a", most_seconds=1e-9, resume=True)
    assert rest.asked == []
    assert again.ending is whole.ending is not Ending.TOO_DEAR
    assert everything(tmp_path / "a") == before


def test_another_accuracy_or_question_is_refused(tmp_path: Path) -> None:
    question = question_of(RIGID)
    run_accuracy(question, 0.5, tmp_path / "a")
    before = content(tmp_path / "a")
    with pytest.raises(InputError, match="of another question"):
        run_accuracy(question, 0.4, tmp_path / "a", resume=True)
    with pytest.raises(InputError, match="of another question"):
        run_accuracy(question_of(RIGID, AT + 1), 0.5, tmp_path / "a", resume=True)
    with pytest.raises(InputError, match="--resume goes on"):
        run_accuracy(question, 0.5, tmp_path / "a")
    assert content(tmp_path / "a") == before


def test_bad_calls_leave_no_folder(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="above 0 mm"):
        run_accuracy(question_of(RIGID), 0.0, tmp_path / "a")
    gent = question_of(PredictionOptions(law="gent"))
    with pytest.raises(InputError, match="a beam has no gent"):
        run_accuracy(gent, 0.1, tmp_path / "a", rung="beam")
    assert list(tmp_path.iterdir()) == []


def test_no_model_is_a_folder_too(tmp_path: Path) -> None:
    loaded = Question.of(*named_design("gravity"), NEO)
    found = run_accuracy(loaded, 0.1, tmp_path / "a")
    assert found.ending is Ending.NO_MODEL
    said = json.loads((tmp_path / "a" / "summary.json").read_text())
    assert said["reached"] is False
    assert said["chosen"] == "none"
    assert said["worst_estimate_mm"] is None
    assert "has loads" in said["reason"]
    assert rows(tmp_path / "a" / "tips.csv") == []
    beam, difference = beam_difference(found)
    assert np.isfinite(beam).all()
    assert np.isnan(difference).all()


def test_a_damaged_journal_is_one_line(tmp_path: Path) -> None:
    run_accuracy(question_of(RIGID), 0.5, tmp_path / "a")
    with (tmp_path / "a" / "journal.jsonl").open("ab") as stream:
        stream.write(b'{"model": 3}\n')
    with pytest.raises(InputError, match="no journal of a question of this accuracy"):
        run_accuracy(question_of(RIGID), 0.5, tmp_path / "a", resume=True)
