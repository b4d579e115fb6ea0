"""The scenes that come with the package."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

__all__ = ["bundled_scenes"]


def bundled_scenes() -> dict[str, Path]:
    """Names and files of the bundled scenes.

    Examples
    --------
    >>> import beamopt
    >>> "random-section" in beamopt.bundled_scenes()
    True
    """
    folder = Path(str(files("beamopt") / "scenes"))
    return {path.stem: path for path in sorted(folder.glob("*.toml"))}
