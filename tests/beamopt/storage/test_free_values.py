"""Values that a design keeps without reading them: what no file can hold is refused by its key."""

import json
import math
from pathlib import Path
from typing import Any

import pytest

from beamopt.base.errors import InputError
from beamopt.scene.bundled import bundled_scenes
from beamopt.scene.design import Design, load_design
from beamopt.scene.scene import load_scene

DRAWN = bundled_scenes()["hand-drawn-section"].with_name("hand_drawn_section.json")


def nested(depth: int) -> Any:
    inner: Any = []
    for _ in range(depth - 1):
        inner = [inner]
    return inner


IMPOSSIBLE = {
    "notes.k": ("NaN", math.nan),
    "notes.k[1]": ("[0, -1e999]", -math.inf),
    "notes.k.a[0].b": ('{"a": [{"b": Infinity}]}', math.inf),
    "notes.k[0]": ("[" + "9" * 400 + "]", int("9" * 400)),
}


@pytest.mark.parametrize("key", IMPOSSIBLE)
def test_a_number_that_json_can_not_hold(key: str, tmp_path: Path) -> None:
    text, value = IMPOSSIBLE[key]
    data = json.loads(DRAWN.read_text()) | {"notes": {"k": "@"}}
    file = tmp_path / "design.json"
    file.write_text(json.dumps(data).replace('"@"', text))
    with pytest.raises(InputError) as raised:
        load_design(file)
    assert (raised.value.where, raised.value.key) == (str(file), key)
    assert raised.value.value == value or math.isnan(value)


def test_notes_of_a_program(tmp_path: Path) -> None:
    design = load_design(DRAWN)
    for notes in ({"k": {1, 2}}, {"k": {1: 2}}, {"k": tmp_path}, {"k": b"bytes"}):
        with pytest.raises(InputError):
            design.model_copy(update={"notes": notes})
    kept = {"k": [None, True, 1, 2.5, "\ud800", {"a": (1, 2)}]}
    text = design.model_copy(update={"notes": kept}).json()
    assert json.loads(text)["notes"]["k"][:5] == kept["k"][:5]


def test_notes_nested_too_deep() -> None:
    design = load_design(DRAWN)
    with pytest.raises(InputError):
        design.model_copy(update={"notes": {"k": nested(100)}})
    at_most = design.model_copy(update={"notes": {"k": nested(99)}})
    assert Design.model_validate(json.loads(at_most.json())) == at_most


@pytest.mark.parametrize("value", ["nan", "-inf", "2026-11-30", "09:30:00", "1e999"])
def test_the_notes_of_a_segment_of_a_scene(value: str, tmp_path: Path) -> None:
    """TOML has dates and infinities, which a segment's design can not be written with."""
    section = json.loads(DRAWN.read_text())
    grid = ", ".join(f"{key} = {value}" for key, value in section["grid"].items())
    file = tmp_path / "scene.toml"
    file.write_text(
        "[rod]\nsegments = [{share = 0.5}, {share = 0.5, section = "
        f'{{schema = "{section["schema"]}", grid = {{{grid}}}, notes = {{at = [1, {value}]}}}}}}]\n'
    )
    with pytest.raises(InputError) as raised:
        load_scene(file)
    assert (raised.value.where, raised.value.key) == (
        str(file),
        "rod.segments[1].section.notes.at[1]",
    )


def test_the_notes_of_a_segments_file(tmp_path: Path) -> None:
    data = json.loads(DRAWN.read_text()) | {"notes": {"k": math.nan}}
    (tmp_path / "upper.json").write_text(json.dumps(data))
    file = tmp_path / "scene.toml"
    file.write_text('[rod]\nsegments = [{share = 0.5}, {share = 0.5, file = "upper.json"}]\n')
    with pytest.raises(InputError) as raised:
        load_scene(file)
    assert (raised.value.where, raised.value.key) == (str(tmp_path / "upper.json"), "notes.k")
