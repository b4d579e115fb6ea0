"""A design file: enough to rebuild a section exactly, by this program or by another one."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

import numpy as np
from pydantic import Field, model_validator

from beamopt.base.arrays import FloatArray
from beamopt.base.errors import InputError, NoEquilibriumError
from beamopt.outline.faults import Fault, FaultKind, worst_first
from beamopt.outline.outline import Outline
from beamopt.outline.saint_venant import outline_saint_venant
from beamopt.rod.ladder import RodModel, SectionValues, Tips
from beamopt.rod.pressure_tree import parents_on_grid
from beamopt.rod.response import LinearResponse, linear_response
from beamopt.rod.status import RodStatus
from beamopt.scene.actuator import Actuator, Loading, RodRules, rod_model
from beamopt.scene.drawn_chambers import DrawnChamber, Points, check_drawing, lost_in_raster
from beamopt.scene.grid_keys import Grid, Levels, WallElements
from beamopt.scene.rod_choice import Climb, climb
from beamopt.scene.seal_keys import Seal
from beamopt.section.cross_section import CrossSection
from beamopt.section.drawing import Shape
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.moments import Moments
from beamopt.section.saint_venant import SaintVenant, section_saint_venant
from beamopt.storage.checked_keys import CheckedKeys, parse, quantity
from beamopt.storage.free_values import FreeTable
from beamopt.storage.input_file import read_json
from beamopt.storage.writing import json_text, write_atomic
from beamopt.target.workspace import Workspace, pressure_grid

__all__ = [
    "MOST_INLINE",
    "Design",
    "DesignKeys",
    "Grid",
    "Levels",
    "WallElements",
    "load_design",
    "section_values",
    "with_sections",
]


class DesignKeys(CheckedKeys):
    """Keys of a design file."""

    schema_: Literal["beamopt-design/1"] = Field(alias="schema")
    grid: Grid = quantity(..., "inner_radius, outer_radius, radial, angular, start, stop")
    feature_points: Points | None = quantity(None, "x, y, type of every feature point")
    drawing: tuple[DrawnChamber, ...] | None = quantity(None, "a list of drawn chambers")
    wall_elements: WallElements = quantity(
        ..., "elements of a wall between supplies, even; none if sealed", low=0, high=64
    )
    seal: Seal = quantity(..., "skin, wall, islands; also rounding, smallest_chamber")
    actuator: Actuator = quantity(..., "length, youngs_modulus, shear_modulus")
    pressures: Levels = quantity(..., "three levels, ascending", unit="kPa")
    rod: RodRules = RodRules()
    loads: Loading = Loading()
    notes: FreeTable = Field(default={}, description="anything worth keeping; not read")

    @model_validator(mode="after")
    def _is_one_section(self) -> DesignKeys:
        if (self.feature_points is None) == (self.drawing is None):
            raise ValueError("exactly one of feature_points and drawing must be given")
        self.seal.check_fits(self.grid.build())
        if self.drawing:
            check_drawing(self.drawing, self.grid.build())
        return self

    def __repr__(self) -> str:
        points, ring = self.feature_points, self.grid
        made_of = (
            f"{len(self.drawing or ())} drawn chambers"
            if points is None
            else f"{len(points.x)} feature points"
        )
        sealed = f"sealed by {self.seal.skin:g} mm" if self.seal.rules.sealed else "unsealed"
        return (
            f"<Design: {made_of}, r {ring.inner_radius:g}…{ring.outer_radius:g} mm, {sealed}, "
            f"H = {self.actuator.length:g} mm, E = {self.actuator.youngs_modulus:g} kPa, "
            f"up to {self.pressures[-1]:g} kPa>"
        )

    __str__ = __repr__


MOST_INLINE = 4 * 2**20
"""Most characters of all sections of segments: a folder that holds the scene has them in it."""

SCHEMA = "beamopt-design/1"


class Design(DesignKeys):
    """A section, the actuator that it is extruded to, and its pressure levels.

    Exactly one of `feature_points` and `drawing` says what the section is.

    Examples
    --------
    >>> import beamopt
    >>> angles = (0.0, 120.0, 240.0)
    >>> design = beamopt.Design(
    ...     schema="beamopt-design/1",
    ...     grid=beamopt.Grid(),
    ...     drawing=tuple(
    ...         beamopt.DrawnChamber(supply=k, r=(13.0, 22.0), phi=(angle, angle + 80.0))
    ...         for k, angle in enumerate(angles, 1)
    ...     ),
    ...     wall_elements=0,
    ...     seal=beamopt.Seal(skin=1.0, wall=1.0),
    ...     actuator=beamopt.Actuator(),
    ...     pressures=(0.0, 10.0, 20.0),
    ... )
    >>> design.workspace.tips.shape
    (27, 3)
    >>> design.save("chambers.json").name
    'chambers.json'
    """

    @classmethod
    def of_points(
        cls,
        points: FeaturePoints,
        *,
        grid: Grid,
        wall_elements: int,
        actuator: Actuator,
        levels: tuple[float, float, float],
        seal: Seal | None = None,
        rod: RodRules | None = None,
        loads: Loading | None = None,
        notes: Mapping[str, Any] | None = None,
    ) -> Design:
        """The design whose section is the Voronoi section of `points`."""
        return cls(
            schema="beamopt-design/1",
            grid=grid,
            feature_points=Points(
                x=points.x.tolist(), y=points.y.tolist(), type=points.type.tolist()
            ),
            wall_elements=wall_elements,
            seal=seal or Seal(),
            rod=rod or RodRules(),
            loads=loads or Loading(),
            actuator=actuator,
            pressures=levels,
            notes=dict(notes or {}),
        )

    @cached_property
    def section(self) -> CrossSection:
        """The raster, rebuilt from its feature points or its drawing."""
        grid, walls, rules = self.grid.build(), self.wall_elements, self.seal.rules
        source = self.source
        if isinstance(source, FeaturePoints):
            return CrossSection.from_points(grid, source, walls, rules)
        return CrossSection.from_drawing(grid, source, walls, rules)

    @cached_property
    def outline(self) -> Outline:
        """The section's polygons, sealed where the design is; with what is wrong with them."""
        from beamopt.outline.build import build_outline

        return build_outline(self.grid.build(), self.source, self.seal.rules)

    @cached_property
    def findings(self) -> tuple[Fault, ...]:
        """Faults of its section and parts of the file without effect, the worst first.

        Every command says these; sealed or not, skins, walls and openings are the outline's.
        """
        return self.findings_on(self.outline)

    def findings_on(self, outline: Outline) -> tuple[Fault, ...]:
        """The same on an outline of this design with other edges."""
        found = list(outline.faults)
        if self.drawing is not None and not self.seal.rules.sealed:
            found += lost_in_raster(self.drawing, self.section, self.outline.faults)
        if self.seal.rules.sealed and self.wall_elements:
            found.append(Fault(FaultKind.WALL_ELEMENTS, float(self.wall_elements)))
        return worst_first(found)

    @cached_property
    def moments(self) -> Moments:
        """Moments of what the section is: the outline of a sealed design, the raster of others."""
        return self.outline.moments if self.seal.rules.sealed else self.section.moments

    @property
    def source(self) -> FeaturePoints | list[Shape]:
        """What its section is made of."""
        if self.feature_points is not None:
            return self.feature_points.build()
        return [chamber.build() for chamber in self.drawing or []]

    @property
    def points(self) -> FeaturePoints:
        """The feature points, as a judge takes them: `judge([design.points])`.

        Raises
        ------
        InputError : the design is drawn.
        """
        if self.feature_points is None:
            said = "a design of feature points; drawn chambers have none to move"
            raise InputError("", "drawing", None, said)
        return self.feature_points.build()

    @cached_property
    def response(self) -> LinearResponse:
        """What pressure does to the rod of this section."""
        return linear_response(self.moments, self.actuator.youngs_modulus)

    @cached_property
    def loaded_rod(self) -> RodModel:
        """Its rod but for the section, before `climb` puts it on a rung."""
        return rod_model(self.actuator, self.rod, self.loads, section_values)

    @cached_property
    def climb(self) -> Climb:
        """The rod that gives its tips, and why it is on its rung of the ladder."""
        return climb(self.loaded_rod, self.rod, self.pressures, lambda: [self.values])

    @cached_property
    def values(self) -> SectionValues:
        """What the rod needs to know of the section."""
        may_climb = self.loaded_rod.loads.any and self.rod.rung in ("auto", "loaded")
        if not may_climb or self.rod.twist == "stiff":
            return SectionValues(self.moments)
        return SectionValues(self.moments, self.saint_venant(self.loaded_rod.poissons_ratio))

    def saint_venant(self, poissons_ratio: float) -> SaintVenant:
        """Torsion and shear of the outline of a sealed design, of the raster of others.

        Raises
        ------
        ValueError : `poissons_ratio` out of range.
        InputError : the outline can not be triangulated.
        """
        if self.seal.rules.sealed:
            return outline_saint_venant(self.outline, poissons_ratio)
        return section_saint_venant(self.section.grid, self.section.labels, poissons_ratio)

    @cached_property
    def workspace(self) -> Workspace:
        """The 27 tips at the design's pressure levels.

        Raises
        ------
        NoEquilibriumError : the rod has none at one of them.
        """
        return self.workspace_at(self.pressures)

    def workspace_at(self, levels: tuple[float, float, float]) -> Workspace:
        """The 27 tips at other levels [kPa]; see `workspace`."""
        pressures = pressure_grid(levels)
        # as a search judges it: no more is tried where one of them has no equilibrium
        tips = self.climb.model.tips(self.values, pressures, parents_on_grid(), all_or_none=True)
        return Workspace(levels, _found(tips, pressures))

    def tips(self, pressures: FloatArray) -> FloatArray:
        """Tips (n, 3) [mm] at pressures (n, 3) [kPa].

        Raises
        ------
        ValueError : pressures of another shape, or not finite.
        NoEquilibriumError : the rod has no stable equilibrium at one of them; see `solve`.
        """
        return _found(self.solve(pressures), pressures)

    def solve(self, pressures: FloatArray) -> Tips:
        """Tips at pressures (n, 3) [kPa], each with how it ended.

        Raises
        ------
        ValueError : pressures of another shape, or not finite.
        """
        at = np.asarray(pressures, dtype=np.float64)
        if at.ndim != 2 or at.shape[1] != 3 or not np.isfinite(at).all():
            raise ValueError(f"pressures: finite and (n, 3), not {at.shape}")
        on_grid = np.array_equal(at, pressure_grid(self.pressures))
        return self.climb.model.tips(self.values, at, parents_on_grid() if on_grid else None)

    def json(self) -> str:  # type: ignore[override]  # pydantic's own `json` is deprecated
        """The design file's text."""
        data = self.model_dump(by_alias=True, exclude_none=True)
        for key, usual in (("rod", RodRules()), ("loads", Loading())):
            if getattr(self, key) == usual:
                del data[key]  # the paper's actuator
        return json_text(data | {"seal": self.seal.written()})

    def save(self, path: str | Path) -> Path:
        """Write the design file; a kill never leaves half of it."""
        write_atomic(Path(path), self.json())
        return Path(path)


def load_design(path: str | Path) -> Design:
    """Read a design file.

    Raises
    ------
    InputError : the file, the key and what is allowed there.

    Examples
    --------
    >>> import beamopt
    >>> file = beamopt.load_scene("sealed-section").target.file
    >>> beamopt.load_design(str(file)).seal.skin
    1.0
    """
    file = Path(path)
    design = read_design(file)
    rules = with_sections(design.rod, file.parent)
    return design if rules == design.rod else design.model_copy(update={"rod": rules})


def read_design(file: Path) -> Design:
    """Read a design file as it stands: its segments name their files still.

    Raises
    ------
    InputError : the file, the key and what is allowed there.
    """
    data = read_json(file)
    schema = data.get("schema")
    if schema != SCHEMA:
        raise InputError(file, "schema", schema, f"this version reads {SCHEMA}")
    design = parse(Design, data, file)
    if not design.moments.is_stiff:
        raise InputError(file, "", None, "the section has no material, or too little to bend")
    return design


def section_values(data: dict[str, Any], poissons_ratio: float) -> SectionValues:
    """What the rod needs to know of the section of a whole design, given as its file's content."""
    design = parse(Design, data, "rod.segments")
    return SectionValues(design.moments, design.saint_venant(poissons_ratio))


def _found(tips: Tips, pressures: FloatArray) -> FloatArray:
    for at, status in zip(pressures, tips.status, strict=True):
        if status is not RodStatus.CONVERGED:
            raise NoEquilibriumError(at, status)
    return tips.positions


def with_sections(rules: RodRules, folder: Path) -> RodRules:
    """The rules with whole designs in place of their files' names: they stand on their own.

    Of a file the section counts alone: its own segments are neither read nor taken along.

    Raises
    ------
    InputError : a file can not be used, or the sections are too long together.
    """
    segments, left = [], MOST_INLINE
    read: dict[str, str] = {}
    for number, one in enumerate(rules.segments):
        if one.file is not None:
            if one.file not in read:
                read[one.file] = _without_segments(read_design(folder / one.file)).json()
            left -= len(read[one.file])
            if left < 0:
                said = f"sections of at most {MOST_INLINE} characters, all segments together"
                raise InputError("", f"rod.segments[{number}]", one.file, said)
            section = json.loads(read[one.file])
            del section["notes"]
            one = one.model_copy(update={"file": None, "section": section})
        segments.append(one)
    return rules.model_copy(update={"segments": tuple(segments)})


def _without_segments(design: Design) -> Design:
    if not design.rod.segments:
        return design
    return design.model_copy(update={"rod": design.rod.model_copy(update={"segments": ()})})
