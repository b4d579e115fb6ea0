"""Designs by file, run folder and scene."""

from pathlib import Path

import pytest

from beamopt.base.errors import InputError
from beamopt.scene import named
from beamopt.scene.bundled import bundled_scenes
from beamopt.scene.named import design_of_scene, named_design
from beamopt.scene.scene import load_scene
from tests.femcheck.check.small import design_of, three_circles


@pytest.mark.parametrize("scene", bundled_scenes())
def test_every_scene_is_a_design(scene: str) -> None:
    """Under the scene's loads and at its pressures."""
    name, design = named_design(scene)
    known = load_scene(scene)
    assert name == scene
    assert design.moments.is_stiff
    assert design.pressures == known.pressures.levels
    assert design.loads.loads.any == known.loads.loads.any


def test_files_and_run_folders(tmp_path: Path) -> None:
    design = design_of(three_circles())
    design.save(tmp_path / "disc.json")
    run = tmp_path / "run"
    run.mkdir()
    made = design.model_copy(update={"notes": {"scene": "random-section", "seed": 7}})
    made.save(run / "best.json")
    made.save(run / "final.json")
    assert named_design(str(tmp_path / "disc.json"))[0] == "disc"
    assert named_design(str(run))[0] == "random-section-7"
    assert named_design(str(run / "final.json"))[0] == "random-section-7-final"
    assert named_design(str(tmp_path / "disc.json"))[1].json() == design.json()


def test_notes_that_are_no_names(tmp_path: Path) -> None:
    """A path among the notes names no folder."""
    for scene, seed in (("../away", 1), ("fine", "1"), (3, 1)):
        design = design_of(three_circles()).model_copy(
            update={"notes": {"scene": scene, "seed": seed}}
        )
        design.save(tmp_path / "best.json")
        assert named_design(str(tmp_path))[0] == tmp_path.name


def test_what_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such design; a design file, a run folder, a scene"):
        named_design("no-such-thing")
    with pytest.raises(InputError, match=r"it has no best\.json"):
        named_design(str(tmp_path))


def test_a_run_folder_comes_before_a_bundled_scene(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As after `beamopt optimize spiral --out spiral`; another folder of that name is none."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "spiral").mkdir()
    assert named_design("spiral")[1].pressures == load_scene("spiral").pressures.levels
    design = design_of(three_circles())
    design.save(tmp_path / "spiral" / "best.json")
    assert named_design("spiral")[1].json() == design.json()


def test_a_scene_whose_sections_are_all_soft(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(named, "MOST_SECTIONS", 0)
    with pytest.raises(InputError, match="none of 0 random sections is stiff"):
        design_of_scene(load_scene("random-section"))
