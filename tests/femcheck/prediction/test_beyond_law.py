"""A design stretched beyond what its law describes: statuses, tables, sentences, the report."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from femcheck.cli.application import run
from femcheck.continuation.outcome import Status
from femcheck.material.yeoh import Yeoh
from femcheck.prediction.prediction import Prediction
from femcheck.prediction.two_meshes import Agreement
from femcheck.prediction.verdict import advice, verdict
from femcheck.report.solid_run import read_solid_run
from femcheck.report.wording import MEANINGS, meaning
from tests.femcheck.check.small import design_of, three_circles
from tests.femcheck.prediction.small import SOFT, faked, predict

FALLING = {"C2_ratio": -0.15, "C3_ratio": 0.0}
"""Rises up to a stretch of 1.3."""
ALIKE, ONE = (1.0, 1.0, 1.0), (1.0, 0.0, 0.0)


@pytest.fixture(scope="module")
def left(tmp_path_factory: pytest.TempPathFactory) -> tuple[Prediction, Path]:
    """Of which the highest level is beyond the law; some seconds."""
    folder = tmp_path_factory.mktemp("left") / "soft"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("femcheck.solved.picture.draw", lambda *scene: False)
        return predict(folder, law="yeoh", constants=FALLING), folder


def test_rays_end_there(left: tuple[Prediction, Path]) -> None:
    found, _ = left
    law = found.law
    assert isinstance(law, Yeoh)
    assert 1.2 < law.most_stretch < 1.5
    gone = [result for result in found.results.values() if result.status is Status.BEYOND_LAW]
    assert len(gone) > 10
    for result in gone:
        assert result.last is not None
        assert result.last.load <= result.critical
        assert result.last.stretch <= law.most_stretch
        assert result.last.stretch > 1 + 0.9 * (law.most_stretch - 1)
        assert all(one is None or one.stretch <= law.most_stretch for one in result.answers)
    assert found.beyond_law > 0
    assert not found.holds
    assert found.not_computed == 0
    assert found.stable_box == min(result.critical for result in gone)


def test_tables_and_page_say_so(left: tuple[Prediction, Path]) -> None:
    found, folder = left
    rows = list(csv.DictReader((folder / "limits.csv").read_text().splitlines()))
    assert {row["ended"] for row in rows} >= {"solid.BEYOND_LAW"}
    material = json.loads((folder / "summary.json").read_text())["material"]
    ends = material["rises_up_to_stretch"]
    assert min(ends.values()) == pytest.approx(found.law.most_stretch, abs=1e-6)
    assert material["energy"] == found.law.text
    combinations = read_solid_run(folder).combinations
    assert combinations is not None
    beyond = [one for one in combinations.endings if one and one.status is Status.BEYOND_LAW]
    assert len(beyond) == found.beyond_law
    assert meaning(beyond[0]) == MEANINGS[Status.BEYOND_LAW]


def test_what_is_said() -> None:
    """Neither that the actuator has no equilibrium, nor that more time may bring one."""
    changes = {"law": "yeoh", "constants": FALLING}
    found = faked({ALIKE: (Status.BEYOND_LAW, 27.24)}, **changes)
    said, way_out = verdict(found), advice(found)
    assert "yeoh describes stretches up to" in said
    ends = next(ends for ends in found.compared if ends.ray.direction == ALIKE)
    assert (ends.loads, ends.agreement) == ((27.24, 27.24), Agreement.AGREE)
    assert (ends.standard.status, found.beyond_law) == (Status.BEYOND_LAW, 1)
    assert "1 of 26 combinations has no answer that is known" in said
    assert "exist" not in said
    assert way_out is not None
    assert way_out.startswith("stay below 18.1 kPa")  # with the margin of every advice
    assert "take a law that was fitted to larger stretches" in way_out
    assert "--resume" not in way_out
    assert found.stable_box == 27.24
    both = faked({ALIKE: (Status.BEYOND_LAW, 27.24), ONE: (Status.LIMIT_POINT, 31.0)}, **changes)
    assert "at 31 kPa" in verdict(both)
    assert both.stable_box == 27.24


def test_constants_of_a_test_curve_on_the_command_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """With a design of another E one line says so; the same curve goes with its ratios."""
    monkeypatch.chdir(tmp_path)
    moduli = {"youngs_modulus": SOFT, "shear_modulus": SOFT / 3}
    design_of(three_circles(), actuator=moduli).save(tmp_path / "disc.json")
    fitted = ["C1=7.83", "C2=0.103", "C3=-0.0008"]
    options = [word for one in fitted for word in ("--constant", one)]
    assert run(["run", "disc.json", "--law", "yeoh", *options]) == 2
    err = capsys.readouterr().err
    assert err.count("\n") == 1
    for word in ("C1 = 7.83", "E = 46.98 kPa", "100 kPa", "C2_ratio=0.0131545"):
        assert word in err
    assert run(["run", "disc.json", "--law", "yeoh", "--constant", "C1=-1"]) == 2
    assert "--constant: C1 = -1" in capsys.readouterr().err
    assert not np.any([path.is_dir() for path in tmp_path.iterdir()])
