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
MATERIAL, BEAM = "#c4c4c4", "#101010"


def draw(folder: Path, checked: Checked) -> bool:
    """Write `picture.png`; False where drawing failed, with what it said in `picture.log`."""
    scene = _scene(checked)
    if scene is None:
        return False
    with tempfile.TemporaryDirectory(prefix="femcheck-") as temporary:
        data, image = Path(temporary) / "scene.npz", Path(temporary) / "picture.png"
        np.savez(data, allow_pickle=False, **scene)
        command = [sys.executable, "-m", "femcheck.picture", str(data), str(image)]
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
        "title": np.array(
            f"{subject.name} at {pressures} kPa: tip {compared.difference[row]:.3f} mm from the "
            f"beam's, of {compared.displacement[row]:.1f} mm"
        ),
    }


def _inside(loop: FloatArray) -> FloatArray:
    """A point in a chamber, for its number."""
    import shapely

    point = shapely.Polygon(loop).representative_point()
    return np.array([point.x, point.y])


def _render(data: Path, image: Path) -> None:
    import pyvista

    with np.load(data, allow_pickle=False) as kept:
        scene = {name: kept[name] for name in kept.files}
    plotter: Any = pyvista.Plotter(
        off_screen=True, shape=(1, 2), window_size=[1800, 1000], border=False
    )
    plotter.set_background("white")
    _draw_section(plotter, scene)
    plotter.subplot(0, 1)
    _draw_body(plotter, scene, scene["rest"], 0.06)
    _draw_body(plotter, scene, scene["now"], 0.14)
    plotter.add_mesh(pyvista.MultipleLines(points=scene["line"]).tube(radius=0.8), color=BEAM)
    plotter.add_text(str(scene["title"]), font_size=11, color="black", position="upper_left")
    plotter.add_text(
        "pale: undeformed    black line: the beam",
        font_size=9,
        color="black",
        position="lower_left",
    )
    bent = scene["line"][-1, :2] - scene["line"][0, :2]
    across = np.array([-bent[1], bent[0]])
    if np.linalg.norm(across) < 1e-6:
        across = np.array([0.0, -1.0])
    across = across / np.linalg.norm(across)
    middle = scene["line"].mean(axis=0)
    eye = middle + np.array([*(300 * across), 90.0])
    plotter.camera_position = [tuple(eye), tuple(middle), (0.0, 0.0, 1.0)]
    plotter.reset_camera()
    plotter.camera.zoom(1.25)
    plotter.screenshot(str(image))


def _draw_section(plotter: Any, scene: dict[str, Any]) -> None:
    import pyvista

    plotter.subplot(0, 0)
    flat = np.column_stack([scene["section"], np.zeros(len(scene["section"]))])
    mesh = pyvista.PolyData(flat, _faces(scene["triangles"]))
    plotter.add_mesh(mesh, color=MATERIAL, show_edges=True, edge_color="#8c8c8c", lighting=False)
    above = np.array([0.0, 0.0, 0.01])
    for supply, colour in enumerate(SUPPLY_COLOURS, 1):
        edges = scene["edges"][scene["edge_supply"] == supply]
        if len(edges):
            lines = pyvista.PolyData(flat + above, lines=_faces(edges))
            plotter.add_mesh(lines, color=colour, line_width=5, lighting=False)
    places, names = scene["chamber_places"], scene["chamber_supply"]
    if len(places):
        plotter.add_point_labels(
            np.column_stack([places, np.full(len(places), 0.02)]),
            [str(name) for name in names],
            font_size=18,
            text_color="black",
            shape=None,
            show_points=False,
            justification_horizontal="center",
            justification_vertical="center",
        )
    plotter.add_text(
        "section: mesh, and walls by supply", font_size=11, color="black", position="upper_left"
    )
    plotter.view_xy()
    plotter.enable_parallel_projection()


def _draw_body(plotter: Any, scene: dict[str, Any], at: FloatArray, opacity: float) -> None:
    """Outer surface grey, chambers' walls in the colours of their supplies."""
    import pyvista

    for supply, colour in enumerate((MATERIAL, *SUPPLY_COLOURS)):
        walls = scene["walls"][scene["supply"] == supply]
        if len(walls):
            mesh = pyvista.PolyData(at, _faces(walls))
            shown = opacity if supply == 0 else 1.7 * opacity
            plotter.add_mesh(mesh, color=colour, opacity=shown, smooth_shading=False)


def _faces(cells: Any) -> Any:
    return np.column_stack([np.full(len(cells), cells.shape[1]), cells]).ravel()


if __name__ == "__main__":
    _render(Path(sys.argv[1]), Path(sys.argv[2]))
