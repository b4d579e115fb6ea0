"""A scene beside copies of its target's files: what a result's folder keeps of the question."""

from __future__ import annotations

from pathlib import Path

from beamopt.scene.scene import Scene
from beamopt.scene.target_keys import MOST_PATHS
from beamopt.storage.input_file import read_bytes

__all__ = ["PATHS", "SOURCES", "scene_to_keep"]

SOURCES = {
    "section": "target-source.json",
    "workspace": "target-source.csv",
    "points": "target-source.csv",
}
"""What the target's file is called there, by the target's kind."""

PATHS = tuple(f"target-path-{k}.csv" for k in range(1, MOST_PATHS + 1))
"""What its trajectories are called there."""


def scene_to_keep(scene: Scene) -> tuple[Scene, dict[str, bytes]]:
    """The scene with its target's files named as they are kept beside it, and their contents."""
    chosen = scene.target
    names = () if chosen.file is None else (SOURCES[chosen.kind],)
    paths = PATHS[: len(chosen.paths)]
    files = zip((*names, *paths), chosen.files, strict=True)
    sources = {name: read_bytes(Path(file)) for name, file in files}
    kept = chosen.model_copy(update={"file": names[0] if names else None, "paths": paths})
    return scene.model_copy(update={"target": kept}), sources
