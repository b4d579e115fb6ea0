"""The seeded faults: each can still be put in, and every folder has one."""

import importlib.util
from pathlib import Path

import pytest

from tests.faults import FAULTS, ROOT, Fault
from tests.test_architecture import LEVELS


@pytest.mark.parametrize("fault", FAULTS, ids=[fault.name for fault in FAULTS])
def test_text_stands_in_its_module(fault: Fault) -> None:
    spec = importlib.util.find_spec(fault.module)
    assert spec is not None
    assert spec.origin is not None
    assert Path(spec.origin).read_text(encoding="utf-8").count(fault.old) == fault.times
    assert (ROOT / fault.caught_by).is_file()


def test_every_folder_has_one() -> None:
    assert {".".join(fault.module.split(".")[:2]) for fault in FAULTS} == set(LEVELS)
