"""Targets of any pressures and tips: the loss they make, their files, mistakes in those."""

from pathlib import Path

import numpy as np
import pytest

from beamopt.base.errors import InputError
from beamopt.judge.judge import Judge
from beamopt.scene.bundled import bundled_scenes
from beamopt.scene.scene import load_scene
from beamopt.section.feature_points import FeaturePoints
from beamopt.target.aim import Aim, aim_of_workspace
from beamopt.target.point_table import aim_csv, direction_weight_of, read_pairs
from beamopt.target.target import BaseFrame, read_target

SCENES = bundled_scenes()
DRAWN = SCENES["hand-drawn-workspace"].with_name("hand_drawn_workspace.csv")
PAIRS = SCENES["pairs"].with_name("pairs.csv").read_text().splitlines()
HEADER = PAIRS[1]


def read(lines: list[str], folder: Path, **options: object) -> Aim:
    path = folder / "pairs.csv"
    path.write_text("\n".join(lines) + "\n")
    return read_pairs(path, 100.0, **options).aim  # type: ignore[arg-type]


def parts(aim: Aim) -> tuple[np.ndarray, ...]:
    return aim.pressures, aim.tips, aim.weights, aim.directions, aim.direction_weights


def candidates() -> list[FeaturePoints]:
    scene = load_scene("random-section")
    return [scene.random_points(np.random.default_rng([k])) for k in range(4)]


def test_the_27_rows_as_pairs_are_the_workspace(tmp_path: Path) -> None:
    """To the last bit, in any order of the rows; and so they are judged."""
    lines = DRAWN.read_text().splitlines()
    rows = [line for line in lines if line[:1].isdigit()]
    shuffled = np.random.default_rng(3).permutation(rows).tolist()
    workspace = read_target(DRAWN, (0.0, 50.0, 100.0), 100.0).workspace
    assert workspace is not None
    wanted = aim_of_workspace(workspace)
    for order in (rows, shuffled, rows[::-1]):
        found = read(["p1,p2,p3,x,y,z", *order], tmp_path)
        for a, b in zip(parts(found), parts(wanted), strict=True):
            np.testing.assert_array_equal(a, b)
    (tmp_path / "pairs.csv").write_text("\n".join(["p1,p2,p3,x,y,z", *shuffled]))
    named = f'target.file="{tmp_path / "pairs.csv"}"'
    points = load_scene("hand-drawn-workspace", ['target.kind="points"', named])
    plain = load_scene("hand-drawn-workspace")
    assert Judge.of_scene(points, points.load_target())(candidates()) == Judge.of_scene(
        plain, plain.load_target()
    )(candidates())


def test_the_order_of_rows_makes_no_difference(tmp_path: Path) -> None:
    first = read(PAIRS, tmp_path)
    for seed in range(3):
        rows = np.random.default_rng(seed).permutation(PAIRS[2:]).tolist()
        for a, b in zip(parts(read([HEADER, *rows], tmp_path)), parts(first), strict=True):
            np.testing.assert_array_equal(a, b)


def test_weights_scale_what_a_row_adds(tmp_path: Path) -> None:
    """L of all rows is the weighted sum of each row's own; of a row twice, twice."""
    judge = Judge.of_scene(load_scene("pairs"), load_scene("pairs").load_target())
    moments = judge.measured(candidates()).moments
    rng = np.random.default_rng(0)
    weights = rng.uniform(0, 3, len(PAIRS) - 2)
    weights[2] = 0
    rows = [line.split(",") for line in PAIRS[2:]]
    one_by_one = np.zeros(len(moments.area))
    for row, weight in zip(rows, weights, strict=True):
        alone = read([HEADER, ",".join([*row[:6], "1", *row[7:]])], tmp_path)
        tips = judge.rod.arcs(moments, alone.pressures)
        one_by_one += weight * ((tips - alone.tips) ** 2).sum(axis=(-2, -1))
    whole = [",".join([*row[:6], repr(float(w))]) for row, w in zip(rows, weights, strict=True)]
    short = ",".join(HEADER.split(",")[:7])
    aim = read([short, *whole], tmp_path)
    assert not aim.turns
    loss = aim.loss(judge.rod.arcs(moments, aim.pressures))
    np.testing.assert_allclose(loss, one_by_one, rtol=1e-13)
    twice = read([short, *whole, *whole], tmp_path)
    doubled = twice.loss(judge.rod.arcs(moments, twice.pressures))
    np.testing.assert_allclose(doubled, 2 * one_by_one, rtol=1e-13)
    assert twice.rms_distance(float(doubled[0])) == pytest.approx(aim.rms_distance(float(loss[0])))


def test_directions_add_their_squared_difference(tmp_path: Path) -> None:
    """Weights by row, by scene, or (length/10)²; any length of the vector; blank is none."""
    lines = [
        "p1,p2,p3,x,y,z,tx,ty,tz,direction_weight",
        "0,0,0,0,0,100,0,0,7,",
        "0,0,50,0,0,100,3,0,4,9",
        "0,50,50,0,0,100,,,,",
        "50,50,50,0,0,100,0,-1e-9,0,0",
    ]
    aim = read(lines, tmp_path)
    assert direction_weight_of(100.0) == 100
    np.testing.assert_array_equal(aim.direction_weights, [100, 9, 0, 0])
    np.testing.assert_allclose(aim.directions[1], [0.6, 0, 0.8], atol=1e-15)
    assert read(lines, tmp_path, direction_weight=4.0).direction_weights.tolist() == [4, 9, 0, 0]
    ways = np.tile([0.0, 0.0, 1.0], (4, 1))
    assert aim.loss(aim.tips, ways) == pytest.approx(9 * (0.6**2 + 0.2**2))
    with pytest.raises(ValueError, match="directions"):
        aim.loss(aim.tips)


def test_directions_count_in_a_verdict() -> None:
    """By the tips that the rod model itself gives, on every rung that is exact."""
    scene = load_scene("pairs")
    target = scene.load_target()
    assert target.aim.turns
    for rung in ("arc", "chain"):
        judge = Judge.of_scene(load_scene("pairs", [f"rod.rung={rung}"]), target)
        for points, verdict in zip(candidates(), judge(candidates()), strict=True):
            design = scene.design_of(points)
            found = design.solve(target.aim.pressures)
            assert found.directions is not None
            apart = ((found.positions - target.aim.tips) ** 2).sum(axis=1)
            turned = ((found.directions - target.aim.directions) ** 2).sum(axis=1)
            expected = target.aim.weights @ apart + target.aim.direction_weights @ turned
            assert pytest.approx(expected, rel=1e-10) == verdict.L


def test_the_bundled_pairs_belong_to_a_section() -> None:
    """Its file has four digits after the point, and directions five."""
    scene = load_scene("pairs")
    judge = Judge.of_scene(scene, scene.load_target())
    from beamopt.scene.design import load_design

    drawn = load_design(SCENES["hand-drawn-section"].with_name("hand_drawn_section.json"))
    assert judge.loss_of(drawn.values) < 1e-6
    assert judge.settled(drawn.values) is judge.aim


def test_a_base_frame_is_transformed_away(tmp_path: Path) -> None:
    """Positions and directions of a table in another frame: the same aim."""
    aim = read(PAIRS, tmp_path)
    x, z = np.array([0.0, 0.6, 0.8]), np.array([1.0, 0.0, 0.0])
    turn = np.stack([x, np.cross(z, x), z], axis=1)
    origin = np.array([5.0, -7.0, 1000.0])
    rows = []
    for p, tip, weight, way, counts in zip(*parts(aim), strict=True):
        there = (3 * (turn @ way)).tolist() if counts else ["", "", ""]
        rows.append(",".join(map(str, [*p, *(turn @ tip + origin), weight, *there])))
    moved = read([HEADER, *rows], tmp_path, base=BaseFrame((5, -7, 1000), (0, 3, 4), (2, 0, 0)))
    for a, b in zip(parts(moved), parts(aim), strict=True):
        np.testing.assert_allclose(a, b, rtol=0, atol=1e-9)


def test_what_is_written_is_read(tmp_path: Path) -> None:
    aim = read(PAIRS, tmp_path)
    for a, b in zip(parts(read([aim_csv(aim)], tmp_path)), parts(aim), strict=True):
        np.testing.assert_allclose(a, b, rtol=0, atol=1e-15)


BAD = [
    ("no rows", [HEADER], "no rows", "one pair"),
    ("empty", [], "empty", "p1,p2,p3,x,y,z"),
    ("no p3", [HEADER.replace("p3", "p4"), *PAIRS[2:]], "header", "p1,p2,p3,x,y,z"),
    ("two weights", [HEADER.replace("tx", "weight")], "header", "weight once"),
    ("NaN", [HEADER, "0,0,0,0,0,nan"], "line 2, z = 'nan'", "finite number of mm"),
    ("text", [HEADER, "0,0,o,0,0,100"], "line 2, p3 = 'o'", "finite number of kPa"),
    ("Pa", [HEADER, "0,0,50000,0,0,100"], "line 2, p3 = '50000'", "0 … 2000 kPa (are they kPa?)"),
    ("suction", [HEADER, "0,-1,0,0,0,100"], "line 2, p2 = '-1'", "0 … 2000 kPa"),
    ("metres", [HEADER, "0,0,50,0,0,0.1"], "0.1 mm from the base", "are they mm"),
    ("weight", [HEADER, "0,0,0,0,0,100,-2"], "line 2, weight = '-2'", "at least 0"),
    ("text weight", [HEADER, "0,0,0,0,0,100,two"], "line 2, weight = 'two'", "a finite number"),
    ("two of three", [HEADER, "0,0,0,0,0,100,1,0,,1"], "line 2, ty = ''", "all three or none"),
    ("zero", [HEADER, "0,0,0,0,0,100,1,0,0,0"], "line 2, tx = '0'", "zero vector"),
    ("nothing counts", [HEADER, "0,0,0,0,0,100,0"], "weight = 0", "at least one row must count"),
    (
        "lonely",
        [HEADER + ",direction_weight", "0,0,0,0,0,100,1,,,,5"],
        "line 2, direction_weight = '5'",
        "goes with tx, ty, tz",
    ),
]


@pytest.mark.parametrize(
    ("lines", "named", "allowed"), [b[1:] for b in BAD], ids=[b[0] for b in BAD]
)
def test_bad_tables(lines: list[str], named: str, allowed: str, tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        read(lines, tmp_path)
    said = str(caught.value)
    assert said.startswith(str(tmp_path / "pairs.csv"))
    assert named in said
    assert allowed in said
    assert "\n" not in said


def test_oddities(tmp_path: Path) -> None:
    """A tip without pressure that no section can move; columns and rows that a workspace leaves."""
    path = tmp_path / "pairs.csv"
    path.write_text("p1,p2,p3,x,y,z\n0,0,0,0,0,99\n")
    (said,) = read_pairs(path, 100.0).warnings
    assert "(0, 0, 99) mm" in said
    assert read_pairs(path, 100.0, straight=False).warnings == ()
    lines = DRAWN.read_text().splitlines()
    rows = [line for line in lines if line[:1].isdigit()]
    path.write_text("\n".join(["p1,p2,p3,x,y,z,weight", *rows, "25,0,0,0,0,100,2"]))
    extra, columns = read_target(path, (0.0, 50.0, 100.0), 100.0).warnings
    assert extra.startswith("1 rows at other pressures")
    assert 'kind = "points"' in extra
    assert columns.startswith("the columns weight were left out")
