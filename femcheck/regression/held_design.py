"""The designs that are held: those that come with the package, and a user's own."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from importlib.resources import files
from pathlib import Path

import numpy as np

from beamopt.base.errors import InputError
from beamopt.scene.bundled import bundled_scenes
from beamopt.scene.design import Design, load_design
from beamopt.scene.named import is_scene, named_design
from beamopt.scene.scene import load_scene
from beamopt.storage.result_folder import design_file
from femcheck.regression.held import LADDER
from femcheck.solved.subject import sealed_copy

__all__ = ["BUNDLED", "HeldDesign", "design_digest", "find_design"]

SKIN = 1.0  # mm, of the sealed copy


@dataclass(frozen=True, eq=False)
class HeldDesign:
    """A design whose rungs are held.

    name : of its baseline. design : as it is held.
    file : where it stands; None for one that comes with the package.
    mesh : file of its kept section mesh; read where it has a solid.
    rungs : those that are held, as far as it has them.
    """

    name: str
    design: Design
    file: Path | None
    mesh: Path
    rungs: frozenset[str] = frozenset(LADDER)

    @property
    def has_solid(self) -> bool:
        """Whether a solid can be made of it: sealed, straight, and under pressure alone."""
        model = self.design.loaded_rod
        plain = model.straight_length is not None
        return plain and self.design.seal.rules.sealed and self.design.outline.buildable


def _of_file(name: str) -> Design:
    return load_design(Path(str(files("beamopt") / "scenes" / f"{name}.json")))


def _sealed(name: str) -> Design:
    return sealed_copy(name, _of_file(name), SKIN).design


def _of_scene(name: str) -> Design:
    """The section of a scene's target, under the scene's loads."""
    scene = load_scene(bundled_scenes()[name])
    design = load_design(str(scene.target.file))
    return design.model_copy(update={"rod": scene.rod, "loads": scene.loads})


def _of_points(name: str, seed: int) -> Design:
    """Random feature points after a scene's rules: cells, walls, seal."""
    scene = load_scene(bundled_scenes()[name])
    return scene.design_of(scene.random_points(np.random.default_rng([seed])))


BUNDLED: dict[str, Callable[[], Design]] = {
    **{
        name: partial(_of_file, name)
        for name in ("hand_drawn_section", "round_chambers", "sealed_section", "stiff_column")
    },
    "round_chambers-sealed": partial(_sealed, "round_chambers"),
    "random-section": partial(_of_points, "random-section", 0),
    "random-section-sealed": partial(_of_points, "sealed-section", 0),
    **{
        name: partial(_of_scene, name)
        for name in ("gravity", "tool-at-the-tip", "two-segments", "pre-curved", "upright-column")
    },
}
"""Sections that come with the package, drawn and of random points; sections under loads."""


_SOLIDS = frozenset(LADDER[LADDER.index("kept mesh") :])
_LEFT_OUT = {
    "sealed_section": frozenset({"solid, incompressible", "solid, wound", "solid, limit"}),
    "random-section-sealed": _SOLIDS,
}
"""Rungs that the smaller mesh of another design holds in a third of the time."""


def find_design(given: str, meshes: Path) -> HeldDesign:
    """A design that comes with the package, by name, or one of a file, a run folder or a scene.

    A name that is one of `BUNDLED` and of a scene, too, is that of `BUNDLED`.

    meshes : folder of the kept section meshes.

    Raises
    ------
    InputError : there is no such design, or its file is wrong.
    """
    if given in BUNDLED:
        mesh = meshes / f"{given}.msh"
        rungs = frozenset(LADDER) - _LEFT_OUT.get(given, frozenset())
        return HeldDesign(given, BUNDLED[given](), None, mesh, rungs)
    path = Path(given)
    if not is_scene(given) and not path.exists():
        names = ", ".join([*BUNDLED, *(name for name in bundled_scenes() if name not in BUNDLED)])
        allowed = f"no such design; a design file, a run folder, a scene, or one of: {names}"
        raise InputError(given, "", None, allowed)
    name, design = named_design(given)
    file = None if given in bundled_scenes() and is_scene(given) else design_file(path)
    return HeldDesign(name, design, file, meshes / f"{name}.msh")


def design_digest(design: Design) -> str:
    """Tells designs apart by all that their tips depend on; notes do not count."""
    content = json.loads(design.json())
    content.pop("notes", None)
    text = json.dumps(content, sort_keys=True, allow_nan=False)
    return hashlib.blake2b(text.encode(), digest_size=12).hexdigest()
