"""Folders that reports are made of: a check and a prediction that take seconds."""

import shutil
from pathlib import Path

import pytest

import femcheck.solved.picture
from femcheck.check.check_design import check_design
from femcheck.prediction.prediction import Prediction
from femcheck.report.page import report_page
from tests.femcheck.check.small import here, quick_options, small_subject
from tests.femcheck.report.folders import figure_folder


@pytest.fixture(scope="session")
def checked(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A check of an element that locks, so that beam and solid differ. Two seconds."""
    folder = tmp_path_factory.mktemp("report") / "checked"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(femcheck.solved.picture, "draw", lambda *scene: False)
        check_design(small_subject("disc"), folder, quick_options(), pool=here)
    return folder


@pytest.fixture(scope="session")
def predicted(limited: tuple[Prediction, Path], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of a prediction that has some answers, and limits below the highest level."""
    folder = tmp_path_factory.mktemp("report") / "predicted"
    return Path(shutil.copytree(limited[1], folder))


@pytest.fixture(scope="session")
def chart(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of a figure with its table and reading."""
    return figure_folder(tmp_path_factory.mktemp("report") / "chart")


@pytest.fixture(scope="session")
def page(checked: Path, predicted: Path, chart: Path) -> str:
    """The report of all of them."""
    return report_page([checked, predicted, chart])
