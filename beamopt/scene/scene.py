"""A scene file: actuator, section, pressures, target, search; defaults are the paper's values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property, partial
from pathlib import Path
from typing import Any, Literal

import numpy as np
from pydantic import Field, field_validator, model_validator

from beamopt.base.brief import Brief
from beamopt.base.errors import InputError, NoEquilibriumError
from beamopt.rod.ladder import RodModel, SectionValues
from beamopt.scene.actuator import Actuator, Loading, RodRules, rod_model
from beamopt.scene.bundled import bundled_scenes
from beamopt.scene.design import (
    Design,
    Grid,
    Levels,
    WallElements,
    load_design,
    section_values,
    with_sections,
)
from beamopt.scene.manufacturing_keys import Making
from beamopt.scene.overrides import overridden
from beamopt.scene.rod_choice import Climb, climb
from beamopt.scene.seal_keys import Seal
from beamopt.scene.search_keys import Refining, Search, Stop
from beamopt.scene.target_keys import TargetChoice
from beamopt.section.cross_section import CrossSection
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.saint_venant import section_saint_venant
from beamopt.storage.checked_keys import CheckedKeys, Count, Number, parse, quantity
from beamopt.storage.input_file import parse_toml, read_text
from beamopt.target.target import Target, oddities, read_target
from beamopt.target.workspace import Workspace

__all__ = ["Pressures", "Scene", "SectionRules", "load_scene"]

SCHEMA = "beamopt-scene/1"

SAMPLES, MOST_SAMPLES, SAMPLE = 4, 12, 0x5EC710  # to try the rungs on, of how many; their stream


class SectionRules(CheckedKeys):
    """How a section is made from feature points.

    Examples
    --------
    >>> import beamopt
    >>> beamopt.SectionRules(feature_points=40).material_probability
    0.5
    """

    feature_points: Count = quantity(
        100, "feature points of a new section, N_f", low=1, high=10_000
    )
    material_probability: Number = quantity(
        0.5, "probability that one is material; the supplies share the rest", low=0, high=1
    )
    wall_elements: WallElements = quantity(
        4, "elements of a wall between supplies, even; none if sealed", low=0, high=64
    )


class Pressures(CheckedKeys):
    """What the supplies can give.

    Examples
    --------
    >>> import beamopt
    >>> beamopt.Pressures(levels=(0.0, 10.0, 20.0)).levels[-1]
    20.0
    """

    levels: Levels = quantity(
        (0.0, 50.0, 100.0), "three ascending levels, each 0 … 2000", unit="kPa"
    )


class Scene(CheckedKeys):
    """Everything that a search needs, as one checked and frozen object.

    Examples
    --------
    >>> import beamopt
    >>> beamopt.Scene(name="short", actuator=beamopt.Actuator(length=80.0))
    <Scene 'short': target random, r 10…25 mm, 20 individuals, 100 generations, seed 0>
    """

    schema_: Literal["beamopt-scene/1"] = Field(
        default="beamopt-scene/1", alias="schema", description="version of this file's format"
    )
    name: str = quantity("scene", "a short name, for titles and folders")
    description: str = quantity("", "one sentence on what it shows")
    actuator: Actuator = Actuator()
    grid: Grid = Grid()
    section: SectionRules = SectionRules()
    seal: Seal = Seal()
    making: Making = Making()
    pressures: Pressures = Pressures()
    rod: RodRules = RodRules()
    loads: Loading = Loading()
    target: TargetChoice = TargetChoice()
    search: Search = Search()
    refine: Refining = Refining()
    stop: Stop = Stop()

    @field_validator("name")
    @classmethod
    def _names_a_folder(cls, name: str) -> str:
        if not name or any(not (c.isalnum() or c in "-_") for c in name):
            raise ValueError("letters, digits, - and _")
        return name

    @field_validator("description")
    @classmethod
    def _can_be_written(cls, described: str) -> str:
        if any("\ud800" <= c <= "\udfff" for c in described):
            raise ValueError("text without halves of surrogate pairs")
        return described

    @model_validator(mode="after")
    def _leaves_room(self) -> Scene:
        self.seal.check_fits(self.grid.build())
        self.making.check_fits(self.grid.build())
        self.search.check_memory(self.section.feature_points, self.grid.radial * self.grid.angular)
        return self

    def __repr__(self) -> str:
        search, ring = self.search, self.grid
        return (
            f"<Scene {Brief(self.name)}: target {self.target.kind}, "
            f"r {ring.inner_radius:g}…{ring.outer_radius:g} mm, "
            f"{search.population} individuals, {search.generations} generations, "
            f"seed {search.seed}>"
        )

    __str__ = __repr__

    def load_target(self) -> Target:
        """What the tip should reach.

        Raises
        ------
        InputError : a file is missing or wrong, or does not fit the scene.
        """
        return self.target.with_paths(self._target_without_paths(), self.actuator.length)

    def _target_without_paths(self) -> Target:
        chosen = self.target
        if chosen.kind in ("points", "paths"):
            straight = self.climb.model.straight_length is not None
            return chosen.pairs(self.actuator.length, straight)
        if chosen.kind == "workspace":
            straight = self.climb.model.straight_length is not None
            about = self.pressures.levels, self.actuator.length, chosen.base, straight
            return read_target(Path(str(chosen.file)), *about)
        if chosen.kind == "section":
            return self._workspace_of_design(Path(str(chosen.file)))
        points = self.random_points(np.random.default_rng([chosen.seed]))
        design = self.design_of(points)
        if not design.section.moments.is_stiff:
            raise InputError("", "target.seed", chosen.seed, "this random section has no material")
        workspace = self._workspace(design, "target.seed", chosen.seed)
        return Target.of_workspace(workspace, design.section)

    def _workspace_of_design(self, path: Path) -> Target:
        """A design's workspace: with its own length and material, at this scene's pressures.

        With this scene's segments, rest shape and loads, unless it has its own.
        """
        design = load_design(path)
        if not design.loads.loads.any:
            shaped = design.rod.segments or any(design.rod.rest_curvature)
            rules = design.rod if shaped else self.climbed_rules
            design = design.model_copy(update={"rod": rules, "loads": self.loads})
        workspace = self._workspace(design, "target.file", str(path))
        warnings = oddities(workspace.tips, workspace.levels, self.climb.model.straight_length)
        return Target.of_workspace(workspace, design.section, warnings)

    def _workspace(self, design: Design, key: str, value: object) -> Workspace:
        try:
            return design.workspace_at(self.pressures.levels)
        except NoEquilibriumError as error:
            raise InputError("", key, value, f"the target's section has {error}") from None

    @property
    def wall_elements(self) -> int:
        """Elements of a wall between supplies; none in a sealed section, whose walls are in mm.

        An outline has no elements: with walls of both kinds the search would judge another section.
        """
        return 0 if self.seal.rules.sealed else self.section.wall_elements

    def random_points(self, rng: np.random.Generator) -> FeaturePoints:
        """A random genotype after this scene's rules."""
        rules = self.section.feature_points, rng, self.section.material_probability
        return FeaturePoints.random(self.grid.build(), *rules)

    def design_of(self, points: FeaturePoints, notes: Mapping[str, Any] | None = None) -> Design:
        """The design that `points` make in this scene."""
        return Design.of_points(
            points,
            grid=self.grid,
            wall_elements=self.wall_elements,
            actuator=self.actuator,
            levels=self.pressures.levels,
            seal=self.seal,
            rod=self.climbed_rules,
            loads=self.loads,
            notes=notes,
        )

    @cached_property
    def climb(self) -> Climb:
        """The rod that judges sections, and why it is on its rung of the ladder."""
        model = rod_model(self.actuator, self.rod, self.loads, section_values)
        return climb(model, self.rod, self.pressures.levels, partial(self._samples, model))

    @property
    def climbed_rules(self) -> RodRules:
        """The rules with what `climb` chose; as they are where that needs no samples."""
        model = self.climb.model
        if not model.loads.any:
            return self.rod
        chosen = {"rung": model.rung.value, "twist": "saint-venant" if model.twists else "stiff"}
        return self.rod.model_copy(update=chosen)

    def _samples(self, model: RodModel) -> list[SectionValues]:
        """A few random sections that the scene's search could meet."""
        found: list[SectionValues] = []
        for seed in range(MOST_SAMPLES):
            points = self.random_points(np.random.default_rng([SAMPLE, seed]))
            rules = self.grid.build(), points, self.wall_elements, self.seal.rules
            section = CrossSection.from_points(*rules)
            if section.moments.is_stiff and len(found) < SAMPLES:
                known = section_saint_venant(section.grid, section.labels, model.poissons_ratio)
                found.append(SectionValues(section.moments, known))
        return found


def load_scene(scene: str | Path, overrides: Sequence[str] = ()) -> Scene:
    """Read a scene file, or a bundled scene by name.

    Parameters
    ----------
    scene : a path, or a name of `bundled_scenes`.
    overrides : `section.key=value` texts that replace single keys, values written as in TOML.

    Raises
    ------
    InputError : the file, the key and what is allowed there.

    Examples
    --------
    >>> import beamopt
    >>> beamopt.load_scene("random-section", ["search.generations=50"]).search.generations
    50
    """
    path = bundled_scenes().get(str(scene), Path(scene))
    if not path.exists():
        names = ", ".join(bundled_scenes())
        raise InputError(scene, "", None, f"no such scene; a path, or one of: {names}")
    text = read_text(path)
    data = parse_toml(text, path)
    if data.get("schema", SCHEMA) != SCHEMA:
        raise InputError(path, "schema", data["schema"], f"this version reads {SCHEMA}")
    if overrides:
        data = overridden(data, [overrides] if isinstance(overrides, str) else overrides)
    try:
        read = parse(Scene, data, path)
    except InputError as error:
        if not overrides:
            raise
        parse(Scene, parse_toml(text, path), path)  # what is wrong with the file itself comes first
        raise InputError("--set", error.key, error.value, error.allowed) from None
    read = read.model_copy(update={"rod": with_sections(read.rod, path.parent)})
    return read.model_copy(update={"target": read.target.beside(path.parent.resolve())})
