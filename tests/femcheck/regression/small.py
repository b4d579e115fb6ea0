"""A design whose rungs take a blink, and things to hold."""

from pathlib import Path
from typing import Any

from beamopt.scene.design import Design
from femcheck.regression.held import Held, Row

GRID = {
    "inner_radius": 0,
    "outer_radius": 15,
    "radial": 32,
    "angular": 120,
    "start": 0,
    "stop": 360,
}
CIRCLES = [
    {"supply": 1, "center": [7, 0], "radius": 3},
    {"supply": 2, "center": [-4, 6], "radius": 3.2},
    {"supply": 3, "center": [-4, -6], "radius": 3.4},
]
SEAL = {"skin": 1.0, "wall": 0.9, "rounding": 0.5, "smallest_chamber": 3.0, "islands": "remove"}
OPEN = {"skin": 0, "wall": 0, "islands": "keep"}


def small_design(sealed: bool = False, **changes: Any) -> Design:
    data: dict[str, Any] = {
        "schema": "beamopt-design/1",
        "grid": GRID | {"start": 0, "stop": 360},
        "drawing": CIRCLES,
        "wall_elements": 0,
        "seal": SEAL if sealed else OPEN,
        "actuator": {"length": 60, "youngs_modulus": 300, "shear_modulus": 100},
        "pressures": [0, 20, 40],
    }
    return Design.model_validate(data | changes)


def saved(folder: Path, name: str = "small", sealed: bool = False, **changes: Any) -> Path:
    return small_design(sealed, **changes).save(folder / f"{name}.json")


def held(rows: dict[str, Row], rung: str = "beam", **changes: Any) -> Held:
    about = {"resolution": "fine", "quantity": "tips", "unit": "mm", "source": "told"}
    values: dict[str, Any] = {"rung": rung, "rows": rows, "tolerance": 0.1} | about | changes
    return Held(**values)
