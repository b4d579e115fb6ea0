"""Volume meshes as files that other programs read, with their tags."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np

from beamopt.arrays import FloatArray
from femcheck.mesh.extrusion import Extrusion

__all__ = ["TAGS", "write_deformed", "write_mesh"]

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
    _write(folder / "mesh.vtu", meshio.Mesh(body.points, cells, cell_data={"tag": tags}), "vtu")


def write_deformed(file: Path, body: Extrusion, at: FloatArray) -> None:
    """Write the deformed wedges with their displacement [mm] and axial stretch.

    at : (n, 3) positions of the corners [mm].
    """
    import meshio

    lower, upper = at[body.wedges[:, :3]].mean(axis=1), at[body.wedges[:, 3:]].mean(axis=1)
    low, high = body.points[body.wedges[:, 0], 2], body.points[body.wedges[:, 3], 2]
    stretch = np.linalg.norm(upper - lower, axis=1) / (high - low)
    mesh = meshio.Mesh(
        at,
        [("wedge", body.wedges)],
        point_data={"displacement": at - body.points},
        cell_data={"stretch": [stretch]},
    )
    _write(file, mesh, "vtu")


def _write(file: Path, mesh: Any, form: str) -> None:
    """To a temporary name, then renamed: a kill never leaves half a file under its name."""
    temporary = file.with_name(f".{file.name}.{os.getpid()}.tmp")
    mesh.write(temporary, file_format=form)
    temporary.replace(file)
