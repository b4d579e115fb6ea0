"""What a refinement judges on."""

import numpy as np
import pytest

from beamopt.judge.judge import JudgeStatus
from beamopt.outline.build import build_outline
from beamopt.refine.truth import View, answers_to, judged_on
from beamopt.section.feature_points import FeaturePoints
from tests.beamopt.refine.cases import SMALL, judge_of, judged, random_points, scene_of


@pytest.mark.parametrize("name", ["random-section", "sealed-section", "pairs", "spiral"])
def test_the_raster_as_a_search_judges_it(name: str) -> None:
    judge = judge_of(name)
    for seed in range(3):
        found = judged(judge, random_points(seed))
        assert found.verdict == judge([found.points])[0]
        assert found.found
        assert found.loss == found.verdict.L + found.verdict.R


@pytest.mark.parametrize("name", ["random-section", "sealed-section"])
def test_the_outline_as_it_is_built(name: str) -> None:
    judge = judge_of(name)
    points = random_points(1)
    outline = build_outline(judge.grid, points, judge.rules)
    alone = build_outline(judge.grid, points, judge.rules, inspected=False).moments
    np.testing.assert_array_equal(alone.raw, outline.moments.raw)
    found = judged(judge, points, View.OUTLINE)
    np.testing.assert_array_equal(found.section.moments.raw, outline.moments.raw)


TWISTS = ("loads.line_force=[2.0,0.0,0.0]", 'rod.rung="loaded"', 'rod.twist="saint-venant"')


@pytest.mark.parametrize("loads", [(), TWISTS], ids=["pressure alone", "twisted"])
def test_the_outline_as_a_design_has_it(loads: tuple[str, ...]) -> None:
    """Under loads also its torsion and shear."""
    asked = ("sealed-section", *SMALL, *loads)
    scene, judge = scene_of(*asked), judge_of(*asked)
    found = judged(judge, random_points(2), View.OUTLINE)
    workspace = scene.design_of(found.points).workspace
    assert pytest.approx(float(judge.aim.loss(workspace.tips)), rel=1e-12) == found.verdict.L


def test_points_of_paths_are_rows_at_the_best_pressures() -> None:
    judge = judge_of("spiral")
    found = judged(judge, random_points(0))
    assert len(found.aim) == len(judge.aim.paths) == len(found.answers.tips)
    assert float(found.answers.loss(found.aim)) == pytest.approx(found.verdict.L, rel=1e-9)
    again = answers_to(judge, found.aim, found.section)
    np.testing.assert_array_equal(again.tips, found.answers.tips)


@pytest.mark.parametrize("view", list(View))
def test_what_can_not_be_judged(view: View) -> None:
    judge, truth = judge_of(), judged_on(judge_of(), view)
    nothing = truth(FeaturePoints([], [], []))
    assert not nothing.found
    assert nothing.verdict.status is JudgeStatus.NO_FEATURE_POINTS
    hollow = truth(random_points(0).with_types(np.ones(25, dtype=np.uint8)))
    assert (hollow.found, hollow.loss) == (False, np.inf)
    assert hollow.aim is judge.aim
