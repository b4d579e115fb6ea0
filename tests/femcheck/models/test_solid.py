"""The solid as a model: real ones, as coarse as can be, and what they refuse."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from beamopt.base.arrays import FloatArray
from beamopt.scene.named import named_design
from femcheck.check.options import CheckOptions
from femcheck.continuation.ended import FOUND, Ended
from femcheck.continuation.outcome import SolidOutcome, Status
from femcheck.mesh.gmsh_section import Mesher, MeshProblem
from femcheck.models import points
from femcheck.models.beam import RodOnOutline
from femcheck.models.question import LawChoice, Question
from femcheck.models.solid import SolidModel
from femcheck.prediction.options import PredictionOptions
from femcheck.solved.case import solve_case, stopped
from tests.femcheck.check.small import SIZES, design_of, small_options, three_circles

pytestmark = pytest.mark.usefixtures("coarse")

QUICK = SolidModel("wedge18", 2, 9.0)
QUICKEST = SolidModel("tet4", 2, 9.0)
ONE = np.array([[20.0, 0.0, 0.0]])
OPEN = {"skin": 0, "wall": 0, "rounding": 0, "smallest_chamber": 0}
NEO = PredictionOptions(sizes=SIZES)


def asked(law: LawChoice, pressures: FloatArray | None = None, **changes: Any) -> Question:
    return Question.of("small", design_of(three_circles(), **changes), law, pressures)


def test_three_points_are_those_of_the_grid() -> None:
    """From rest or predicted from neighbours: the same equilibrium, 15 % from the beam's.

    As far as the iteration goes: at these penalties a tip has 4e-5 mm left.
    """
    grid = asked(small_options())
    rows = [26, 9, 1]
    whole = QUICK.reply(grid)
    alone = QUICK.reply(grid.at(grid.pressures[rows]))
    assert whole.is_whole
    assert alone.endings == (FOUND,) * 3
    assert alone.away(whole.tips[rows]).max() < 2e-4
    assert (whole.unknowns, whole.size) == (alone.unknowns, alone.size)
    assert whole.size.endswith(" triangles × 2 layers of wedge18")
    beam = RodOnOutline().reply(grid)
    displacement = np.linalg.norm(beam.tips[-1] - beam.tips[0])
    assert whole.away(beam.tips).max() < 0.2 * displacement


def test_a_process_of_its_own_says_the_same() -> None:
    """Under a material's law, whose rays and winding go to the process."""
    question = asked(NEO, np.array([[10.0, 0, 0], [0, 0, 0]]))
    here, there = QUICK.reply(question), QUICK.reply(question, workers=1)
    assert here.endings == there.endings == (FOUND, FOUND)
    np.testing.assert_allclose(here.tips, there.tips, rtol=0, atol=1e-9)


def test_without_pressure_nothing_moves() -> None:
    """Under either law, with other combinations or without."""
    straight = [0, 0, asked(NEO).design.actuator.length]
    for law in (NEO, small_options()):
        reply = QUICK.reply(asked(law, np.zeros((1, 3))))
        assert reply.is_whole
        np.testing.assert_allclose(reply.tips, [straight], atol=1e-9)


def test_beyond_the_limit_point_there_is_a_reason() -> None:
    """And a tip at the combinations before it."""
    soft = {"youngs_modulus": 10.0, "shear_modulus": 10 / 3}
    at = np.array([[1.0, 0, 0], [40.0, 0, 0], [0.0, 0, 0]])
    reply = QUICK.reply(asked(NEO, at, actuator=soft))
    assert reply.found.tolist() == [True, False, True]
    assert np.isfinite(reply.tips).all(axis=1).tolist() == [True, False, True]
    assert reply.ended.status is Status.LIMIT_POINT
    assert reply.ended.load is not None
    assert 2.85 < reply.ended.load < 3.05
    assert reply.ended.load != float(f"{reply.ended.load:.4g}")  # no digit of it is lost


def test_a_mixed_solid_has_more_unknowns() -> None:
    whole = QUICK.reply(asked(NEO, np.zeros((1, 3))))
    alone = QUICK.reply(asked(replace(NEO, poisson_ratio=0.4), np.zeros((1, 3))))
    assert whole.unknowns > alone.unknowns


@pytest.mark.parametrize("law", [small_options(), NEO], ids=["rigid", "material"])
def test_a_mesh_that_fails_is_a_reason(law: LawChoice) -> None:
    broken = replace(law, mesher=Mesher("no-such-gmsh"))
    reply = QUICK.reply(asked(broken, ONE))
    assert not reply.found.any()
    assert reply.ended.status is MeshProblem.NO_GMSH
    assert "no-such-gmsh" in reply.ended.detail
    assert reply.unknowns == 0
    assert np.isnan(reply.tips).all()


def test_a_mesher_that_crashes_is_a_reason(tmp_path: Path) -> None:
    crashing = tmp_path / "crashing"
    crashing.write_text("#!/bin/sh\nexit 3\n")
    crashing.chmod(0o755)
    broken = small_options(mesher=Mesher(str(crashing)))
    assert QUICK.reply(asked(broken, ONE)).ended == Ended(MeshProblem.CRASHED, None, "exit code 3")


def test_time_runs_out() -> None:
    """In either penalty, with the load that was reached."""
    reply = QUICKEST.reply(asked(small_options(seconds=1e-9), ONE))
    assert reply.ended == Ended(Status.TIME_OUT, 0.0)
    assert np.isnan(reply.tips).all()


@pytest.mark.parametrize("lost", [2500.0, 10_000.0])
def test_one_penalty_alone_is_no_tip(lost: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is extrapolated from one; the reason is of the one that failed."""

    def some(case: Any) -> Any:
        if case.solid.name == f"c{lost:g}":
            return stopped()
        return solve_case(case)

    monkeypatch.setattr(points, "solve_case", some)
    reply = QUICKEST.reply(asked(small_options(), ONE))
    assert reply.ended.status is Status.STOPPED
    assert np.isnan(reply.tips).all()


def test_penalties_are_extrapolated(monkeypatch: pytest.MonkeyPatch) -> None:
    """Tips t + a / c give t, whatever the two penalties are."""

    class State:
        def __init__(self, tip: FloatArray) -> None:
            self.tip = tip

    class Result:
        status = Status.CONVERGED
        shape = None

        def __init__(self, c: float) -> None:
            tip = np.array([1.0, 2.0, 3.0]) + np.array([5.0, 0.0, -7.0]) / c
            self.outcome = SolidOutcome(Status.CONVERGED, State(tip), 1.0)  # type: ignore[arg-type]

    monkeypatch.setattr(points, "solve_case", lambda case: Result(float(case.solid.name[1:])))
    for penalties in ((2500.0, 10_000.0), (10.0, 30.0)):
        reply = replace(QUICKEST, penalties=penalties).reply(asked(small_options(), ONE))
        tip = reply.tips[0]
        np.testing.assert_allclose(tip[2], 3.0, atol=1e-9)
        np.testing.assert_allclose(tip[:2] - tip[0], [0, 1], atol=0.1)  # the centroid is off by it
        assert reply.is_whole


def test_what_a_solid_refuses() -> None:
    small = asked(CheckOptions())
    assert QUICK.refuses(small) is None
    assert QUICKEST.refuses(small) is None
    assert "no stable pair" in str(QUICKEST.refuses(asked(NEO)))
    assert QUICKEST.refuses(asked(replace(NEO, poisson_ratio=0.4))) is None
    assert "has loads" in str(QUICK.refuses(Question.of(*named_design("gravity"), CheckOptions())))
    touching = [{"supply": 1, "center": [12, 0], "radius": 4}, *three_circles()[1:]]
    opened = Question.of("open", design_of(touching, seal=OPEN), CheckOptions())
    assert "not sealed" in str(QUICK.refuses(opened))


def test_a_supply_without_a_chamber() -> None:
    """Its pressure moves nothing; the others' do."""
    design = design_of(three_circles()[:2])
    at = np.array([[0.0, 0.0, 20.0], [20.0, 0.0, 0.0]])
    reply = QUICK.reply(Question.of("two", design, small_options(), at))
    assert reply.is_whole
    np.testing.assert_allclose(reply.tips[0], [0, 0, design.actuator.length], atol=1e-6)
    assert np.linalg.norm(reply.tips[1] - reply.tips[0]) > 0.5


def test_the_mesh_is_the_models_and_the_law_the_questions() -> None:
    law = small_options(seconds=7.0, solver="superlu")
    options = SolidModel("tet10", 5, 3.0, (10.0, 20.0)).options(law)
    assert isinstance(options, CheckOptions)
    assert (options.layers, options.sizes.factor, options.penalties) == (5, 3.0, (10.0, 20.0))
    assert (options.grading, options.seconds) == (law.grading, 7.0)
    assert options.sizes.growth == law.sizes.growth
    graded = SolidModel("tet10", 5, 3.0, grading=9.0).options(NEO)
    assert graded.grading == 9.0
    assert isinstance(graded, PredictionOptions)


def test_models_that_differ_are_called_differently() -> None:
    models = [
        SolidModel(layers=4),
        SolidModel(layers=6),
        SolidModel(layers=4, size=1.0),
        SolidModel(layers=4, penalties=(10.0, 20.0)),
        SolidModel(layers=4, grading=8.0),
        SolidModel("hex27", 4),
    ]
    names = {f"{model.family} {model.resolution}" for model in models}
    assert len(names) == len(models)
    assert "wedge18 4 layers, size 2, graded 8" in names
    assert "wedge18 4 layers, size 2, c to 20" in names
