"""A design file: enough to rebuild a section exactly, by this program or by another one."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, Field, model_validator

from beamopt.arrays import FloatArray
from beamopt.errors import InputError
from beamopt.files import json_text, write_atomic
from beamopt.model import Count, Model, Number, parse, quantity, read_json
from beamopt.outline.outline import Outline
from beamopt.rod.arc import arc_tips
from beamopt.rod.response import LinearResponse, linear_response
from beamopt.seal import Seal
from beamopt.section.cross_section import CrossSection
from beamopt.section.drawing import Circle, RingPiece, Shape
from beamopt.section.feature_points import FeaturePoints
from beamopt.section.grid import PolarGrid
from beamopt.section.moments import Moments
from beamopt.workspace import Workspace, workspace_of

__all__ = ["Actuator", "Design", "Grid", "Levels", "WallElements", "load_design"]

SCHEMA = "beamopt-design/1"
MOST_ELEMENTS = 4_000_000

Position = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=-1e6, le=1e6)]
Pressure = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=0, le=2000)]


class Grid(Model):
    """The polar grid of equal-area elements."""

    inner_radius: Number = quantity(10.0, "inner radius of the ring", unit="mm", low=0, high=1000)
    outer_radius: Number = quantity(25.0, "outer radius of the ring", unit="mm", low=0.5, high=1000)
    radial: Count = quantity(128, "elements along the radius", low=4, high=4096)
    angular: Count = quantity(360, "elements around", low=8, high=16384)
    start: Number = quantity(
        0.0, "angle at which a sector starts", unit="degrees", low=-360, high=360
    )
    stop: Number = quantity(
        360.0, "angle at which it ends; 360 more is a ring", unit="degrees", low=-360, high=720
    )

    @model_validator(mode="after")
    def _is_a_ring(self) -> Grid:
        if self.radial * self.angular > MOST_ELEMENTS:
            raise ValueError(f"radial × angular may be at most {MOST_ELEMENTS:,} elements")
        self.build()
        return self

    def build(self) -> PolarGrid:
        """The grid that the section floor works on."""
        return _polar_grid(**self.model_dump())


@lru_cache(maxsize=16)
def _polar_grid(**values: Any) -> PolarGrid:
    """One grid for equal values: its centroids and integrals are computed once."""
    return PolarGrid(**values)


class Actuator(Model):
    """The extruded body and its material."""

    length: Number = quantity(100.0, "undeformed length H", unit="mm", low=5, high=5000)
    youngs_modulus: Number = quantity(300.0, "Young's modulus E", unit="kPa", low=5, high=50_000)
    shear_modulus: Number = quantity(100.0, "shear modulus G", unit="kPa", low=1, high=50_000)


def _ascending(levels: tuple[float, float, float]) -> tuple[float, float, float]:
    if not levels[0] < levels[1] < levels[2]:
        raise ValueError("three pressures in kPa, ascending")
    return levels


Levels = Annotated[tuple[Pressure, Pressure, Pressure], AfterValidator(_ascending)]
"""The three levels [kPa] that each supply takes in the workspace's 27 combinations."""


class Points(Model):
    """Voronoi feature points [mm]; type 0 is material, 1…3 a supply."""

    x: list[Position]
    y: list[Position]
    type: list[Annotated[int, Field(strict=True, ge=0, le=3)]]

    @model_validator(mode="after")
    def _same_length(self) -> Points:
        if not len(self.x) == len(self.y) == len(self.type):
            counts = f"{len(self.x)}, {len(self.y)}, {len(self.type)}"
            raise ValueError(f"x, y, type have {counts} entries; all must have the same")
        return self


class DrawnChamber(Model):
    """Either a piece of a ring (r, phi, corner) or a circle (center, radius)."""

    supply: Count = quantity(..., "pressure supply of the chamber", low=1, high=3)
    r: tuple[Position, Position] | None = quantity(None, "inner and outer radius", unit="mm")
    phi: tuple[Position, Position] | None = quantity(None, "first and last angle", unit="degrees")
    corner: Number | None = quantity(
        None, "radius of the rounded corners", unit="mm", low=0, high=1000
    )
    center: tuple[Position, Position] | None = quantity(None, "centre of a circle", unit="mm")
    radius: Number | None = quantity(None, "radius of a circle", unit="mm", low=0, high=1000)

    @model_validator(mode="after")
    def _is_one_shape(self) -> DrawnChamber:
        self.build()
        return self

    def build(self) -> Shape:
        """The shape that the section floor rasterises."""
        given = self.model_fields_set - {"supply"}
        if self.r and self.phi and given <= {"r", "phi", "corner"}:
            return RingPiece(self.supply, self.r, self.phi, self.corner or 0.0)
        if self.center and self.radius and given <= {"center", "radius"}:
            return Circle(self.supply, self.center, self.radius)
        raise ValueError("a chamber has either r and phi (and corner), or center and radius")


def _even(count: int) -> int:
    if count % 2:
        raise ValueError("an even number: half of a wall lies on each side of a boundary")
    return count


WallElements = Annotated[int, Field(strict=True), AfterValidator(_even)]
"""Elements of a wall between chambers of different supplies."""


class Design(Model):
    """A section, the actuator that it is extruded to, and its pressure levels.

    Exactly one of `feature_points` and `drawing` says what the section is.
    """

    schema_: Literal["beamopt-design/1"] = Field(alias="schema")
    grid: Grid = quantity(..., "inner_radius, outer_radius, radial, angular, start, stop")
    feature_points: Points | None = quantity(None, "x, y, type of every feature point")
    drawing: list[DrawnChamber] | None = quantity(None, "a list of drawn chambers")
    wall_elements: WallElements = quantity(
        ..., "elements of a wall between supplies, even", low=0, high=64
    )
    seal: Seal = quantity(..., "skin, wall, islands; also rounding, smallest_chamber")
    actuator: Actuator = quantity(..., "length, youngs_modulus, shear_modulus")
    pressures: Levels = quantity(..., "three levels, ascending", unit="kPa")
    notes: dict[str, Any] = Field(default={}, description="anything worth keeping; not read")

    @model_validator(mode="after")
    def _is_one_section(self) -> Design:
        if (self.feature_points is None) == (self.drawing is None):
            raise ValueError("exactly one of feature_points and drawing must be given")
        self.seal.check_fits(self.grid.build())
        return self

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
            actuator=actuator,
            pressures=levels,
            notes=dict(notes or {}),
        )

    @cached_property
    def section(self) -> CrossSection:
        """The raster, rebuilt from its feature points or its drawing."""
        grid, walls, rules = self.grid.build(), self.wall_elements, self.seal.rules
        source = self._source
        if isinstance(source, FeaturePoints):
            return CrossSection.from_points(grid, source, walls, rules)
        return CrossSection.from_drawing(grid, source, walls, rules)

    @cached_property
    def outline(self) -> Outline:
        """The section's polygons, sealed where the design is; with what is wrong with them."""
        from beamopt.outline.build import build_outline

        return build_outline(self.grid.build(), self._source, self.seal.rules)

    @cached_property
    def moments(self) -> Moments:
        """Moments of what the section is: the outline of a sealed design, the raster of others."""
        return self.outline.moments if self.seal.rules.sealed else self.section.moments

    @property
    def _source(self) -> FeaturePoints | list[Shape]:
        if self.feature_points is not None:
            return FeaturePoints(**self.feature_points.model_dump())
        return [chamber.build() for chamber in self.drawing or []]

    @cached_property
    def response(self) -> LinearResponse:
        """What pressure does to the rod of this section."""
        return linear_response(self.moments, self.actuator.youngs_modulus)

    @cached_property
    def workspace(self) -> Workspace:
        """The 27 tips at the design's pressure levels."""
        return workspace_of(self.response, self.actuator.length, self.pressures)

    def tips(self, pressures: FloatArray) -> FloatArray:
        """Tips (n, 3) [mm] at pressures (n, 3) [kPa].

        Raises
        ------
        ValueError : pressures of another shape, or not finite.
        """
        at = np.asarray(pressures, dtype=np.float64)
        if at.ndim != 2 or at.shape[1] != 3 or not np.isfinite(at).all():
            raise ValueError(f"pressures: finite and (n, 3), not {at.shape}")
        return arc_tips(self.response.strains(at), self.actuator.length)

    def json(self) -> str:  # type: ignore[override]  # pydantic's own `json` is deprecated
        """The design file's text."""
        data = self.model_dump(by_alias=True, exclude_none=True)
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
    """
    file = Path(path)
    data = read_json(file)
    schema = data.get("schema")
    if schema != SCHEMA:
        raise InputError(file, "schema", schema, f"this version reads {SCHEMA}")
    design = parse(Design, data, file)
    if not design.moments.is_stiff:
        raise InputError(file, "", None, "the section has no material, or too little to bend")
    return design
