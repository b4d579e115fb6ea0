"""Volume meshes: .vtu as VTK reads it, .msh as gmsh does."""

import json
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tests.readers.quadrature import over_edges, over_triangles

WEDGE, QUAD, TRIANGLE = 13, 9, 5  # as VTK numbers cells
TAGS = {"surface": 1, "supply-1": 2, "supply-2": 3, "supply-3": 4, "fixed": 5, "tip": 6}
MATERIAL = 10

GMSH = """
import json, sys, gmsh
gmsh.initialize([], False, False, False)
gmsh.option.setNumber("General.Terminal", 0)
gmsh.open(sys.argv[1])
mesh, found = gmsh.model.mesh, []
for dimension, tag in gmsh.model.getPhysicalGroups():
    cells = {}
    for entity in gmsh.model.getEntitiesForPhysicalGroup(dimension, tag):
        kinds, numbers, nodes = mesh.getElements(dimension, entity)
        for kind, own, corners in zip(kinds, numbers, nodes):
            name, _, _, count, _, _ = mesh.getElementProperties(kind)
            one = cells.setdefault(name, {"nodes": [], "signs": []})
            one["nodes"] += corners.reshape(-1, count).tolist()
            one["signs"] += mesh.getElementQualities(own.tolist(), "volume").tolist()
    found.append([gmsh.model.getPhysicalName(dimension, tag), dimension, tag, cells])
nodes, points, _ = mesh.getNodes()
json.dump({"groups": found, "nodes": nodes.tolist(), "points": points.tolist()}, sys.stdout)
"""


@dataclass(frozen=True)
class VolumeMesh:
    """What a mesh file says of the solid.

    integrals : (4, 6) from its tip face and its walls. areas : of each tagged surface [mm²].
    volumes : (m,) of the wedges, signed as the reader computes them [mm³].
    """

    integrals: np.ndarray
    areas: dict[str, float]
    volumes: np.ndarray


def read_vtu(file: Path) -> VolumeMesh:
    """As VTK reads `mesh.vtu`."""
    import pyvista

    grid = pyvista.read(file)
    sizes = grid.compute_cell_sizes().cell_data
    kinds, tags = grid.celltypes, np.asarray(grid.cell_data["tag"])
    assert set(tags[kinds == WEDGE]) == {MATERIAL}
    quads, triangles = (grid.cells_dict[kind] for kind in (QUAD, TRIANGLE))
    walls = {
        name: grid.points[quads[tags[kinds == QUAD] == tag]]
        for name, tag in TAGS.items()
        if name not in ("fixed", "tip")
    }
    tip = grid.points[triangles[tags[kinds == TRIANGLE] == TAGS["tip"]]]
    areas = {
        name: float(np.asarray(sizes["Area"])[tags == tag].sum()) for name, tag in TAGS.items()
    }
    return VolumeMesh(_integrals(tip, walls), areas, np.asarray(sizes["Volume"])[kinds == WEDGE])


def read_msh(file: Path) -> VolumeMesh:
    """As gmsh reads `mesh.msh`, by the names of its physical groups."""
    read, points, place = _by_gmsh(file)
    groups = {name: (dimension, tag, cells) for name, dimension, tag, cells in read["groups"]}
    numbers = {name: tag for name, (_, tag, _) in groups.items()}
    assert numbers.items() <= (TAGS | {"material": MATERIAL}).items()
    at = dict.fromkeys(TAGS, np.zeros((0, 4, 3)))
    areas = dict.fromkeys(TAGS, 0.0)
    for name in groups.keys() & TAGS.keys():  # a supply without chambers has no walls
        dimension, _, cells = groups[name]
        assert dimension == 2
        (one,) = cells.values()
        at[name] = points[place[np.array(one["nodes"])]]
        areas[name] = float(np.sum(one["signs"]))
    dimension, _, cells = groups["material"]
    assert (dimension, set(cells)) == (3, {"Prism 6"})
    return VolumeMesh(_integrals(at["tip"], at), areas, np.array(cells["Prism 6"]["signs"]))


def read_section_msh(file: Path) -> np.ndarray:
    """As gmsh reads a plane section mesh, by the numbers of its physical groups: (4, 6)."""
    read, points, place = _by_gmsh(file)
    groups = {tag: cells for _, _, tag, cells in read["groups"]}
    triangles = points[place[np.array(groups[MATERIAL]["Triangle 3"]["nodes"])], :2]
    rows = [over_triangles(triangles)]
    for supply in (1, 2, 3):
        lines = groups.get(supply + 1, {}).get("Line 2", {"nodes": np.zeros((0, 2), dtype=int)})
        a, b = points[place[np.array(lines["nodes"]).T], :2]
        rows.append(-over_edges(a, b))
    return np.stack(rows)


def _by_gmsh(file: Path) -> tuple[dict[str, Any], np.ndarray, np.ndarray]:
    """What gmsh finds; points (n, 3); the place of each node's number among them."""
    done = subprocess.run(
        [sys.executable, "-c", GMSH, str(file)], capture_output=True, text=True, check=True
    )
    read: dict[str, Any] = json.loads(done.stdout)
    place = np.zeros(max(read["nodes"]) + 1, dtype=int)
    place[read["nodes"]] = np.arange(len(read["nodes"]))
    return read, np.array(read["points"]).reshape(-1, 3), place


def _integrals(tip: np.ndarray, walls: dict[str, np.ndarray]) -> np.ndarray:
    """Material from the tip face, chambers from the lower edges of their walls."""
    rows = [over_triangles(tip[..., :2])]
    for supply in (1, 2, 3):
        at = walls[f"supply-{supply}"]
        lower = at[np.isclose(at[..., 2].min(axis=1), 0.0)]
        # a wall's normal (b − a) × e3 points out of the material, into the chamber
        rows.append(-over_edges(lower[:, 0, :2], lower[:, 1, :2]))
    return np.stack(rows)
