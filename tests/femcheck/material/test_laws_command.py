"""`femcheck laws`: prints every law with its sources, and finds one that is wrong."""

import numpy as np
import pytest
from rich.console import Console

import femcheck.cli.laws
from femcheck.cli.application import run
from femcheck.material.catalogue import MATERIALS
from femcheck.material.gent import Gent


@pytest.fixture(autouse=True)
def wide(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(femcheck.cli.laws, "console", Console(highlight=False, width=400))


def test_all_is_well(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["laws"]) == 0
    said = capsys.readouterr().out
    for word in (*MATERIALS, "rigid-section", "pressure", "Elastosil M4601", "the design"):
        assert word in said
    assert "μ/2 (I1 − 3 − 2 ln J), μ = 100 kPa; incompressible" in said
    assert "λ3 − 1)² + G/2 (C13² + C23²) + cE/8 [(C11 − 1)²" in said  # no markup
    assert "5.67 (uniaxial 8.02, planar 7.98, equibiaxial 5.67)" in said
    assert "is not its" not in said


@pytest.mark.parametrize("factor", [1.0001, np.nan])
def test_a_wrong_stress(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, factor: float
) -> None:
    right = Gent.stress
    monkeypatch.setattr(Gent, "stress", lambda law, C: factor * right(law, C))
    assert run(["laws"]) == 1
    said = capsys.readouterr().out
    assert "gent (mixed): the stress is not its energy's derivative" in said
    assert "gent (displacements): the stiffness is not its stress's derivative" in said
    assert "yeoh (" not in said


def test_a_wrong_pressure_term(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    term = femcheck.cli.laws.PressureTerm
    right = term.stiffness
    monkeypatch.setattr(term, "stiffness", lambda self, C: right(self, C) * 1.01)
    assert run(["laws"]) == 1
    assert "pressure: the stiffness is not its stress's derivative" in capsys.readouterr().out
