import copy
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from beamopt.base.errors import InputError
from beamopt.scene.bundled import bundled_scenes
from beamopt.scene.design import Design, load_design
from beamopt.scene.scene import Scene
from beamopt.scene.seal_keys import Seal
from beamopt.section.cross_section import CrossSection
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.seal import SealRules

DRAWN = bundled_scenes()["hand-drawn-section"].with_name("hand_drawn_section.json")
SEALED = DRAWN.with_name("sealed_section.json")


def test_points_survive_a_file_to_the_last_bit(tmp_path: Path) -> None:
    scene = Scene()
    points = scene.random_points(np.random.default_rng([3]))
    design = scene.design_of(points, {"why": "a test"})
    read = load_design(design.save(tmp_path / "design.json"))
    np.testing.assert_array_equal(read.section.labels, design.section.labels)
    np.testing.assert_array_equal(read.workspace.tips, design.workspace.tips)
    assert read == design
    assert read.json() == design.json()


def test_a_drawing_survives_a_file(tmp_path: Path) -> None:
    design = load_design(DRAWN)
    read = load_design(design.save(tmp_path / "design.json"))
    assert read == design
    kept = json.loads((tmp_path / "design.json").read_text())
    original = json.loads(DRAWN.read_text())
    assert {key: kept[key] for key in original} == original


SEAL = {"skin": 1.0, "wall": 0.9, "rounding": 0.5, "smallest_chamber": 3.0, "islands": "remove"}


def test_a_sealed_design_survives_a_file(tmp_path: Path) -> None:
    scene = Scene.model_validate({"seal": SEAL})
    design = scene.design_of(scene.random_points(np.random.default_rng([3])))
    read = load_design(design.save(tmp_path / "design.json"))
    assert read == design
    assert json.loads(design.json())["seal"] == SEAL
    rules = SealRules(1.0, 0.9, 0.5, 3.0, True)
    points = FeaturePoints(**json.loads(design.json())["feature_points"])
    expected = CrossSection.from_points(PolarGrid(), points, 0, rules).labels
    np.testing.assert_array_equal(read.section.labels, expected)
    unsealed = Scene().design_of(points).section.labels
    assert (unsealed[0] > 0).any()
    assert not read.section.labels[0].any()


def test_a_sealed_drawing_survives_a_file(tmp_path: Path) -> None:
    design = load_design(SEALED)
    assert json.loads(SEALED.read_text())["seal"] == SEAL == design.seal.written()
    read = load_design(design.save(tmp_path / "design.json"))
    assert read == design
    np.testing.assert_array_equal(read.section.labels, design.section.labels)
    assert read.section.pieces.chambers == (1, 1, 1)


def test_islands_are_removed_without_a_skin_too() -> None:
    data = json.loads(DRAWN.read_text())
    data["seal"] = {"islands": "remove"}
    data["drawing"] = [{"supply": 1, "r": [12, 24], "phi": [0, 180]}]
    data["drawing"] += [{"supply": 2, "center": [0, 18], "radius": 2}]
    kept = Design.model_validate(data | {"seal": {}})
    removed = Design.model_validate(data)
    assert kept.section.moments.chamber_areas[1] > 0  # a wall around another supply stays
    np.testing.assert_array_equal(removed.section.labels, kept.section.labels)


def test_an_unsealed_design_names_no_more_keys_than_it_needs() -> None:
    assert Seal().written() == {"skin": 0.0, "wall": 0.0, "islands": "keep"}
    assert Seal(skin=1, rounding=0.5).written().keys() == {"skin", "wall", "rounding", "islands"}


def test_a_skin_may_fill_all_but_a_little() -> None:
    Seal(skin=7.4).check_fits(PolarGrid())
    Seal(skin=24.9).check_fits(PolarGrid(inner_radius=0.0))
    with pytest.raises(ValueError, match=r"seal\.skin = 25: must be below 25 mm"):
        Seal(skin=25).check_fits(PolarGrid(inner_radius=0.0))


def test_the_fixed_keys_are_there() -> None:
    design = Scene().design_of(Scene().random_points(np.random.default_rng([0])))
    data = json.loads(design.json())
    assert data["schema"] == "beamopt-design/1"
    assert set(data["grid"]) == {
        "inner_radius",
        "outer_radius",
        "radial",
        "angular",
        "start",
        "stop",
    }
    assert set(data["feature_points"]) == {"x", "y", "type"}
    assert data["seal"] == {"skin": 0.0, "wall": 0.0, "islands": "keep"}
    assert set(data["actuator"]) == {"length", "youngs_modulus", "shear_modulus"}
    assert data["pressures"] == [0.0, 50.0, 100.0]
    assert data["wall_elements"] == 4


def test_a_section_rebuilt_from_the_rules_alone() -> None:
    """Somebody else's program, from the file format's description: brute force, no kernels."""
    points = Scene().random_points(np.random.default_rng([11]))
    design = Scene().design_of(points)
    data = json.loads(design.json())
    g, f = data["grid"], data["feature_points"]
    edges = np.sqrt(np.linspace(g["inner_radius"] ** 2, g["outer_radius"] ** 2, g["radial"] + 1))
    step = np.radians((g["stop"] - g["start"]) / g["angular"])
    radii = 2 / 3 * np.diff(edges**3) / np.diff(edges**2) * np.sin(step / 2) / (step / 2)
    phi = np.radians(g["start"]) + (np.arange(g["angular"]) + 0.5) * step
    x, y = radii[:, None] * np.cos(phi), radii[:, None] * np.sin(phi)
    squares = [(x - u) ** 2 + (y - v) ** 2 for u, v in zip(f["x"], f["y"], strict=True)]
    nearest = np.argmin(np.round(squares, 9), axis=0)  # rounded: ties to the lowest index
    types = np.array(f["type"])[nearest]
    walled = types.copy()
    near = data["wall_elements"] // 2
    for di in range(-near, near + 1):
        for dj in range(-near + abs(di), near - abs(di) + 1):
            other = np.zeros_like(types)
            a, b = max(di, 0), min(di, 0)
            rows = types.shape[0]
            other[a : rows + b] = np.roll(types, dj, axis=1)[-b or None : rows - a or None]
            walled[(types > 0) & (other > 0) & (other != types)] = 0
    assert (walled != design.section.labels).sum() <= 3  # rounding to 1e-9 is not the same tie rule


def broken(change: Any) -> dict[str, Any]:
    data: dict[str, Any] = copy.deepcopy(json.loads(DRAWN.read_text()))
    change(data)
    return data


BAD: list[tuple[str, Any, str]] = [
    ("schema = 'beamopt-design/2'", lambda d: d.update(schema="beamopt-design/2"), "design/1"),
    ("foo = 3", lambda d: d.update(foo=3), "unknown key; known here: schema, grid"),
    ("grid.raidal = 5", lambda d: d["grid"].update(raidal=5), "inner_radius, outer_radius, radial"),
    ("grid.outer_radius = 0.025", lambda d: d["grid"].update(outer_radius=0.025), "0.5 … 1000 mm"),
    ("grid", lambda d: d["grid"].update(outer_radius=5.0), "below outer_radius"),
    ("grid", lambda d: d["grid"].update(radial=4000, angular=16000), "4,000,000"),
    ("actuator.length = 0.05", lambda d: d["actuator"].update(length=0.05), "0.1 … 100000 mm"),
    (
        "actuator.youngs_modulus = 300000.0",
        lambda d: d["actuator"].update(youngs_modulus=3e5),
        "kPa",
    ),
    ("drawing[2].supply = 4", lambda d: d["drawing"][2].update(supply=4), "1 … 3"),
    ("drawing[2]: corner = 4", lambda d: d["drawing"][2].update(corner=4), "0…3.75 mm"),
    ("drawing[2]", lambda d: d["drawing"][2].update(radius=4.0), "either r and phi"),
    ("drawing[2].r[0] = nan", lambda d: d["drawing"][2].update(r=[float("nan"), 3]), "finite"),
    ("pressures", lambda d: d.update(pressures=[0, 100, 50]), "ascending"),
    ("pressures[2]", lambda d: d.update(pressures=[0, 100]), "three levels"),
    ("pressures[1] = 50000", lambda d: d.update(pressures=[0, 50000, 100000]), "2000"),
    ("wall_elements = 3", lambda d: d.update(wall_elements=3), "even"),
    ("wall_elements = '4'", lambda d: d.update(wall_elements="4"), "0 … 64"),
    ("seal.skin = -1", lambda d: d["seal"].update(skin=-1.0), "0 … 100 mm"),
    ("seal.skin = 'thick'", lambda d: d["seal"].update(skin="thick"), "must be a number"),
    ("seal: wall = 0.9", lambda d: d["seal"].update(wall=0.9), "skin above 0"),
    ("seal: rounding = 0.5", lambda d: d["seal"].update(rounding=0.5), "skin above 0"),
    ("seal: smallest_chamber = 3", lambda d: d["seal"].update(smallest_chamber=3), "skin above 0"),
    ("seal.islands = 'melt'", lambda d: d["seal"].update(islands="melt"), "keep, remove"),
    ("seal.skins = 1", lambda d: d["seal"].update(skins=1), "known here: skin, wall, rounding"),
    ("seal.skin = 7.5", lambda d: d["seal"].update(skin=7.5), "below 7.5 mm"),
    ("grid", lambda d: d.pop("grid"), "must be given"),
    ("exactly one", lambda d: d.pop("drawing"), "feature_points and drawing"),
    (
        "feature_points",
        lambda d: (d.pop("drawing"), d.update(feature_points={"x": [1], "y": [], "type": [0]})),
        "1, 0, 1 entries",
    ),
    ("no material", lambda d: d.update(drawing=_everything()), "too little to bend"),
]


def _everything() -> list[dict[str, Any]]:
    return [{"supply": 1, "r": [0, 30], "phi": [0, 360]}]


@pytest.mark.parametrize(("named", "change", "allowed"), BAD, ids=[name for name, _, _ in BAD])
def test_bad_designs_name_file_key_value_and_what_is_allowed(
    named: str, change: Any, allowed: str, tmp_path: Path
) -> None:
    path = tmp_path / "bad.json"
    path.write_text(json.dumps(broken(change)))
    with pytest.raises(InputError) as caught:
        load_design(path)
    said = str(caught.value)
    assert said.startswith(f"{path}: ")
    assert named in said
    assert allowed in said
    assert "\n" not in said


@pytest.mark.parametrize("cut", [0, 1, 100, 700])
def test_cut_off_files_are_said_to_be(cut: int, tmp_path: Path) -> None:
    path = tmp_path / "cut.json"
    path.write_text(DRAWN.read_text()[:cut])
    with pytest.raises(InputError, match="cut off"):
        load_design(path)


def test_other_files_are_refused_in_one_line(tmp_path: Path) -> None:
    (tmp_path / "list.json").write_text("[1, 2]")
    (tmp_path / "binary.json").write_bytes(b"\xff\xfe\x00")
    for name, said in (
        ("list.json", "JSON object"),
        ("binary.json", "text file"),
        ("absent.json", "no such file"),
    ):
        with pytest.raises(InputError, match=said):
            load_design(tmp_path / name)


def test_a_key_that_stands_twice_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "double.json"
    path.write_text(DRAWN.read_text().replace('"radial"', '"radial": 64, "radial"', 1))
    with pytest.raises(InputError, match="radial: stands there twice"):
        load_design(path)


@pytest.mark.parametrize("pressures", [[1.0, 2.0, 3.0], [[1.0, 2.0]], [[1.0, 2.0, np.nan]]])
def test_pressures_that_are_none(pressures: list) -> None:
    with pytest.raises(ValueError, match="pressures: finite"):
        load_design(DRAWN).tips(pressures)


def test_tips_at_any_pressures() -> None:
    design = load_design(DRAWN)
    space = design.workspace
    np.testing.assert_array_equal(design.tips(space.pressures), space.tips)
    assert isinstance(design, Design)
