"""Texts that files of earlier versions held where a status belongs; for reading those files only.

They are fixed: nothing that is written today has them, and rewording a status changes none of them.
"""

from __future__ import annotations

from femcheck.continuation.ended import Ended

__all__ = ["OLD_FAULTS", "ended_of"]

OLD_STATUSES = {
    "converged": "solid.CONVERGED",
    "limit point": "solid.LIMIT_POINT",
    "buckled": "solid.BUCKLED",
    "an element turned inside out": "solid.INVERTED",
    "load steps became too small": "solid.STEP_TOO_SMALL",
    "the linear solver found no solution": "solid.LINEAR_SOLVER",
    "time limit reached": "solid.TIME_OUT",
    "its process ended before it was solved": "solid.STOPPED",
    "limit point: no equilibrium near this one at a higher load": "rod.LIMIT_POINT",
    "buckled: the straight way on is unstable": "rod.BUCKLED",
    "compressed to nothing": "rod.CRUSHED",
    "the finest resolution does not resolve the shape": "rod.UNRESOLVED",
    "the iteration diverged": "rod.DIVERGED",
    "the steps of the load became too small": "rod.STEPS_TOO_SMALL",
    "took too long": "rod.TOO_SLOW",
    "not looked for, because another one failed": "rod.SKIPPED",
    "the method can not represent this rod": "rod.NOT_REPRESENTABLE",
    "gmsh is not installed": "mesh.NO_GMSH",
    "gmsh crashed": "mesh.CRASHED",
    "gmsh did not end within its time limit": "mesh.HUNG",
    "gmsh wrote no mesh that can be read": "mesh.NO_MESH",
    "gmsh's mesh is not that of the outline": "mesh.WRONG",
    "no solid can be made of the outline": "mesh.FATAL",
    "a mesh element is inside out or flat": "mesh.INVERTED",
    "the raster has too little material to bend": "model.NOT_STIFF",
    "not a number": "model.NOT_FINITE",
}

OLD_FAULTS = {
    "skin too thin": "SKIN",
    "wall between two supplies too thin": "WALL",
    "material between two parts of a supply too thin": "NECK",
    "material that hangs on to nothing": "ISLAND",
    "a supply has no chamber": "NO_CHAMBER",
    "material in several pieces": "PIECES",
    "no material": "NO_MATERIAL",
    "a chamber is open": "UNSEALED",
    "a polygon touches itself or another one": "INVALID",
}
"""Names of an outline's faults by their texts."""

LOAD = " at P = "


def ended_of(text: str) -> Ended:
    """The ending that an old text, "limit point at P = 22.6 kPa", or a key of today stands for.

    Raises
    ------
    ValueError : it is neither.
    """
    words, mark, load = text.partition(LOAD)
    problem, _, detail = words.partition(": ")
    if words in OLD_STATUSES:
        problem, detail = words, ""
    pressure = float(load.removesuffix(" kPa")) if mark else None
    return Ended.of_key(OLD_STATUSES.get(problem, problem), pressure, detail)
