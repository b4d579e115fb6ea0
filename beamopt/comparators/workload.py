"""What a chart solves: the rod of a scene at its 27 pressures."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from beamopt.base.arrays import FloatArray
from beamopt.base.errors import InputError
from beamopt.rod.ladder import RodModel, SectionValues
from beamopt.rod.rod import Rod
from beamopt.scene.design import load_design
from beamopt.scene.scene import Scene
from beamopt.section.cross_section import CrossSection
from beamopt.section.saint_venant import section_saint_venant
from beamopt.target.workspace import pressure_grid

__all__ = ["Workload", "random_section", "workload_of"]

MOST_SECTIONS = 100  # that are drawn until one is stiff


@dataclass(frozen=True, eq=False)
class Workload:
    """A rod to solve.

    scene : its name. model, section : of the actuator. pressures : (n, 3) [kPa].
    """

    scene: str
    model: RodModel
    section: SectionValues
    pressures: FloatArray

    @cached_property
    def rod(self) -> Rod:
        """The rod without pressure."""
        return self.model.rod(self.section)

    @cached_property
    def rest(self) -> FloatArray:
        """(n, segments, 6) strains at rest, at the pressures."""
        return self.model.rest(self.section, self.pressures)


def workload_of(scene: Scene, seed: int | None = None) -> Workload:
    """The rod of a scene's target where that is a section's, else of a random section.

    seed : takes a random section in any case; 0 where one is needed.

    Raises
    ------
    InputError : the target's file is missing or wrong; no section of the seed is stiff.
    """
    model = scene.climb.model
    if scene.target.kind == "section" and seed is None:
        design = load_design(str(scene.target.file))
        known = design.saint_venant(model.poissons_ratio) if model.twists else None
        section = SectionValues(design.moments, known)
    else:
        section = random_section(scene, model, (seed or 0,))
    return Workload(scene.name, model, section, pressure_grid(scene.pressures.levels))


def random_section(scene: Scene, model: RodModel, key: tuple[int, ...]) -> SectionValues:
    """The first stiff section of a random stream of its own."""
    grid, rules = scene.grid.build(), scene.seal.rules
    for k in range(MOST_SECTIONS):
        points = scene.random_points(np.random.default_rng([*key, k]))
        section = CrossSection.from_points(grid, points, scene.wall_elements, rules)
        if section.moments.is_stiff:
            return _values(scene, model, section)
    said = f"none of {MOST_SECTIONS} random sections is stiff: more material, or other points"
    raise InputError("", "section.material_probability", None, said)


def _values(scene: Scene, model: RodModel, section: CrossSection) -> SectionValues:
    if not model.twists:
        return SectionValues(section.moments)
    known = section_saint_venant(section.grid, section.labels, model.poissons_ratio)
    return SectionValues(section.moments, known)
