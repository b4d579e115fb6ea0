"""A check that takes seconds: a disc with three round chambers, as coarse as its outline allows."""

import json
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from beamopt.base.processes import in_process
from beamopt.outline.build import build_outline
from beamopt.outline.outline import Outline
from beamopt.scene.bundled import bundled_scenes
from beamopt.scene.design import Design
from femcheck.check.options import CheckOptions
from femcheck.mesh.geo import SectionSizes
from femcheck.solved.subject import Subject

here = in_process

SEALED = bundled_scenes()["sealed-section"].with_name("sealed_section.json")
SIZES = SectionSizes(factor=3.0, growth=5.0)
LEVELS = [0, 20, 40]


class Coarse(Subject):
    """The same rules with chords ten times farther from the smooth outline."""

    @cached_property
    def outline(self) -> Outline:  # type: ignore[override]
        design = self.design
        return build_outline(design.grid.build(), design.source, design.seal.rules, 0.4)


def three_circles() -> list[dict[str, Any]]:
    angles = np.radians([0, 120, 240])
    return [
        {"supply": k, "center": [7 * np.cos(a), 7 * np.sin(a)], "radius": 2.8 + 0.2 * k}
        for k, a in enumerate(angles.tolist(), 1)
    ]


def design_of(drawing: list[dict[str, Any]], **changes: Any) -> Design:
    data = json.loads(SEALED.read_text())
    data["grid"] |= {"inner_radius": 0, "outer_radius": 15, "radial": 32, "angular": 120}
    data["pressures"] = LEVELS
    for key, value in changes.items():
        data[key] = data[key] | value if isinstance(value, dict) else value
    return Design.model_validate(data | {"drawing": drawing})


def small_subject(name: str = "small", **changes: Any) -> Subject:
    return Coarse(name, design_of(three_circles(), **changes))


def small_options(**changes: Any) -> CheckOptions:
    return CheckOptions(**({"layers": 2, "sizes": SIZES} | changes))


def quick_options(**changes: Any) -> CheckOptions:
    """Of the linear tetrahedron: wrong and fast, where it is not the answer that is looked at."""
    return small_options(**({"element": "tet4"} | changes))


def kept_files(folder: Path, pictures: bool = False) -> dict[str, bytes]:
    """What a check must reproduce: all but times, versions, pictures and the cases' own times."""
    left_out = {"timing.csv", "provenance.json"} | (set() if pictures else {"picture.png"})
    return {
        str(file.relative_to(folder)): file.read_bytes()
        for file in sorted(folder.rglob("*"))
        if file.is_file() and file.name not in left_out and file.parent.name != "cases"
    }
