"""The seeded faults: each can still be put in."""

import importlib.util
from pathlib import Path

import pytest

from tests.validation.regression import FAULTS, Fault


@pytest.mark.parametrize("fault", FAULTS, ids=[fault.name for fault in FAULTS])
def test_text_stands_in_its_module(fault: Fault) -> None:
    spec = importlib.util.find_spec(fault.module)
    assert spec is not None
    assert spec.origin is not None
    assert Path(spec.origin).read_text(encoding="utf-8").count(fault.old) == fault.times
