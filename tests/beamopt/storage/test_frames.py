"""Results as data frames: the same columns, rows and digits as the CSV files beside them."""

import csv
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import beamopt
import femcheck
from beamopt.base.processes import in_process
from beamopt.storage.frames import frame_of
from beamopt.storage.writing import cell_text, csv_text
from femcheck.accuracy.folder import run_accuracy
from tests.femcheck.check.small import design_of, quick_options, small_subject, three_circles


def assert_same(frame: pd.DataFrame, file: Path) -> None:
    """Every cell of the file, as a number where it is one, as its text else."""
    header, *rows = csv.reader(file.read_text().splitlines())
    assert list(frame.columns) == header
    assert len(frame) == len(rows) > 0
    for name, cells in zip(header, zip(*rows, strict=True), strict=True):
        for value, cell in zip(frame[name], cells, strict=True):
            if cell == "":
                assert pd.isna(value)
            elif isinstance(value, str):
                assert value == cell_text(cell)
            else:
                assert value == float(cell)


def test_tables_of_a_search(tmp_path: Path) -> None:
    found = beamopt.optimize(
        beamopt.load_scene("sealed-section", ["search.generations=0"]), tmp_path, figures=False
    )
    assert_same(found.to_frame(), tmp_path / "tips.csv")
    frame = found.best.workspace.to_frame()
    np.testing.assert_array_equal(frame[["x", "y", "z"]], found.best.workspace.tips)


@pytest.mark.parametrize("scene", ["random-section", "sealed-section"])
def test_table_of_a_front(tmp_path: Path, scene: str) -> None:
    small = beamopt.load_scene(scene, ["search.generations=0"])
    front = beamopt.find_front(small, ["L", "mass"], tmp_path, population=8, figures=False)
    assert_same(front.to_frame(), tmp_path / "front.csv")


def test_table_of_a_study(tmp_path: Path) -> None:
    small = ("search.generations=0", "search.population=4")
    plan = beamopt.Plan(1, overrides=small, targets=("random-section",), refine=False)
    found = beamopt.run_study(tmp_path / "study", plan, figures=False)
    assert_same(found.to_frame(), tmp_path / "study" / "table.csv")
    assert len(repr(found)) < 300


def test_tables_of_a_check(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("femcheck.solved.picture.draw", lambda *scene: False)
    checked = femcheck.check_design(small_subject(), tmp_path, quick_options(), pool=in_process)
    assert checked.comparison is not None
    assert_same(checked.to_frame(), tmp_path / "compare.csv")
    assert_same(checked.comparison.to_frame(), tmp_path / "table.csv")


def test_tables_of_answers_and_charts(tmp_path: Path) -> None:
    design = design_of(three_circles())
    question = femcheck.Question.of("disc", design, femcheck.CheckOptions())
    found = run_accuracy(question, 0.1, tmp_path / "answer")
    assert_same(found.to_frame(), tmp_path / "answer" / "tips.csv")
    chart = femcheck.run_chart(question, tmp_path / "chart", families=["beam"], pool=in_process)
    assert_same(chart.to_frame(), tmp_path / "chart" / "chart.csv")


def test_texts_and_digits_survive() -> None:
    rows = [("=1+1", 0.1 + 0.2, None), ("None", 1e-300, 1), ("a,b", np.inf, 2)]
    frame = frame_of(csv_text("text,number,count", rows))
    assert frame["text"].tolist() == ["=1+1", "None", "a,b"]
    assert frame["number"].tolist() == [0.1 + 0.2, 1e-300, np.inf]
    assert pd.isna(frame["count"][0])


def test_without_pandas_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ImportError, match=r"pip install 'beamopt\[frames\]'"):
        frame_of("a\n1\n")
