"""The actuator in three dimensions, drawn off screen in a process of its own.

Drawing needs a graphics library that may be missing or crash; a check that is done must not die of
its picture.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from beamopt.arrays import FloatArray
from beamopt.files import write_atomic
from beamopt.plot.style import SUPPLY_COLOURS
from beamopt.rod.arc import arc_centreline
from femcheck.check.checked import Checked

__all__ = ["draw"]

SECONDS = 180.0


def draw(folder: Path, checked: Checked) -> bool:
    """Write `picture.png`; False where drawing failed, with what it said in `picture.log`."""
    scene = _scene(checked)
    if scene is None:
        return False
    with tempfile.TemporaryDirectory(prefix="femcheck-") as temporary:
        data, image = Path(temporary) / "scene.npz", Path(temporary) / "picture.png"
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
            (folder / "picture.log").write_text(said, encoding="utf-8")
            return False
        write_atomic(folder / "picture.png", image.read_bytes())
        (folder / "picture.log").unlink(missing_ok=True)
    return True


def _scene(checked: Checked) -> dict[str, Any] | None:
    """What is to be seen: the case with the largest displacement that has an answer."""
    compared = checked.comparison
    assert compared is not None
    stage = [one for one in checked.stages if one.mesh == "standard"][-1]
    solved = ~np.isnan(compared.solid(stage.mesh, stage.penalty).tips[:, 0])
    if not (solved & compared.is_loaded).any():
        return None
    row = int(np.argmax(np.where(solved & compared.is_loaded, compared.displacement, -1.0)))
    node = (row // 9, row // 3 % 3, row % 3)
    state = checked.results[stage.name, node].outcome.state
    assert state is not None
    shown = stage.solid.shown()
    subject = checked.subject
    length = subject.design.actuator.length
    strains = subject.response.strains(subject.pressures[row : row + 1])
    line = arc_centreline(strains, np.linspace(0, length, 60))[0]
    centroid = np.append(stage.solid.section.moments.centroid, 0.0)
    pressures = ", ".join(f"{value:g}" for value in subject.pressures[row])
    section = stage.solid.section
    chambers = subject.outline.chambers
    return {
        "rest": shown.extrusion.points,
        "now": state.x[shown.nodes],
        "walls": shown.extrusion.walls,
        "supply": shown.extrusion.supply,
        "chamber_places": np.array([_inside(one.exterior) for one in chambers]),
        "chamber_supply": np.array([one.supply for one in chambers]),
        "triangles": section.triangles,
        "section": section.points,
        "edges": section.edges,
        "edge_supply": section.supply,
        "line": line + centroid,
        "colours": np.array(SUPPLY_COLOURS),
        "title": np.array(
            f"{subject.name} at {pressures} kPa: tip moves {compared.displacement[row]:.1f} mm, "
            f"beam and solid differ by {compared.difference[row]:.3f} mm"
        ),
    }


def _inside(loop: FloatArray) -> FloatArray:
    """A point in a chamber, for its number."""
    import shapely

    point = shapely.Polygon(loop).representative_point()
    return np.array([point.x, point.y])
