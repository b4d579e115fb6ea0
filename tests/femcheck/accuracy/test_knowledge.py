"""What charts have taught, and that the packaged table is what the committed charts teach."""

import csv
import io
from collections.abc import Mapping
from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from shutil import copytree

import numpy as np
import pytest

from beamopt.base.processes import in_process
from femcheck.accuracy import knowledge
from femcheck.accuracy.ending import Ending
from femcheck.accuracy.knowledge import FILE, HEADER, MATERIAL, RIGID, learnt, levels_for, scale_of
from femcheck.accuracy.within import answer_within
from femcheck.chart import campaign as run
from femcheck.chart.campaign import run_chart
from femcheck.chart.chart import Chart
from femcheck.chart.kept import read_chart
from femcheck.chart.measure import Measured, key_of
from femcheck.models.question import LawChoice
from femcheck.models.reply import Model
from femcheck.models.solid import SolidModel
from tests.femcheck.made_up import NEO, MadeUp, powers, question_of
from tests.femcheck.made_up import RIGID as BEAMS

CHARTS = Path(__file__).parents[3] / "reports" / "chart"


@pytest.fixture(autouse=True)
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("femcheck.chart.measure.SPENT", 0.0)
    monkeypatch.setattr(run, "chart_figure", lambda chart: None)
    monkeypatch.setattr(run, "save_figure", lambda figure, *paths: None)


def charted(folder: Path, law: LawChoice, made: MadeUp) -> Chart:
    with made.instead():
        return run_chart(question_of(law), folder, families=["wedge18", "hex27"], pool=in_process)


def told(text: str) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(text)))


def test_what_charts_teach(tmp_path: Path) -> None:
    """Errors over the question's scale, of several charts the largest; models with all tips."""
    charted(tmp_path / "a", NEO, MadeUp(powers(2.0, 2)))
    charted(tmp_path / "b", NEO, MadeUp(powers(4.0, 2), seconds=lambda model: 0.5 * model.layers))
    lacking = MadeUp(powers(0.5, 4), missing=lambda model: [0] if model.layers == 2 else [])
    charted(tmp_path / "c", BEAMS, lacking)
    text = learnt([tmp_path / "a", tmp_path / "c", tmp_path / "b"])
    assert text.splitlines()[0] == HEADER
    rows = told(text)
    assert [(row["law"], int(row["layers"])) for row in rows] == [
        *((RIGID, n) for n in (3, 4, 6, 8)),
        *((MATERIAL, n) for n in (3, 4, 6, 8, 12)),
    ]
    scale = scale_of(question_of(NEO))
    for row in rows[4:]:
        n = int(row["layers"])
        assert float(row["error_over_scale"]) == pytest.approx(4.0 / n**2 / scale, rel=0.01)
        assert float(row["cpu_seconds"]) == n
        assert row["charts"] == "a b"
        assert float(row["grading"]) == 2 * n
    assert {row["grading"] for row in rows[:4]} == {""}
    assert {row["charts"] for row in rows[:4]} == {"c"}


def test_levels_beyond_charts_follow_from_the_order(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    charted(tmp_path / "a", NEO, MadeUp(powers(2.0, 2)))
    charted(tmp_path / "b", BEAMS, MadeUp(powers(2.0, 4)))
    (tmp_path / FILE).write_text(learnt([tmp_path / "a", tmp_path / "b"]))
    monkeypatch.setattr(knowledge, "files", lambda package: tmp_path)
    knowledge._read.cache_clear()
    try:
        material, rigid = levels_for(question_of(NEO)), levels_for(question_of(BEAMS))
    finally:
        knowledge._read.cache_clear()
    assert [level.model.layers for level in material] == [3, 4, 6, 8, 12, 16, 24]
    assert [level.model.grading for level in material] == [6, 8, 12, 16, 24, 32, 48]
    assert [level.model.layers for level in rigid] == [2, 3, 4, 6, 8, 12, 16]
    assert {level.model.grading for level in rigid} == {None}
    for levels, order in ((material, 2), (rigid, 4)):
        errors = np.array([level.error * level.model.layers**order for level in levels])
        np.testing.assert_allclose(errors, errors[0], rtol=0.02)
        assert levels[-1].seconds > levels[-2].seconds > levels[-3].seconds


def packaged() -> str:
    return files("femcheck.accuracy").joinpath(FILE).read_text(encoding="utf-8")


def committed(tmp_path: Path) -> list[Path]:
    """Copies of the chart folders that the packaged table names."""
    names = sorted({name for row in told(packaged()) for name in row["charts"].split()})
    missing = [name for name in names if not (CHARTS / name).is_dir()]
    assert not missing, f"knowledge.csv names charts that are not in reports/chart: {missing}"
    return [Path(copytree(CHARTS / name, tmp_path / name)) for name in names]


def test_the_packaged_table_is_what_the_committed_charts_teach(tmp_path: Path) -> None:
    assert learnt(committed(tmp_path)) == packaged()


class Replay:
    """A chart's replies in place of solids.

    Stiffer penalties and finer triangles move first levels as they move the chart's four layers.
    """

    def __init__(self, measured: Mapping[str, Measured], four: SolidModel) -> None:
        self.measured, self.four = measured, four

    def find(self, model: Model) -> Measured | None:
        assert isinstance(model, SolidModel)
        if key_of(model) in self.measured:
            return self.measured[key_of(model)]
        usual = {"size": self.four.size, "penalties": self.four.penalties}
        own = {"size": model.size, "penalties": model.penalties}
        if own == usual:
            raise LookupError(key_of(model))
        one, base, moved = (
            self.measured[key_of(other)]
            for other in (replace(model, **usual), self.four, replace(self.four, **own))
        )
        tips = one.reply.tips + moved.reply.tips - base.reply.tips
        return replace(one, resolution=model.resolution, reply=replace(one.reply, tips=tips))

    def keep(self, measured: Measured) -> None:
        raise AssertionError


def test_the_promise_holds_on_committed_charts(tmp_path: Path) -> None:
    """What real solids answered, put to the estimate: it is no less than the error, everywhere.

    As far as levels of the chart go; what the reference itself leaves open is allowed for.
    """
    reached = 0
    for folder in committed(tmp_path):
        chart = read_chart(folder)
        assert chart.reference is not None
        four = next(model for model, _ in chart.solids("wedge18") if model.layers == 4)
        known = {key_of(model): row.measured for model, row in chart.solids("wedge18")}
        for accuracy in (1.0, 0.3, 0.1, 0.03, 0.01, 0.003):
            try:
                found = answer_within(
                    chart.question, accuracy, rung="solid", kept=Replay(known, four)
                )
            except LookupError:  # of a level that the chart has not
                continue
            if "c to" in found.chosen:  # refined with penalties that the chart varies once only
                continue
            assert found.reply is not None
            error = found.reply.away(chart.reference.tips) - chart.reference.band
            there = np.isfinite(error) & np.isfinite(found.estimate)
            rounding = 1e-6 * chart.question.design.actuator.length
            assert (error[there] <= found.estimate[there] + rounding).all(), (folder, accuracy)
            if found.ending is Ending.REACHED:
                reached += 1
                assert np.nanmax(error) <= accuracy
    assert reached >= 3
