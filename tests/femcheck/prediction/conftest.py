"""Predictions that many tests look at; the picture, which takes a process and seconds, is not."""

from pathlib import Path

import pytest

import femcheck.prediction.predict_design
import femcheck.solved.picture
from femcheck.prediction.prediction import Prediction
from tests.femcheck.prediction.small import predict, soft_subject

Done = tuple[Prediction, Path]


@pytest.fixture(scope="session")
def calm(tmp_path_factory: pytest.TempPathFactory) -> tuple[Prediction, Path]:
    """The same at pressures that it stands, asked for no more than it gives. Four seconds."""
    folder = tmp_path_factory.mktemp("prediction") / "soft"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(femcheck.solved.picture, "draw", lambda *scene: False)
        patch.setattr(femcheck.prediction.predict_design, "save_figure", lambda *figure: None)
        return predict(folder, soft_subject(levels=[0, 1, 2]), agree=1.0), folder


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(femcheck.solved.picture, "draw", lambda *scene: False)
    monkeypatch.setattr(femcheck.prediction.predict_design, "save_figure", lambda *figure: None)
