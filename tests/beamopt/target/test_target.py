from pathlib import Path

import numpy as np
import pytest

from beamopt.base.errors import InputError
from beamopt.scene.bundled import bundled_scenes
from beamopt.target.target import BaseFrame, read_target
from beamopt.target.workspace import pressure_grid, tips_csv

LEVELS = (0.0, 50.0, 100.0)
DRAWN = bundled_scenes()["hand-drawn-workspace"].with_name("hand_drawn_workspace.csv")
LINES = DRAWN.read_text().splitlines()


def read(text: str, folder: Path, **options: object) -> np.ndarray:
    path = folder / "target.csv"
    path.write_text(text)
    return read_target(path, LEVELS, 100.0, **options).workspace.tips  # type: ignore[arg-type]


def test_rows_are_matched_by_pressure(tmp_path: Path) -> None:
    shuffled = [LINES[0], *np.random.default_rng(0).permutation(LINES[1:])]
    expected = read_target(DRAWN, LEVELS, 100.0).workspace.tips
    np.testing.assert_array_equal(read("\n".join(shuffled), tmp_path), expected)


def test_columns_are_matched_by_name_and_comments_left_out(tmp_path: Path) -> None:
    pressures = pressure_grid(LEVELS)
    tips = pressures[:, ::-1] + [0, 0, 100]
    rows = [
        f"note, {t[2]}, {t[0]}, {t[1]}, {p[2]}, {p[1]}, {p[0]}"
        for p, t in zip(pressures, tips, strict=True)
    ]
    text = "\n".join(["# a comment", "what,z,x,y,p3,p2,p1", *rows, "", "# end"])
    np.testing.assert_array_equal(read(text, tmp_path), tips)


def test_what_is_written_is_read(tmp_path: Path) -> None:
    tips = np.random.default_rng(1).normal(size=(27, 3)) + np.array([0, 0, 100])
    np.testing.assert_array_equal(read(tips_csv(pressure_grid(LEVELS), tips), tmp_path), tips)


def test_a_base_frame_is_transformed_away(tmp_path: Path) -> None:
    tips = read_target(DRAWN, LEVELS, 100.0).workspace.tips
    x, z = np.array([0.0, 0.6, 0.8]), np.array([1.0, 0.0, 0.0])
    turn = np.stack([x, np.cross(z, x), z], axis=1)
    origin = np.array([5.0, -7.0, 1000.0])
    text = tips_csv(pressure_grid(LEVELS), tips @ turn.T + origin)
    base = BaseFrame((5, -7, 1000), (0, 3, 4), (2, 0, 0))
    np.testing.assert_allclose(read(text, tmp_path, base=base), tips, atol=1e-9)


@pytest.mark.parametrize(
    ("x", "z", "said"), [((1, 0, 0), (1, 0, 1), "perpendicular"), ((0, 0, 0), (0, 0, 1), "zero")]
)
def test_impossible_base_frames(x: tuple, z: tuple, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        BaseFrame((0, 0, 0), x, z)


BAD = [
    ("26 rows", LINES[:-1], "26 of 27 pressure combinations", "(100, 100, 100) kPa has none"),
    ("no rows", LINES[:1], "0 of 27", "(0, 0, 0) kPa has none"),
    ("NaN", [*LINES[:-1], "100,100,100,0,nan,136"], "line 28, y = 'nan'", "finite number of mm"),
    ("text", [*LINES[:-1], "100,1oo,100,0,0,136"], "line 28, p2 = '1oo'", "finite number of kPa"),
    ("short row", [*LINES[:-1], "100,100,100,0"], "line 28, y = ''", "finite"),
    ("too large", [*LINES[:-1], "100,100,100,0,1e300,136"], "y = '1e300'", "finite number of mm"),
    ("more cells", [*LINES[:-1], "100,100,100,0,0,136,7"], "line 28", "more cells than the 6"),
    ("twice", [*LINES, LINES[-1]], "line 29", "stands on line 28 already"),
    ("no z", [line.rpartition(",")[0] for line in LINES], "header", "p1,p2,p3,x,y,z"),
    ("empty", [], "empty", "p1,p2,p3,x,y,z"),
    ("in Pa", [_.replace("50", "50000") for _ in LINES], "8 of 27", "(are they kPa?)"),
]


@pytest.mark.parametrize(
    ("lines", "named", "allowed"), [b[1:] for b in BAD], ids=[b[0] for b in BAD]
)
def test_bad_tables(lines: list[str], named: str, allowed: str, tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        read("\n".join(lines), tmp_path)
    assert named in str(caught.value)
    assert allowed in str(caught.value)


@pytest.mark.parametrize("factor", [1e-3, 1e3])
def test_metres_and_micrometres_are_refused(factor: float, tmp_path: Path) -> None:
    tips = read_target(DRAWN, LEVELS, 100.0).workspace.tips * factor
    with pytest.raises(InputError, match="are they mm"):
        read(tips_csv(pressure_grid(LEVELS), tips), tmp_path)


def test_a_moved_start_and_other_pressures_are_warned_about(tmp_path: Path) -> None:
    path = tmp_path / "target.csv"
    path.write_text("\n".join([LINES[0], "0,0,0,0,0,98", *LINES[2:], "25,0,0,0,0,100"]))
    target = read_target(path, LEVELS, 100.0)
    moved, extra = target.warnings
    assert "(0, 0, 98) mm" in moved
    assert extra.startswith("1 rows at other pressures")
    assert read_target(DRAWN, LEVELS, 100.0).warnings == ()
