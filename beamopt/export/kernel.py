"""Run as a program of its own: solids as JSON on standard input, to a STEP file through gmsh.

It stands alone, so that nothing but gmsh is loaded beside it. The file's name is its argument; the
volumes of the solids [mm³], as the kernel measures them, are the last line that it prints.
"""

from __future__ import annotations

import json
import sys
from typing import Any

__all__ = ["main", "write_step"]


def write_step(solids: list[dict[str, Any]], file: str) -> list[float]:
    """Write solids to a STEP file in mm, in their order; returns their volumes [mm³].

    solids : "low" and "high" [mm], "contours" (each with "points" and "radius", None where it is no
        circle) and "cavities", which are solids.
    """
    import gmsh

    gmsh.initialize([], False, False, False)  # no settings of the person's own, no signal handler
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        occ = gmsh.model.occ
        made = [_solid(occ, solid) for solid in solids]
        volumes = [float(occ.getMass(3, tag)) for tag in made]
        _remove_leftovers(gmsh.model)
        gmsh.write(file)
        return volumes
    finally:
        gmsh.finalize()


def _remove_leftovers(model: Any) -> None:
    """Surfaces, lines and points that belong to no solid: the file would list them as parts."""
    for dimension in (2, 1, 0):
        model.occ.synchronize()
        parts = model.getEntities(dimension)
        free = [part for part in parts if not len(model.getAdjacencies(*part)[0])]
        model.occ.remove(free)
    model.occ.synchronize()


def _solid(occ: Any, solid: dict[str, Any]) -> int:
    body = _extruded(occ, solid)
    cavities = [(3, _extruded(occ, cavity)) for cavity in solid["cavities"]]
    if cavities:
        ((_, body),), _ = occ.cut([(3, body)], cavities)
    return body


def _extruded(occ: Any, solid: dict[str, Any]) -> int:
    low, high = solid["low"], solid["high"]
    face = occ.addPlaneSurface([_wire(occ, contour, low) for contour in solid["contours"]])
    parts = occ.extrude([(2, face)], 0.0, 0.0, high - low)
    return int(next(tag for dimension, tag in parts if dimension == 3))


def _wire(occ: Any, contour: dict[str, Any], z: float) -> int:
    if contour["radius"] is not None:
        return int(occ.addCurveLoop([occ.addCircle(0.0, 0.0, z, contour["radius"])]))
    points = [occ.addPoint(x, y, z) for x, y in contour["points"]]
    following = points[1:] + points[:1]
    lines = [occ.addLine(a, b) for a, b in zip(points, following, strict=True)]
    return int(occ.addCurveLoop(lines))


def main() -> None:
    """Read the solids, write the file, print the volumes."""
    print("\n" + json.dumps(write_step(json.load(sys.stdin), sys.argv[1]), allow_nan=False))


if __name__ == "__main__":
    main()
