"""Sections that an export must get right: sealed, an island, a sector, random ones left open."""

from typing import Any

import numpy as np

from beamopt.export.faces import SectionFaces, section_faces
from beamopt.scene.actuator import Actuator
from beamopt.scene.bundled import bundled_scenes
from beamopt.scene.design import Design, Grid, load_design
from beamopt.scene.seal_keys import Seal
from beamopt.section.feature_points import FeaturePoints

__all__ = ["SAGITTA", "SAMPLES", "SEALED", "drawn", "faces_of", "random_section"]

SEALED = bundled_scenes()["sealed-section"].with_name("sealed_section.json")
SAGITTA = 0.04
ACTUATOR = Actuator(length=80.0, youngs_modulus=150.0)


def drawn(drawing: list[dict[str, Any]], seal: Seal | None = None, **grid: float) -> Design:
    """A design of drawn chambers, sealed by 1 mm unless told."""
    rules = seal or Seal(skin=1.0, wall=0.9, rounding=0.5)
    return Design.model_validate(
        {
            "schema": "beamopt-design/1",
            "grid": Grid(**grid).model_dump(),
            "drawing": drawing,
            "wall_elements": 0,
            "seal": rules.model_dump(),
            "actuator": ACTUATOR.model_dump(),
            "pressures": (0.0, 20.0, 40.0),
        }
    )


def random_section(seed: int, count: int = 40, skin: float = 1.0) -> Design:
    """A design of random feature points in the usual ring; a skin of 0 leaves it open."""
    rng = np.random.default_rng(seed)
    radius = np.sqrt(rng.uniform(10.0**2, 25.0**2, count))
    angle = rng.uniform(0.0, 2 * np.pi, count)
    points = FeaturePoints(
        radius * np.cos(angle), radius * np.sin(angle), rng.integers(0, 4, count).astype(np.uint8)
    )
    seal = Seal(skin=skin, wall=0.9, rounding=0.5, smallest_chamber=3.0) if skin else Seal()
    return Design.of_points(
        points,
        grid=Grid(),
        wall_elements=0,
        actuator=ACTUATOR,
        levels=(0.0, 20.0, 40.0),
        seal=seal,
        notes={"scene": "a <scene> & more", "seed": seed, "L": 12.5},
    )


def faces_of(design: Design) -> SectionFaces:
    return section_faces(design.outline, design.grid.build(), SAGITTA)


SAMPLES = {
    "sealed": lambda: load_design(SEALED),
    "random": lambda: random_section(3),
    "island": lambda: drawn(
        [{"supply": 1, "r": [6.0, 14.0], "phi": [0.0, 360.0]}], inner_radius=0.0
    ),
    "sector": lambda: drawn(
        [{"supply": k + 1, "r": [13.0, 22.0], "phi": [30.0 + 50 * k, 65.0 + 50 * k]}
         for k in range(3)],
        start=20.0,
        stop=200.0,
    ),
    "open": lambda: random_section(0, skin=0.0),
}  # fmt: skip
"""Each of them made anew when called."""
