import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beamopt.judge.judge import Judge, JudgeStatus, judge_all
from beamopt.rod.arc import arc_tips
from beamopt.rod.response import linear_response
from beamopt.scene.scene import load_scene
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.phenotype import phenotypes
from beamopt.target.workspace import loss, pressure_grid
from tests.validation import symmetry

SCENE = load_scene("hand-drawn-section")
TARGET = SCENE.load_target()
JUDGE = Judge.of_scene(SCENE, TARGET)


@pytest.fixture(scope="module")
def candidates() -> list[FeaturePoints]:
    return [SCENE.random_points(np.random.default_rng([k])) for k in range(7)]


def test_losses_are_those_of_the_design(candidates: list[FeaturePoints]) -> None:
    for points, verdict in zip(candidates, JUDGE(candidates), strict=True):
        tips = SCENE.design_of(points).workspace.tips
        assert pytest.approx(loss(tips, TARGET.workspace.tips), rel=1e-12) == verdict.L
        assert pytest.approx(verdict.L + verdict.K) == verdict.T


def test_the_second_objective_is_the_weighted_neighbour_ratio(
    candidates: list[FeaturePoints],
) -> None:
    ratios = phenotypes(SCENE.grid.build(), candidates, 4).neighbour_ratio
    assert [verdict.K for verdict in JUDGE(candidates)] == (1000.0 * ratios).tolist()


def test_a_verdict_does_not_depend_on_the_batch(candidates: list[FeaturePoints]) -> None:
    together = JUDGE(candidates)
    assert together == [JUDGE([points])[0] for points in candidates]
    assert together[::-1] == JUDGE(candidates[::-1])


def test_executors_and_workers_change_nothing(candidates: list[FeaturePoints]) -> None:
    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(3) as executor:
        assert judge_all(JUDGE, candidates, executor, 3) == JUDGE(candidates)


def test_the_targets_own_section_has_no_loss() -> None:
    scene = load_scene("random-section")
    points = scene.random_points(np.random.default_rng([scene.target.seed]))
    assert Judge.of_scene(scene, scene.load_target())([points])[0].L < 1e-18


def test_a_sealed_scene_judges_sealed_sections(candidates: list[FeaturePoints]) -> None:
    scene = load_scene("sealed-section")
    target = scene.load_target()
    for points, verdict in zip(candidates, Judge.of_scene(scene, target)(candidates), strict=True):
        design = scene.design_of(points)
        assert not design.section.labels[[0, -1]].any()
        response = linear_response(design.section.moments, design.actuator.youngs_modulus)
        strains = response.strains(pressure_grid(design.pressures))
        tips = arc_tips(strains, design.actuator.length)
        assert pytest.approx(loss(tips, target.workspace.tips), rel=1e-12) == verdict.L
        assert pytest.approx(verdict.K) == JUDGE([points])[0].K  # of the points alone


def test_a_sealed_section_without_a_chamber_left_is_judged() -> None:
    """A chamber too small after sealing leaves a rod that does not move."""
    scene = load_scene("sealed-section", ["seal.smallest_chamber=1000000"])
    points = scene.random_points(np.random.default_rng([0]))
    verdict = Judge.of_scene(scene, TARGET)([points])[0]
    still = np.tile([0.0, 0.0, 100.0], (27, 1))
    assert verdict.status is JudgeStatus.JUDGED
    assert pytest.approx(loss(still, TARGET.workspace.tips), rel=1e-12) == verdict.L
    air = FeaturePoints([15.0], [0.0], [2])  # with a skin this is two tubes, no longer nothing
    assert (
        Judge.of_scene(load_scene("sealed-section"), TARGET)([air])[0].status is JudgeStatus.JUDGED
    )


def test_no_feature_point_and_no_material_are_statuses() -> None:
    none = FeaturePoints([], [], [])
    air = FeaturePoints([15.0], [0.0], [2])
    verdicts = JUDGE([none, air])
    assert [v.status for v in verdicts] == [JudgeStatus.NO_FEATURE_POINTS, JudgeStatus.NO_MATERIAL]
    assert all(np.inf == v.T for v in verdicts)


def test_without_a_chamber_the_tip_stays() -> None:
    tips = JUDGE.tips([FeaturePoints([15.0, -15.0], [0.0, 0.0], [0, 0])])
    np.testing.assert_array_equal(tips[0], np.tile([0.0, 0.0, 100.0], (27, 1)))


@st.composite
def sections(draw: st.DrawFn) -> FeaturePoints:
    """Feature points on element centroids, few enough for the sections to differ a lot."""
    count = draw(st.integers(2, 40))
    rows = draw(st.lists(st.integers(0, 127), min_size=count, max_size=count))
    columns = draw(st.lists(st.integers(0, 359), min_size=count, max_size=count))
    types = draw(st.lists(st.integers(0, 3), min_size=count - 1, max_size=count - 1))
    x, y = symmetry.GRID.centroids[:, rows, columns]
    return FeaturePoints(x, y, [0, *types])


@given(sections(), st.integers(0, 359))
def test_rotating_the_points_by_columns_rotates_the_tips(p: FeaturePoints, k: int) -> None:
    assert symmetry.rotated(p, k) < symmetry.TOLERANCE * _amplified(p)


@given(sections())
def test_mirroring_mirrors(p: FeaturePoints) -> None:
    assert symmetry.mirrored(p) < symmetry.TOLERANCE * _amplified(p)


@given(sections(), st.permutations([1, 2, 3]))
def test_permuting_supplies_permutes(p: FeaturePoints, order: list[int]) -> None:
    assert symmetry.permuted(p, (order[0], order[1], order[2])) < 1e-12 * _amplified(p)


@given(sections())
def test_double_stiffness_at_double_pressure_changes_nothing(p: FeaturePoints) -> None:
    assert symmetry.stiffened(p) < 1e-12 * _amplified(p)


def _amplified(points: FeaturePoints) -> float:
    """How much rounding a section with little material left enlarges: by its largest stretch."""
    return max(1.0, float(np.linalg.norm(symmetry.tips(points), axis=1).max()) / 100) ** 2
