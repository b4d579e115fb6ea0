"""The keys of a design file."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from beamopt.scene.actuator import Actuator, Loading, RodRules
from beamopt.scene.drawn_chambers import DrawnChamber, Points, check_drawing
from beamopt.scene.grid_keys import Grid, Levels, WallElements
from beamopt.scene.seal_keys import Seal
from beamopt.storage.checked_keys import CheckedKeys, quantity
from beamopt.storage.free_values import FreeTable

__all__ = ["DesignKeys"]


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
