"""Solids of a section whose outline has few chords."""

import pytest

from femcheck.models import question
from tests.femcheck.check.small import Coarse


@pytest.fixture
def coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    """Outlines of solids with chords ten times farther from the smooth ones."""
    monkeypatch.setattr(question, "Subject", Coarse)
