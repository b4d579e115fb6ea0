"""The actuator in three dimensions, drawn off screen in a process of its own.

Drawing needs a graphics library that may be missing or crash; a check that is done must not die of
its picture.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.plot.style import SUPPLY_COLOURS
from beamopt.rod.arc import arc_centreline
from beamopt.storage.scratch import scratch_folder
from beamopt.storage.writing import write_atomic
from femcheck.solved.case import Solid
from femcheck.solved.subject import Subject

__all__ = ["draw"]

SECONDS = 600.0  # of a clock, after which drawing is taken to hang; it takes five


def draw(
    folder: Path, subject: Subject, solid: Solid, x: FloatArray, pressures: FloatArray, said: str
) -> bool:
    """Write `picture.png`; False where drawing failed, with what it said in `picture.log`.

    x : (n, 3) deformed nodes [mm] at pressures (3,) [kPa]. said : what the title adds.
    """
    scene = _scene(subject, solid, x, pressures, said)
    with scratch_folder() as temporary:
        data, image = temporary / "scene.npz", temporary / "picture.png"
        np.savez(data, allow_pickle=False, **scene)
        # by its path and without the working directory's modules: it needs nothing of ours
        program = Path(__file__).with_name("render.py")
        command = [sys.executable, "-P", str(program), str(data), str(image)]
        try:
            done = subprocess.run(
                command, capture_output=True, text=True, errors="replace", timeout=SECONDS
            )
            said = done.stdout + done.stderr
        except subprocess.TimeoutExpired:
            said = f"drawing took more than {SECONDS:g} s"
        if not image.exists():
            write_atomic(folder / "picture.log", said)
            return False
        write_atomic(folder / "picture.png", image.read_bytes())
        (folder / "picture.log").unlink(missing_ok=True)
    return True


def _scene(
    subject: Subject, solid: Solid, x: FloatArray, pressures: FloatArray, said: str
) -> dict[str, Any]:
    """The body at rest and deformed, the beam's line, and the section."""
    shown, section = solid.shown(), solid.section
    strains = subject.response.strains(pressures[None])
    line = arc_centreline(strains, np.linspace(0, subject.design.actuator.length, 60))[0]
    chambers = subject.outline.chambers
    title = f"{subject.name} at {', '.join(f'{value:.4g}' for value in pressures)} kPa"
    return {
        "rest": shown.extrusion.points,
        "now": x[shown.nodes],
        "walls": shown.extrusion.walls,
        "supply": shown.extrusion.supply,
        "chamber_places": np.array([_inside(one.exterior) for one in chambers]),
        "chamber_supply": np.array([one.supply for one in chambers]),
        "triangles": section.triangles,
        "section": section.points,
        "edges": section.edges,
        "edge_supply": section.supply,
        "line": line + np.append(section.moments.centroid, 0.0),
        "colours": np.array(SUPPLY_COLOURS),
        "title": np.array(f"{title}: {said}"),
    }


def _inside(loop: FloatArray) -> FloatArray:
    """A point in a chamber, for its number."""
    import shapely

    point = shapely.Polygon(loop).representative_point()
    return np.array([point.x, point.y])
