"""`femcheck chart` as a person meets it."""

from pathlib import Path

import numpy as np
import pytest

from beamopt.base.processes import in_process
from femcheck.chart import lineup
from femcheck.chart.campaign import run_chart
from femcheck.chart.kept import read_chart
from femcheck.chart.reference import Limit
from femcheck.cli.application import run
from tests.femcheck.check.small import design_of, three_circles
from tests.femcheck.made_up import MadeUp, powers


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A design, coarse rasters, and no process but this."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(lineup, "GRIDS", ((16, 60), (32, 120)))
    monkeypatch.setattr("femcheck.chart.measure.SPENT", 0.0)
    monkeypatch.setitem(run_chart.__kwdefaults__, "pool", in_process)
    design_of(three_circles()).save(tmp_path / "disc.json")
    return tmp_path


FEW = ["--family", "beam", "--family", "raster", "--levels", "0,5,10"]


def test_a_chart_says_who_is_cheapest(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["chart", "disc.json", *FEW]) == 0
    said = capsys.readouterr().out
    for words in ("disc, rigid-section, c → ∞: 27 tips", "Reference: closed form", "Within 0.1 mm"):
        assert words in said
    assert "charts/disc/ (chart.csv, chart.png, …)" in said
    assert (folder / "charts" / "disc" / "chart.png").stat().st_size > 1000
    chart = read_chart(folder / "charts" / "disc")
    assert chart.question.design.pressures == (0.0, 5.0, 10.0)
    assert np.abs(chart.question.pressures).max() == 10
    assert run(["chart", "disc.json", *FEW]) == 2
    assert "--resume goes on" in capsys.readouterr().err
    assert run(["chart", "disc.json", "--family", "beam", "--resume"]) == 2
    assert "of another question" in capsys.readouterr().err


def test_a_chart_without_a_reference_is_not_computed(folder: Path) -> None:
    """A material whose solids all end without a tip."""
    with MadeUp(powers(1.0, 2), missing=lambda model: range(27)).instead():
        assert run(["chart", "disc.json", "--law", "neo-hookean", "--family", "wedge18"]) == 3


def test_families_that_contradict_each_other(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Another family is sure of tips at the base, beside the closed form."""
    at_base = Limit("other", np.zeros((27, 3)), np.full(27, 0.1))
    monkeypatch.setattr("femcheck.chart.reference.limits_of", lambda *asked: [at_base])
    assert run(["chart", "disc.json", *FEW]) == 1


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["nothing"], ["nothing", "no such design"]),
        (["disc.json", "--levels", "1,2"], ["--levels", "three ascending pressures"]),
        (["disc.json", "--levels", "a,b,c"], ["--levels", "three ascending pressures"]),
        (["disc.json", "--levels", "0,10,5"], ["--levels", "three ascending pressures"]),
        (["disc.json", "--levels", "0,5,nan"], ["--levels", "three ascending pressures"]),
        (["disc.json", "--levels", "0,5,3000"], ["--levels", "up to 2000"]),
        (["disc.json", "--levels=-5,0,5"], ["--levels", "three ascending pressures"]),
        (["disc.json", "--family", "hex8"], ["--family", "hex8", "one of raster, beam"]),
        (["gravity", "--family", "wedge18"], ["--family", "wedge18", "none of them can be asked"]),
        (["disc.json", "--seconds", "0"], ["--seconds", "above 0 s"]),
        (["disc.json", "--seconds", "nan"], ["--seconds", "above 0 s"]),
        (["disc.json", "--law", "steel"], ["--law", "steel"]),
        (["disc.json", "--workers", "0"], ["--workers"]),
        (["disc.json", "--nu", "0.4"], ["--nu", "is no material"]),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else None,
)
def test_bad_input(
    folder: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], words: list[str]
) -> None:
    """One line, exit code 2, nothing left behind."""
    assert run(["chart", *arguments]) == 2
    err = capsys.readouterr().err
    assert err.startswith("femcheck: ")
    assert err.count("\n") == 1
    for word in words:
        assert word in err
    assert [path.name for path in folder.iterdir()] == ["disc.json"]


def test_a_shear_modulus_that_contradicts_the_material(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """As `femcheck run` refuses it."""
    stiff = {"shear_modulus": 150.0}
    design_of(three_circles(), actuator=stiff).save(folder / "stiff.json")
    for command in (["chart"], ["run", "--accuracy", "1mm"]):
        assert run([*command, "stiff.json", "--law", "neo-hookean"]) == 2
        assert "contradicts E = 300 kPa" in capsys.readouterr().err
