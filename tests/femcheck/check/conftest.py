"""Checks that many tests look at; drawing, which takes a process and seconds, is left out."""

from pathlib import Path

import pytest

import femcheck.solved.picture
from femcheck.check.check_design import check_design
from femcheck.check.checked import Checked
from tests.femcheck.check.small import here, quick_options, small_options, small_subject


@pytest.fixture(scope="session")
def done(tmp_path_factory: pytest.TempPathFactory) -> tuple[Checked, Path]:
    """A whole check in this process, and its folder."""
    folder = tmp_path_factory.mktemp("check") / "small"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(femcheck.solved.picture, "draw", lambda *scene: False)
        return check_design(small_subject(), folder, small_options(), pool=here), folder


@pytest.fixture(scope="session")
def quick(tmp_path_factory: pytest.TempPathFactory) -> tuple[Checked, Path]:
    """The same with an element that locks."""
    folder = tmp_path_factory.mktemp("check") / "small"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(femcheck.solved.picture, "draw", lambda *scene: False)
        return check_design(small_subject(), folder, quick_options(), pool=here), folder


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(femcheck.solved.picture, "draw", lambda *scene: False)
