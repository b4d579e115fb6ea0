"""A design by a file, a run folder or a scene."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from beamopt.base.errors import InputError
from beamopt.scene.bundled import bundled_scenes
from beamopt.scene.design import Design, load_design
from beamopt.scene.scene import Scene, load_scene
from beamopt.storage.result_folder import design_file

__all__ = ["design_of_scene", "is_scene", "name_of", "named_design"]

SCENE_NAME = re.compile(r"[\w-]+")
MOST_SECTIONS = 100  # that are drawn until one is stiff


def is_scene(source: str) -> bool:
    """True for a scene file, and for a bundled scene's name.

    A design file or a run folder of that name in the current folder comes before the scene.
    """
    if Path(source).suffix == ".toml":
        return True
    return source in bundled_scenes() and not design_file(Path(source)).exists()


def named_design(source: str | Path) -> tuple[str, Design]:
    """Name and design of a design file, a run folder, or a scene; see `is_scene`.

    Raises
    ------
    InputError : there is none, or it can not be read.
    """
    path = Path(source)
    if is_scene(str(source)):
        scene = load_scene(source)
        return scene.name, design_of_scene(scene)
    file = design_file(path)
    if path.is_dir() and not file.exists():
        raise InputError(source, "", None, f"no run folder: it has no {file.name}")
    if not file.exists():
        scenes = ", ".join(bundled_scenes())
        said = f"no such design; a design file, a run folder, a scene, or one of: {scenes}"
        raise InputError(source, "", None, said)
    design = load_design(file)
    return name_of(path, design), design


def name_of(path: Path, design: Design) -> str:
    """A run's scene and seed; another design's file name."""
    scene, seed = design.notes.get("scene"), design.notes.get("seed")
    of_run = path.is_dir() or path.stem in ("best", "final")
    named = isinstance(scene, str) and SCENE_NAME.fullmatch(scene) and isinstance(seed, int)
    if of_run and named:
        return f"{scene}-{seed}-final" if path.stem == "final" else f"{scene}-{seed}"
    return path.resolve().name if path.is_dir() else path.stem


def design_of_scene(scene: Scene) -> Design:
    """The section of the scene's target where it is one, else a random one, under its loads.

    Raises
    ------
    InputError : the target's file is missing or wrong; no random section is stiff.
    """
    if scene.target.kind == "section":
        design = load_design(str(scene.target.file))
        if not design.loads.loads.any:
            design = design.model_copy(update={"rod": scene.climbed_rules, "loads": scene.loads})
        return design.model_copy(update={"pressures": scene.pressures.levels})
    for k in range(MOST_SECTIONS):
        design = scene.design_of(scene.random_points(np.random.default_rng([0, k])))
        if design.moments.is_stiff:
            return design
    said = f"none of {MOST_SECTIONS} random sections is stiff: more material, or other points"
    raise InputError("", "section.material_probability", None, said)
