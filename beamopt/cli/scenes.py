"""`beamopt scenes` and `beamopt init`."""

from __future__ import annotations

import tomllib
from pathlib import Path

from beamopt.base.errors import InputError
from beamopt.cli.progress import console
from beamopt.scene.bundled import bundled_scenes
from beamopt.storage.writing import write_atomic

__all__ = ["init_command", "scenes_command"]


def scenes_command() -> None:
    """List names and descriptions of the bundled scenes."""
    for name, path in bundled_scenes().items():
        described = tomllib.loads(path.read_text(encoding="utf-8"))["description"]
        console.print(f"[bold]{name:<22}[/]{described}", soft_wrap=True)


def init_command(file: Path, start: str | None) -> None:
    """Write a scene with every key, its unit and what it may hold."""
    from beamopt.scene.scene import Scene, load_scene
    from beamopt.scene.toml_text import scene_text

    if file.exists():
        raise InputError(file, "", None, "exists already; name a new file")
    if start is not None and start not in bundled_scenes():
        raise InputError("--scene", "", start, f"one of {', '.join(bundled_scenes())}")
    scene = Scene() if start is None else load_scene(start)
    sources = [Path(source) for source in scene.target.files]  # the scene is to stand on its own
    for source in sources:
        beside = file.with_name(source.name)
        if beside.exists():
            raise InputError(beside, "", None, "exists already; name a file in another folder")
    for source in sources:
        write_atomic(file.with_name(source.name), source.read_bytes())
    scene = scene.model_copy(update={"target": scene.target.by_name()})
    write_atomic(file, scene_text(scene))
    console.print(f"{file}: edit it, then: beamopt optimize {file}", soft_wrap=True, markup=False)
