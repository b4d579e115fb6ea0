"""Volume meshes as files that other programs read, with their tags; lengths in mm.

A linear wedge is numbered as gmsh and VTK from version 9.7 on number it: the normal of corners
0, 1, 2 points towards corners 3, 4, 5. Older VTK has it the other way round: it reads the same
shapes, with volumes of the other sign.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.storage.writing import replacing
from femcheck.mesh.extrusion import Extrusion

__all__ = ["DISPLACEMENT", "TAGS", "VTU_WEDGE", "write_deformed", "write_mesh"]

DISPLACEMENT = "displacement_mm"
"""Point data of a deformed mesh: the file's points are undeformed, points plus this deformed."""

VTU_WEDGE = [0, 2, 1, 3, 5, 4]
"""From a wedge's corners to those to give to meshio, which writes the older VTK's order to a .vtu.

It is its own inverse: also what meshio reads from such a file is put in order by it."""

TAGS = {
    "surface": (1, 2),
    "supply-1": (2, 2),
    "supply-2": (3, 2),
    "supply-3": (4, 2),
    "fixed": (5, 2),
    "tip": (6, 2),
    "material": (10, 3),
}
"""Number and dimension of each physical group."""


def write_mesh(folder: Path, body: Extrusion) -> None:
    """Write `mesh.msh` (gmsh 2.2, physical groups) and `mesh.vtu` (cell data "tag").

    Wedges of the material; quadrangles of the walls and free surfaces; triangles of both ends.
    """
    import meshio

    n = len(body.section.points)
    base = body.section.triangles[:, ::-1]
    tip = body.section.triangles + n * (body.heights.size - 1)
    ends = np.repeat([TAGS["fixed"][0], TAGS["tip"][0]], [len(base), len(tip)])
    tags = [np.full(len(body.wedges), TAGS["material"][0]), body.supply + 1, ends]
    cells = [("wedge", body.wedges), ("quad", body.walls), ("triangle", np.vstack([base, tip]))]
    groups = {name: np.array(tag) for name, tag in TAGS.items()}
    marked: Any = {"gmsh:physical": tags, "gmsh:geometrical": tags}
    mesh = meshio.Mesh(body.points, cells, cell_data=marked, field_data=groups)
    _write(folder / "mesh.msh", mesh, "gmsh22")
    cells[0] = ("wedge", body.wedges[:, VTU_WEDGE])
    _write(folder / "mesh.vtu", meshio.Mesh(body.points, cells, cell_data={"tag": tags}), "vtu")


def write_deformed(file: Path, body: Extrusion, at: FloatArray) -> None:
    """Write the undeformed wedges with the displacement of their corners and their axial stretch.

    Point data "displacement_mm", cell data "stretch"; points and displacement add to the shape.

    at : (n, 3) positions of the corners [mm].
    """
    import meshio

    lower, upper = at[body.wedges[:, :3]].mean(axis=1), at[body.wedges[:, 3:]].mean(axis=1)
    low, high = body.points[body.wedges[:, 0], 2], body.points[body.wedges[:, 3], 2]
    stretch = np.linalg.norm(upper - lower, axis=1) / (high - low)
    mesh = meshio.Mesh(
        body.points,
        [("wedge", body.wedges[:, VTU_WEDGE])],
        point_data={DISPLACEMENT: at - body.points},
        cell_data={"stretch": [stretch]},
    )
    _write(file, mesh, "vtu")


def _write(file: Path, mesh: Any, form: str) -> None:
    """A kill never leaves half a file under its name."""
    with replacing(file) as temporary:
        mesh.write(temporary, file_format=form)
