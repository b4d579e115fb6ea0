"""What a design file says a section is: feature points, or drawn chambers."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, model_validator

from beamopt.model import Count, Model, Number, quantity
from beamopt.section.drawing import Circle, RingPiece, Shape

__all__ = ["DrawnChamber", "Points"]

Position = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=-1e6, le=1e6)]


class Points(Model):
    """Voronoi feature points [mm]; type 0 is material, 1…3 a supply."""

    x: tuple[Position, ...]
    y: tuple[Position, ...]
    type: tuple[Annotated[int, Field(strict=True, ge=0, le=3)], ...]

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
