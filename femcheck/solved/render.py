"""The picture of a check, as a program: numbers from a file, an image to a file.

It stands on numpy and pyvista alone, so that nothing in a working directory can come in its way.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np

MATERIAL, BEAM = "#c4c4c4", "#101010"
WIDTH_TO_HEIGHT = 0.9  # of one half of the image
MARGIN = 0.9


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
    plotter.add_text(str(scene["title"]), font_size=13, color="black", position="upper_left")
    plotter.add_text(
        "pale: undeformed    black line: the beam",
        font_size=11,
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
    plotter.camera.zoom(_zoom(plotter.camera, np.vstack([scene["rest"], scene["now"]])))
    plotter.screenshot(str(image))


def _zoom(camera: Any, points: Any) -> float:
    """Factor by which the view may narrow so that all points stay within it, with a margin."""
    ahead = np.subtract(camera.focal_point, camera.position)
    ahead /= np.linalg.norm(ahead)
    right = np.cross(ahead, camera.up)
    right /= np.linalg.norm(right)
    seen = points - np.array(camera.position)
    depth = seen @ ahead
    across = np.abs(seen @ right / depth).max() / WIDTH_TO_HEIGHT
    upright = np.abs(seen @ np.cross(right, ahead) / depth).max()
    return float(MARGIN * np.tan(np.radians(camera.view_angle / 2)) / max(across, upright))


def _draw_section(plotter: Any, scene: dict[str, Any]) -> None:
    import pyvista

    plotter.subplot(0, 0)
    flat = np.column_stack([scene["section"], np.zeros(len(scene["section"]))])
    mesh = pyvista.PolyData(flat, _faces(scene["triangles"]))
    plotter.add_mesh(mesh, color=MATERIAL, show_edges=True, edge_color="#8c8c8c", lighting=False)
    above = np.array([0.0, 0.0, 0.01])
    for supply, colour in enumerate(scene["colours"].tolist(), 1):
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
        "section: mesh, walls in the colours of supplies 1, 2, 3",
        font_size=13,
        color="black",
        position="upper_left",
    )
    plotter.view_xy()
    plotter.enable_parallel_projection()
    plotter.camera.zoom(1.35)


def _draw_body(plotter: Any, scene: dict[str, Any], at: Any, opacity: float) -> None:
    """Outer surface grey, chambers' walls in the colours of their supplies."""
    import pyvista

    for supply, colour in enumerate((MATERIAL, *scene["colours"].tolist())):
        walls = scene["walls"][scene["supply"] == supply]
        if len(walls):
            mesh = pyvista.PolyData(at, _faces(walls))
            shown = opacity if supply == 0 else 1.7 * opacity
            plotter.add_mesh(mesh, color=colour, opacity=shown, smooth_shading=False)


def _faces(cells: Any) -> Any:
    return np.column_stack([np.full(len(cells), cells.shape[1]), cells]).ravel()


if __name__ == "__main__":
    _render(Path(sys.argv[1]), Path(sys.argv[2]))
