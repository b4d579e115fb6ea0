"""Sound files of every kind, and the process that runs commands on hostile ones."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.hostile.assets import make_assets
from tests.hostile.cases import Server


@pytest.fixture(scope="session")
def assets(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_assets(tmp_path_factory.mktemp("assets"))


@pytest.fixture(scope="session")
def server() -> Iterator[Server]:
    running = Server()
    yield running
    running.end()
