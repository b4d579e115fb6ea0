"""Cells and paths whose answers are told."""

import pytest

import femcheck.stability.work
from tests.femcheck.stability.small import told_cell, told_row


@pytest.fixture
def told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(femcheck.stability.work, "solve_cell", told_cell)
    monkeypatch.setattr(femcheck.stability.work, "trace_row", told_row)
