import tomllib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from beamopt.base.errors import InputError
from beamopt.scene.bundled import bundled_scenes
from beamopt.scene.design import load_design
from beamopt.scene.scene import Scene, load_scene
from beamopt.scene.toml_text import scene_text
from beamopt.storage.checked_keys import parse


def test_defaults_are_the_papers_values() -> None:
    scene = Scene()
    grid, search = scene.grid, scene.search
    assert (grid.inner_radius, grid.outer_radius, grid.radial, grid.angular) == (10, 25, 128, 360)
    assert (scene.actuator.length, scene.actuator.youngs_modulus) == (100, 300)
    assert scene.actuator.shear_modulus == 100
    assert scene.pressures.levels == (0, 50, 100)
    assert (scene.section.feature_points, scene.section.wall_elements) == (100, 4)
    assert scene.section.material_probability == 0.5
    assert (search.population, search.generations) == (20, 100)
    assert (search.crossover_probability, search.mutation_probability) == (0.8, 0.1)
    assert (search.mutated_share, search.swapped_share, search.neighbour_weight) == (0.1, 0.5, 1000)


@pytest.mark.parametrize("name", list(bundled_scenes()))
def test_bundled_scenes_have_their_target(name: str) -> None:
    scene = load_scene(name)
    target = scene.load_target()
    assert scene.name == name
    assert target.warnings == ()
    if scene.climb.model.straight_length is not None and target.workspace is not None:
        np.testing.assert_allclose(target.workspace.tips[0], (0, 0, 100), atol=1e-12)
    assert (target.workspace is None) == (name in ("pairs", "spiral"))
    assert (target.section is None) == (name in ("hand-drawn-workspace", "pairs", "spiral"))


def test_a_written_scene_is_read_as_the_same(tmp_path: Path) -> None:
    for name in bundled_scenes():
        scene = load_scene(name, ["stop.stall=7", "search.seed=12"])
        path = tmp_path / f"{name}.toml"
        path.write_text(scene_text(scene))
        assert load_scene(path) == scene


ANY_TEXT = st.text(st.characters(exclude_categories=()))  # also halves of surrogate pairs


@given(ANY_TEXT, st.dictionaries(ANY_TEXT, ANY_TEXT, max_size=2))
@example("\x7f", {"\x7f": "\x7f"})
@example("\ud800", {})
@example("", {"a": "\ud800"})
def test_any_text_is_read_as_it_was_written(described: str, notes: dict[str, str]) -> None:
    """Or refused by its key: halves of surrogate pairs, which no file can hold."""
    pieces = [{"share": 0.5}, {"share": 0.5, "section": {"notes": notes}}]
    data = {"description": described, "rod": {"segments": pieces}}
    whole = all(
        one < "\ud800" or one > "\udfff" for one in "".join([described, *notes, *notes.values()])
    )
    if not whole:
        with pytest.raises(InputError) as caught:
            parse(Scene, data, "here")
        assert caught.value.key in ("description", "rod.segments[1]")
        return
    scene = parse(Scene, data, "here")
    assert parse(Scene, tomllib.loads(scene_text(scene)), "there") == scene


def test_every_character_is_read_as_it_was_written() -> None:
    every = "".join(chr(one) for one in range(0x3000) if not 0xD800 <= one < 0xE000)
    scene = Scene(description=every)
    assert tomllib.loads(scene_text(scene))["description"] == every


def test_a_written_scene_names_every_key() -> None:
    text = scene_text(Scene())
    for table in ("actuator", "grid", "section", "seal", "pressures", "target", "search", "stop"):
        assert f"[{table}]" in text
        for key in type(getattr(Scene(), table)).model_fields:
            assert f"\n{key} =" in text or f"\n# {key} =" in text


def test_overrides_replace_single_keys() -> None:
    scene = load_scene("random-section", ["search.mutation=weighted", "pressures.levels=[0,10,20]"])
    assert scene.search.mutation == "weighted"
    assert scene.pressures.levels == (0, 10, 20)


def test_target_files_are_found_beside_the_scene(tmp_path: Path) -> None:
    source = bundled_scenes()["hand-drawn-workspace"]
    for path in (source, source.with_name("hand_drawn_workspace.csv")):
        (tmp_path / path.name).write_bytes(path.read_bytes())
    scene = load_scene(tmp_path / source.name)
    assert Path(str(scene.target.file)).parent == tmp_path


BAD = [
    ("[actuator]\nlenght = 3", "actuator.lenght = 3", "known here: length"),
    ("[actuator]\nlength = 0.05", "actuator.length = 0.05", "0.1 … 100000 mm"),
    ("[actuator]\nlength = nan", "actuator.length = nan", "finite"),
    ("[actuator]\nlength = '100'", "actuator.length = '100'", "must be a number; 0.1 … 100000 mm"),
    ("[actuator]\nyoungs_modulus = 3e5", "300000.0", "5 … 50000 kPa"),
    ("[pressures]\nlevels = [0, 50000, 100000]", "pressures.levels[1] = 50000", "2000"),
    ("[pressures]\nlevels = [0, 50]", "pressures.levels[2]", "three ascending levels"),
    ("[search]\npopulation = 1", "search.population = 1", "2 … 10000"),
    ("[search]\npopulation = 2.5", "search.population = 2.5", "2 … 10000"),
    ("[search]\nmutation = 'wild'", "search.mutation = 'wild'", "direct, weighted"),
    ("[section]\nwall_elements = 5", "section.wall_elements = 5", "even"),
    ("[seal]\nskin = 101", "seal.skin = 101", "0 … 100 mm"),
    ("[seal]\nwall = 0.9", "seal", "wall = 0.9: goes with a skin above 0"),
    ("[seal]\nislands = 'burn'", "seal.islands = 'burn'", "keep, remove"),
    ("[seal]\nskin = 8", "seal.skin = 8", "must be below 7.5 mm"),
    ("[target]\nkind = 'workspace'", "target", "file must be given"),
    ("[target]\nfile = 'a.csv'", "target", 'goes with kind "section"'),
    ("[target]\nkind='workspace'\nfile='a'\nbase_z=[1,0,0]", "target", "perpendicular"),
    ("[target]\nkind = 'points'", "target", "file must be given"),
    ("[target]\nkind = 'paths'", "target", "paths and path_weight must be given"),
    ("[target]\nkind='paths'\npaths=['a']\npath_weight=0", "target", "must be given"),
    ("[target]\npaths = 'a.csv'", "target.paths = 'a.csv'", "must be a list"),
    ("[target]\npaths = ['a']\npath_step = 0", "target.path_step = 0", "0.01 … 1000 mm"),
    ("[target]\ndirection_weight = 1", "target", 'goes with kind "points"'),
    ("[target]\nbase_x = [0, 1, 0]", "target", 'kind "workspace" or "points", or with paths'),
    ("name = 'a/b'", "name = 'a/b'", "letters, digits"),
    ("surprise = 1", "surprise = 1", "known here: schema, name"),
    ("schema = 'beamopt-scene/9'", "schema = 'beamopt-scene/9'", "reads beamopt-scene/1"),
    ("[actuator", "no TOML file", "']'"),
]


@pytest.mark.parametrize(("text", "named", "allowed"), BAD, ids=[b[1] for b in BAD])
def test_bad_scenes(text: str, named: str, allowed: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.toml"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        load_scene(path)
    said = str(caught.value)
    assert said.startswith(f"{path}: ")
    assert named in said
    assert allowed in said
    assert "\n" not in said


def test_unknown_scenes_and_overrides() -> None:
    with pytest.raises(InputError, match="hand-drawn-section, hand-drawn-workspace"):
        load_scene("no-such-scene")
    with pytest.raises(InputError, match=r"section\.key=value"):
        load_scene("random-section", ["generations"])
    with pytest.raises(InputError, match=r"search\.generatoins"):
        load_scene("random-section", ["search.generatoins=3"])


def test_another_length_than_the_targets_is_warned_about() -> None:
    target = load_scene("hand-drawn-section", ["actuator.length=90"]).load_target()
    assert "(0, 0, 100) mm" in target.warnings[0]


def test_the_random_target_of_a_sealed_scene_is_sealed() -> None:
    plain = load_scene("random-section", ["section.wall_elements=0"]).load_target().section
    sealed = load_scene("random-section", ["seal.skin=1.0", "seal.wall=0.9"]).load_target().section
    assert plain is not None
    assert sealed is not None
    assert plain.labels[[0, -1]].any()
    assert not sealed.labels[[0, -1]].any()
    assert (sealed.labels[sealed.labels > 0] == plain.labels[sealed.labels > 0]).mean() > 0.99


def test_the_sealed_scene_asks_for_what_moves() -> None:
    """Its target is a drawing sealed by the scene's own rules, whose tips go a good way."""
    scene = load_scene("sealed-section")
    design = load_design(Path(str(scene.target.file)))
    assert design.seal == scene.seal
    assert design.section.pieces.islands == 0
    away = np.linalg.norm(scene.load_target().workspace.tips - (0, 0, 100), axis=1)
    assert away.max() > 40
