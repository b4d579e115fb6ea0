"""Exported solids and drawings: STEP by gmsh's kernel, STL by VTK, DXF by ezdxf, SVG as XML."""

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np

from tests.readers.quadrature import over_circle, over_loop, over_surface

KERNEL = """
import json, sys, gmsh
gmsh.initialize([], False, False, False)
gmsh.option.setNumber("General.Terminal", 0)
occ, found = gmsh.model.occ, []
for file in sys.argv[1:]:
    parts = occ.importShapes(file)
    occ.synchronize()
    for dimension, tag in parts:
        name = gmsh.model.getEntityName(dimension, tag).rpartition("/")[2]
        box = occ.getBoundingBox(dimension, tag)
        found.append({
            "name": name, "dimension": dimension, "volume": occ.getMass(dimension, tag),
            "centre": occ.getCenterOfMass(dimension, tag), "z": [box[2], box[5]],
            "inertia": list(occ.getMatrixOfInertia(dimension, tag)),
        })
print("\\n" + json.dumps(found))
"""
NUMBER = r"-?[\d.]+"
SVG = "{http://www.w3.org/2000/svg}"


def read_step(folder: Path, length: float) -> np.ndarray:
    """(4, 6) over the body's and the cores' sections, from volumes and inertia of solids."""
    files = [str(folder / name) for name in ("body.step", "mould.step")]
    done = subprocess.run(
        [sys.executable, "-c", KERNEL, *files], capture_output=True, text=True, check=True
    )
    solids: list[dict[str, Any]] = json.loads(done.stdout.strip().splitlines()[-1])
    assert {solid["dimension"] for solid in solids} == {3}
    rows = np.zeros((4, 6))
    for solid in solids:
        core = re.fullmatch(r"core-(\d)-\d+", solid["name"])
        if core or ("core" not in solid["name"] and solid["z"][0] > -1e-3):
            np.testing.assert_allclose(solid["z"], [0.0, length], atol=1e-3)
            rows[int(core[1]) if core else 0] += _section(solid) / length
    return rows


def _section(solid: dict[str, Any]) -> np.ndarray:
    """Integrals over a solid, from its inertia about its own centre."""
    volume, (x, y, _) = solid["volume"], solid["centre"]
    inertia = np.array(solid["inertia"]).reshape(3, 3)
    own = [
        0.0,
        0.0,
        0.0,
        (inertia[1, 1] + inertia[2, 2] - inertia[0, 0]) / 2,
        (inertia[0, 0] + inertia[2, 2] - inertia[1, 1]) / 2,
        -inertia[0, 1],
    ]
    return volume * np.array([1, x, y, x * x, y * y, x * y]) + own


def read_stl(file: Path, length: float) -> np.ndarray:
    """(6,) over all closed surfaces of a file that stand on z = 0."""
    import pyvista

    whole = pyvista.read(file)
    assert whole.n_open_edges == 0
    total = np.zeros(6)
    for part in whole.split_bodies():
        if part.bounds[4] < -1e-3:
            continue  # the plate below the cores
        surface = part.extract_surface(algorithm=None)
        triangles = surface.points[surface.faces.reshape(-1, 4)[:, 1:]].astype(float)
        integrals = over_surface(triangles)
        assert integrals[0] > 0  # normals out of the solid
        total += integrals / length
    return total


def read_dxf(file: Path) -> np.ndarray:
    """(4, 6) from closed polylines and circles of the layers."""
    import ezdxf

    document = ezdxf.readfile(file)
    assert document.header["$INSUNITS"] == 4  # mm
    rows = np.zeros((4, 6))
    layers = ("MATERIAL", "SUPPLY_1", "SUPPLY_2", "SUPPLY_3")
    circles = []
    for entity in document.modelspace():
        if entity.dxf.layer not in layers:
            continue
        if entity.dxftype() == "CIRCLE":
            assert entity.dxf.layer == "MATERIAL"
            circles.append(float(entity.dxf.radius))
        else:
            assert entity.closed
            loop = np.array([vertex[:2] for vertex in entity.get_points()])
            rows[layers.index(entity.dxf.layer)] += over_loop(loop)
    for radius in circles:
        rows[0] += (1 if radius == max(circles) else -1) * over_circle(0, 0, radius)
    return rows


def read_svg(file: Path) -> np.ndarray:
    """(4, 6) from the filled paths, one unit a mm."""
    root = ET.parse(file).getroot()
    assert root.attrib["width"] == root.attrib["viewBox"].split()[2] + "mm"
    rows = np.zeros((4, 6))
    for path in root.iter(f"{SVG}path"):
        kind = re.fullmatch(r"supply-(\d)", path.attrib.get("class", ""))
        if kind:
            for line in path.attrib["d"].split("Z")[:-1]:
                rows[int(kind[1])] += _line(line)
    return rows


def _line(line: str) -> np.ndarray:
    numbers = np.array(re.findall(NUMBER, line), dtype=float)
    if "A" not in line:
        return over_loop(numbers.reshape(-1, 2))
    sweep = 1 if numbers[6] == 1 else -1  # M x y A r r 0 0 sweep x y …
    return sweep * over_circle(0.0, 0.0, numbers[2])
