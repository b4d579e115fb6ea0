"""Folders of `femcheck run --accuracy` on the page."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from beamopt.base.errors import InputError
from beamopt.scene.design import load_design
from femcheck.accuracy.ending import Source
from femcheck.accuracy.folder import run_accuracy
from femcheck.check.options import CheckOptions
from femcheck.models.question import Question
from femcheck.report.accuracy_run import read_accuracy_run
from femcheck.report.folders import ContentKind, find_folders
from femcheck.report.page import report_page
from tests.femcheck.report.folders import HOSTILE, Page, change_json, copied


@pytest.fixture(scope="module")
def answered(checked: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An answer of the beam to the design that was checked; tenths of a second."""
    folder = tmp_path_factory.mktemp("accuracy") / "answered"
    design = load_design(checked / "design.json")
    run_accuracy(Question.of("disc", design, CheckOptions()), 0.1, folder)
    return folder


def not_reached(answered: Path, to: Path) -> Path:
    """A copy that did not reach its accuracy, with a tip that is not there."""

    def summary(data: dict[str, Any]) -> None:
        data |= {
            "reached": False,
            "ending": "accuracy not reached: so",
            "worst_estimate_mm": 1234.5,
        }

    change_json(copied(answered, to) / "summary.json", summary)
    file = to / "tips.csv"
    lines = file.read_text().splitlines()
    cells = lines[9].split(",")
    lines[9] = ",".join([*cells[:3], *8 * [""], "limit point at P = 3 kPa", "solid.LIMIT_POINT"])
    file.write_text("\n".join(lines) + "\n")
    return to


def test_an_answer_is_found_and_read(answered: Path) -> None:
    assert [(one.kind, one.path) for one in find_folders([answered])] == [
        (ContentKind.ACCURACY, answered)
    ]
    run = read_accuracy_run(answered)
    assert (run.name, run.badge.text, run.badge.mood) == ("disc", "reached", "good")
    assert run.seconds > 0


def test_it_says_what_was_found(answered: Path) -> None:
    found = Page(report_page([answered]))
    words = ("accuracy reached", "0.1 mm", "rigid-section", "What was tried", "27 of 27")
    for said in (*words, Source.CLOSED_FORM.value):
        assert said in found.text
    rows = [
        attrs["data-row"] for tag, attrs in found.elements if tag == "tr" and "data-row" in attrs
    ]
    assert rows == [str(row) for row in range(27)]
    kept = {str(attrs.get("download")) for tag, attrs in found.elements if tag == "a"}
    assert {"accuracy-tips.csv", "accuracy-tried.csv", "accuracy-timing.csv"} <= kept


def test_an_accuracy_that_was_not_reached(answered: Path, tmp_path: Path) -> None:
    text = Page(report_page([not_reached(answered, tmp_path / "far")])).text
    for said in ("not reached", "accuracy not reached: so", "1,234 mm", "limit point at P = 3 kPa"):
        assert said in text


def test_it_stands_with_the_check_of_its_design(checked: Path, answered: Path) -> None:
    found = Page(report_page([checked, answered]))
    assert sum(attrs.get("class") == "design" for _, attrs in found.elements) == 1
    assert sum(attrs.get("class") == "card answer" for _, attrs in found.elements) == 1


def test_texts_stay_texts(answered: Path, tmp_path: Path) -> None:
    def hostile(data: dict[str, Any]) -> None:
        data |= dict.fromkeys(("design", "law", "ending", "chosen", "reason"), HOSTILE)

    folder = copied(answered, tmp_path / "hostile")
    change_json(folder / "summary.json", hostile)
    found = Page(report_page([folder]))
    assert found.text.count(HOSTILE) >= 5
    assert not any("onerror" in attrs for _, attrs in found.elements)


@pytest.mark.parametrize(
    ("file", "change", "said"),
    [
        ("summary.json", lambda text: text.replace("ending", "endink"), "ending: must be given"),
        ("summary.json", lambda text: text[:-20], "summary.json"),
        ("tips.csv", lambda text: text.replace("estimate_mm", "guess"), "estimate_mm"),
        ("tried.csv", lambda text: text.replace("27", "many"), "must be a number"),
        ("timing.csv", None, "timing.csv"),
        ("design.json", None, "design.json"),
    ],
)
def test_what_is_damaged_is_said(
    file: str, change: Callable[[str], str] | None, said: str, answered: Path, tmp_path: Path
) -> None:
    folder = copied(answered, tmp_path / "damaged")
    if change is None:
        (folder / file).unlink()
    else:
        (folder / file).write_text(change((folder / file).read_text()))
    with pytest.raises(InputError, match=said):
        report_page([folder])
