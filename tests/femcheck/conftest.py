"""A prediction that tests of predictions and of reports look at, made once a process."""

from pathlib import Path
from typing import Any

import pytest

import femcheck.solved.picture
from femcheck.prediction.prediction import Prediction
from tests.femcheck.prediction.small import predict


@pytest.fixture(scope="session")
def pictured() -> list[tuple[Any, ...]]:
    """What the picture of `limited` would have been drawn of."""
    return []


@pytest.fixture(scope="session")
def limited(
    tmp_path_factory: pytest.TempPathFactory, pictured: list[tuple[Any, ...]]
) -> tuple[Prediction, Path]:
    """A whole prediction in this process, with figures: every ray balloons. Eight seconds."""
    folder = tmp_path_factory.mktemp("prediction") / "soft"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(femcheck.solved.picture, "draw", lambda *scene: pictured.append(scene))
        return predict(folder), folder
