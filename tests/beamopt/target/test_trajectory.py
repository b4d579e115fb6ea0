"""Trajectories: their points, their files, and the gradient of what they add to the loss."""

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from beamopt.base.errors import InputError
from beamopt.judge.judge import Judge
from beamopt.rod.arc import arc_tip_jacobian_by_response, arc_tips
from beamopt.rod.response import LinearResponse, linear_response
from beamopt.scene.bundled import bundled_scenes
from beamopt.scene.design import load_design
from beamopt.scene.scene import load_scene
from beamopt.section.moments import Moments
from beamopt.target.target import BaseFrame
from beamopt.target.trajectory import read_path, sampled

SCENES = bundled_scenes()
SPIRAL = SCENES["spiral"].with_name("spiral.csv")
DRAWN = load_design(SCENES["hand-drawn-section"].with_name("hand_drawn_section.json"))


def test_ends_and_corners_are_points_and_none_is_far() -> None:
    corners = np.array([[0.0, 0, 100], [0, 12, 100], [0, 12, 100], [5, 12, 100], [5, 12, 101]])
    points = sampled(corners, 5.0)
    np.testing.assert_array_equal(points[[0, 3, 4, 5]], corners[[0, 1, 3, 4]])
    assert len(points) == 6
    np.testing.assert_allclose(points[1], [0, 4, 100])
    lengths = np.linalg.norm(np.diff(sampled(corners, 0.7), axis=0), axis=1)
    assert lengths.max() <= 0.7 + 1e-12
    assert lengths.min() > 0


BAD = [
    ("one row", "x,y,z\n0,0,100", "1 row", "two different points"),
    ("no rows", "x,y,z", "0 rows", "two different points"),
    ("one place", "x,y,z\n0,0,100\n0,0,100", "the same point throughout", "two different"),
    ("empty", "", "empty", "x,y,z"),
    ("no z", "x,y\n0,0", "header", "x,y,z"),
    ("NaN", "x,y,z\n0,0,100\n0,nan,100", "line 3, y = 'nan'", "finite number of mm"),
    ("text", "x,y,z\n0,0,100\n0,,100", "line 3, y = ''", "finite number of mm"),
    ("metres", "x,y,z\n0,0,0.1\n0,0.01,0.1", "0.1005 mm from the base", "are they mm"),
    ("long", "x,y,z\n0,0,100\n" + "0,0,-4000\n0,0,4000\n" * 9, "samples at path_step", "10,000"),
]


@pytest.mark.parametrize(
    ("text", "named", "allowed"), [b[1:] for b in BAD], ids=[b[0] for b in BAD]
)
def test_bad_paths(text: str, named: str, allowed: str, tmp_path: Path) -> None:
    path = tmp_path / "path.csv"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        read_path(path, 100.0, 5.0)
    said = str(caught.value)
    assert said.startswith(str(path))
    assert named in said
    assert allowed in said
    assert "\n" not in said


@pytest.mark.parametrize("step", [1e-300, 1e-18, 1e-9, 1e-3])
def test_a_step_too_small(step: float, tmp_path: Path) -> None:
    """More pieces than an integer holds are too many, and not none."""
    path = tmp_path / "path.csv"
    path.write_text("x,y,z\n0,0,100\n5,0,99.5\n5,5,99.5\n")
    with pytest.raises(InputError, match="at most 10,000"):
        read_path(path, 100.0, step)


def test_a_base_frame_is_transformed_away(tmp_path: Path) -> None:
    plain = read_path(SPIRAL, 100.0, 3.0)
    corners = np.array([line.split(",") for line in SPIRAL.read_text().splitlines()[2:]], float)
    turned = corners[:, [2, 0, 1]] + np.array([1.0, 2.0, 3.0])
    path = tmp_path / "turned.csv"
    path.write_text("\n".join(["x,y,z", *(",".join(map(str, row)) for row in turned.tolist())]))
    base = BaseFrame((1, 2, 3), (0, 1, 0), (1, 0, 0))
    np.testing.assert_allclose(read_path(path, 100.0, 3.0, base), plain, rtol=0, atol=1e-12)


def test_the_bundled_spiral_is_inside_a_workspace() -> None:
    scene = load_scene("spiral")
    judge = Judge.of_scene(scene, scene.load_target())
    assert judge.loss_of(DRAWN.values) < 1e-12
    still = Moments(DRAWN.moments.raw * [[1], [0], [0], [0]])
    away = np.linalg.norm(judge.aim.paths - [0, 0, 100], axis=1)
    assert judge.rod.straight_length == 100
    stiff = replace(DRAWN.values, moments=still)
    assert judge.loss_of(stiff) == pytest.approx((away**2).sum())


def test_paths_add_to_any_target() -> None:
    """L with them is L without and the weighted squares; K is the same; rows are untouched."""
    scene = load_scene("hand-drawn-workspace")
    spiral = [f'target.paths=["{SPIRAL}"]', "target.path_weight=2.5", "target.path_step=4"]
    both = load_scene("hand-drawn-workspace", spiral)
    alone = load_scene("spiral", ["target.path_step=4"])
    points = [scene.random_points(np.random.default_rng([k])) for k in range(5)]
    judged = [Judge.of_scene(one, one.load_target())(points) for one in (scene, both, alone)]
    for plain, whole, paths in zip(*judged, strict=True):
        assert pytest.approx(plain.L + 2.5 * paths.L, rel=1e-12) == whole.L
        assert whole.K == plain.K
    target = both.load_target()
    assert target.workspace is not None
    assert len(target.aim) == 27
    assert len(target.aim.paths) == len(target.paths[0])


def test_settled_rows_have_the_loss_and_its_gradient() -> None:
    """Envelope theorem: ∂L/∂B at fixed pressures is that of L = Σ min_p |h(p; B) − q|².

    Points inside, outside, and with pressures held at the ends of their range; the differences are
    of the whole inner problem, solved anew.
    """
    rng = np.random.default_rng(4)
    scene = load_scene("spiral")
    target = scene.load_target()
    far = target.aim.paths[::8] * [1.8, 1.8, 1.02]
    aim = replace(target.aim, paths=np.concatenate([target.aim.paths[::16], far]), path_weight=1.7)
    judge = replace(Judge.of_scene(scene, target), aim=aim)
    B = linear_response(DRAWN.moments, 300.0).matrix * rng.uniform(0.8, 1.2, (3, 3))

    def judged(matrix: np.ndarray) -> tuple[float, np.ndarray]:
        respond = partial(lambda moments, response: response, response=LinearResponse(matrix))
        own = replace(judge, rod=replace(judge.rod, response_of=respond))
        settled = own.settled(DRAWN.values)
        assert not settled.has_paths
        tips = arc_tips(settled.pressures @ matrix.T, 100.0)
        loss = own.loss_of(DRAWN.values)
        assert loss == pytest.approx(float(settled.loss(tips)), rel=1e-9)
        by_response = arc_tip_jacobian_by_response(
            settled.pressures @ matrix.T, settled.pressures, 100.0
        )
        residuals = 2 * settled.weights[:, None] * (tips - settled.tips)
        return loss, np.einsum("nx,nxij->ij", residuals, by_response)

    loss, gradient = judged(B)
    assert loss > 1
    held = judge.settled(DRAWN.values).pressures
    assert ((held == 0) | (held == 100)).any()
    for i in range(3):
        for j in range(3):
            step = np.zeros((3, 3))
            step[i, j] = 1e-5 * np.abs(B[i]).max()
            slope = (judged(B + step)[0] - judged(B - step)[0]) / (2 * step[i, j])
            scale = np.abs(gradient[i]).max()
            assert gradient[i, j] == pytest.approx(slope, abs=1e-5 * scale)
